#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/planner/plan.h"
#include "proto/sync/evidence_sender.h"
#include "robot_agent/drive/driver.h"
#include "robot_agent/input/input.h"
#include "robot_agent/pipeline/mapper.h"
#include "tests/bench/closure.h"

namespace cairn::bench {

/// A simulated robot with the agent's map making and driving, in the simulator's time. Its paths
/// are planned on all that it knows, as a server beside it would, and come with a corridor;
/// whenever it is blocked, anew.
class SoloRobot {
 public:
  /// `given` may be null: nothing is known, and its own submaps are laid anew where loops close.
  SoloRobot(std::unique_ptr<agent::Input> input, const HeightMap* given);

  struct Trip {
    bool arrived = false;
    std::string why;         ///< What became of it.
    double driven_m = 0.0;   ///< Truth.
    double planned_m = 0.0;  ///< Length of the first path.
    double seconds = 0.0;
    int paths = 0;  ///< That were planned for it.
    bool enough = false;
    bool no_way = false;  ///< Any more, so it was stopped.
  };
  /// Whether the goal has become pointless, by what is known by now.
  using Enough = std::function<bool(const DrivableGrid&)>;
  /// Drives there, for at most `limit`.
  Trip go_to(const Eigen::Vector2d& goal_m, Duration limit) { return go_to(goal_m, limit, {}); }
  /// The same; every second the way is looked at as a server does: if that is `enough` the trip
  /// ends, the robot still under way; where the path is closed by now it gets another; and where
  /// there is none any more it is stopped.
  Trip go_to(const Eigen::Vector2d& goal_m, Duration limit, const Enough& enough);
  /// Lets time pass; the robot does what it was told last.
  void wait(Duration time);

  /// On all that the robot knows now.
  [[nodiscard]] DrivableGrid ground() const;
  [[nodiscard]] agent::Truth truth() const { return *input_->truth(); }
  [[nodiscard]] const agent::Mapper& mapper() const { return mapper_; }
  [[nodiscard]] MonotonicTime now() const { return now_; }
  [[nodiscard]] static PlannerConfig planner() { return {}; }

 private:
  bool send_path(const Eigen::Vector2d& goal_m, Trip& trip);
  /// Of the field around the order's path, as a server would send it.
  void give_corridor(const proto::RobotLink::Order& order, const DrivableGrid& known,
                     const Eigen::Vector2d& goal_m);
  void step();
  void straighten();
  void look(const Eigen::Vector2d& goal_m, const Enough& enough, Trip& trip);
  void give_up(Trip& trip);
  void follow_reports(const Eigen::Vector2d& goal_m, bool watched, Trip& trip);

  std::unique_ptr<agent::Input> input_;
  proto::EvidenceSender evidence_;
  agent::Mapper mapper_;
  agent::Driver driver_{agent::DriverConfig{}};
  std::unique_ptr<Closure> closure_;  ///< Null with a given map.
  std::uint32_t closed_ = 0;          ///< The newest submap that went into it.
  MonotonicTime now_{};
  std::uint64_t command_ = 0;
  bool ended_ = false;
  std::vector<Eigen::Vector2d> path_m_;  ///< Sent last.
};

}  // namespace cairn::bench
