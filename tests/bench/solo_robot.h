#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/planner/plan.h"
#include "proto/sync/evidence_sender.h"
#include "robot_agent/drive/driver.h"
#include "robot_agent/input/input.h"
#include "robot_agent/pipeline/mapper.h"

namespace cairn::bench {

/// A simulated robot with the agent's map making and driving, in the simulator's time. Its paths
/// are planned on all that it knows, as a server beside it would, and come with a corridor;
/// whenever it is blocked, anew.
class SoloRobot {
 public:
  /// `given` may be null: nothing is known.
  SoloRobot(std::unique_ptr<agent::Input> input, const HeightMap* given);

  struct Trip {
    bool arrived = false;
    std::string why;         ///< What became of it.
    double driven_m = 0.0;   ///< Truth.
    double planned_m = 0.0;  ///< Length of the first path.
    double seconds = 0.0;
    int paths = 0;  ///< That were planned for it.
  };
  /// Drives there, for at most `limit`.
  Trip go_to(const Eigen::Vector2d& goal_m, Duration limit);

  /// On all that the robot knows now.
  [[nodiscard]] DrivableGrid ground() const;
  [[nodiscard]] agent::Truth truth() const { return *input_->truth(); }
  [[nodiscard]] const agent::Mapper& mapper() const { return mapper_; }
  [[nodiscard]] static PlannerConfig planner() { return {}; }

 private:
  bool send_path(const Eigen::Vector2d& goal_m, Trip& trip);
  /// Of the field around the order's path, as a server would send it.
  void give_corridor(const proto::RobotLink::Order& order, const DrivableGrid& known,
                     const Eigen::Vector2d& goal_m);
  void step();
  void follow_reports(const Eigen::Vector2d& goal_m, Trip& trip);

  std::unique_ptr<agent::Input> input_;
  proto::EvidenceSender evidence_;
  agent::Mapper mapper_;
  agent::Driver driver_{agent::DriverConfig{}};
  MonotonicTime now_{};
  std::uint64_t command_ = 0;
  bool ended_ = false;
};

}  // namespace cairn::bench
