#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "core/common/result.h"
#include "core/planner/trulla.h"
#include "server/mission/task.h"

/// How what a robot has to do is kept in its site's store (FORMAT.md, "Tasks").
namespace cairn::server {

/// What outlives the server of a robot's duty.
struct KeptDuty {
  TaskQueue tasks;
  std::uint64_t newest_task = 0;  ///< Of any robot's, so that no number is given twice.
  std::uint64_t boot = 0;         ///< That began at `home_m`.
  Eigen::Vector2d home_m = Eigen::Vector2d::Zero();
};

/// Two clocks at one moment: tasks expire by the one, files tell the other.
struct ClockPair {
  MonotonicTime monotonic{};
  std::int64_t unix_ms = 0;
};

/// At most 64 kB, whatever the tasks are. Places to the millimetre, headings to 1e-4 rad; of where
/// an exploring robot need not go again what the active task knows.
[[nodiscard]] std::string encode(const KeptDuty& duty, const ClockPair& clocks);
/// `planner`: what tasks plan with, but for what each says of unknown ground. corrupt when it is
/// none, unsupported_version when a newer Cairn wrote it.
[[nodiscard]] Result<KeptDuty> decode_duty(const std::string& bytes, const ClockPair& clocks,
                                           const PlannerConfig& planner);

}  // namespace cairn::server
