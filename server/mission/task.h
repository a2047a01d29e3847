#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/common/result.h"
#include "core/common/time.h"
#include "core/frontier/frontier.h"
#include "core/planner/trulla.h"
#include "proto/codec/records.h"

namespace cairn::server {

enum class TaskKind : std::uint8_t { go_to, explore, go_home };
enum class TaskState : std::uint8_t { active, done, failed, cancelled, expired };

struct Waypoint {
  Eigen::Vector2d place_m;
  std::optional<double> heading_rad;  ///< To turn to there; none: any.
};

/// What an operator wants of a robot: several legs, each of which is one command to the robot.
struct Task {
  std::uint64_t id = 0;
  TaskKind kind = TaskKind::go_to;
  std::vector<Waypoint> waypoints;  ///< Of go_to and go_home. [Limit: ≥ 1]
  bool loop = false;
  std::optional<AreaM> area;  ///< Of explore.
  PlannerConfig planner;
  bool allow_partial = false;
  proto::OnLinkLoss on_link_loss = proto::OnLinkLoss::stop;
  MonotonicTime expires{};

  TaskState state = TaskState::active;
  std::string why;
  std::size_t next = 0;      ///< Waypoint that is driven to.
  std::uint64_t legs = 0;    ///< Reached, in this round.
  std::uint64_t rounds = 0;  ///< Finished.
  int failures = 0;          ///< Legs in a row that were not reached.
  /// [m] Frontiers that could not be reached, or that showed nothing new: not tried again.
  std::deque<Eigen::Vector2d> avoided_m;

  /// [places] Beyond it the oldest are forgotten.
  static constexpr std::size_t kMaxAvoided = 1000;
  /// Exploring ends after so many legs in a row that were not reached.
  static constexpr int kMaxFailures = 6;

  void avoid(const Eigen::Vector2d& place_m);
};

/// How a leg ended, as far as a task cares.
enum class LegEnd : std::uint8_t {
  reached,
  seen,         ///< Exploring: there is nothing new there any more.
  no_way,       ///< Seen from nearer, none leads there.
  not_reached,  ///< Blocked for good, stopped by the link or the ground.
  out_of_hand,  ///< Refused, lost, superseded: the robot does not do what it is told.
  out_of_time,
};

/// Brings a task to where its next leg begins, or to its end. `goal_m` is where the leg led.
void end_leg(Task& task, LegEnd how, const std::string& why, const Eigen::Vector2d& goal_m);

/// The tasks of one robot: the first is carried out, the others wait.
class TaskQueue {
 public:
  /// [tasks]
  static constexpr std::size_t kMaxWaiting = 16;

  TaskQueue() = default;
  /// As it was kept. Requires: at most 1 + kMaxWaiting tasks.
  TaskQueue(std::deque<Task> tasks, std::optional<Task> last)
      : tasks_(std::move(tasks)), last_(std::move(last)) {}

  /// In place of all there is; what was active is cancelled for `why`.
  void replace(Task task, const std::string& why);
  /// exhausted when kMaxWaiting wait already.
  Status append(Task task);
  /// Takes one that waits out again, as if it had never come.
  void withdraw(std::uint64_t id);
  /// Ends all of it; nothing happens when nothing is active.
  void cancel(const std::string& why);
  /// The active one; null when there is none.
  [[nodiscard]] Task* current();
  /// Passes over tasks that have ended. After one that was done the next begins; after another end
  /// those that waited are dropped, for they were meant for a robot that is elsewhere.
  void settle();

  /// The active task, or the last that ended.
  [[nodiscard]] const Task* newest() const;
  /// The active one, then those that wait.
  [[nodiscard]] const std::deque<Task>& all() const { return tasks_; }
  /// The last that ended.
  [[nodiscard]] const std::optional<Task>& last() const { return last_; }
  [[nodiscard]] std::size_t waiting() const { return tasks_.empty() ? 0 : tasks_.size() - 1; }

 private:
  std::deque<Task> tasks_;  ///< [Limit: ≤ 1 + kMaxWaiting]
  std::optional<Task> last_;
};

}  // namespace cairn::server
