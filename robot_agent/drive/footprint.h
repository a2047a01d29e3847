#pragma once

#include "core/pose/pose.h"
#include "robot_agent/drive/local_view.h"
#include "robot_agent/drive/path_follower.h"

namespace cairn::agent {

/// The room that the vehicle itself takes, a little more than the ATRV-Jr measures (T3.1): what a
/// map calls an obstacle may reach half a cell beyond it.
struct Footprint {
  double half_length_m = 0.45;
  double half_width_m = 0.38;
};

/// How fast a vehicle comes to a stand.
struct Braking {
  double deceleration_m_s2 = 0.5;
  double turn_deceleration_rad_s2 = 1.0;
  double reaction_s = 0.3;  ///< Until it begins to.
};

/// Whether a vehicle that keeps to a command until it has to brake gets over an obstacle that it
/// does not stand on yet. Where the circle that the planner keeps free around a robot's middle is
/// free nothing is; that circle holds the vehicle however it turns. `view` has the planner's
/// limits.
[[nodiscard]] bool runs_into(const LocalView& view, const Footprint& footprint,
                             const Braking& braking, const Pose& T_site_robot,
                             const DriveCommand& command);

}  // namespace cairn::agent
