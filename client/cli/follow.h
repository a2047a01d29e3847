#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "proto/json/messages.h"

namespace cairn::cli {

/// Judges status after status whether a robot still carries out a command.
class Follow {
 public:
  struct Step {
    std::string line;         ///< For people, whatever happened.
    std::optional<int> exit;  ///< The end: kExitOk only when arrived.
  };

  /// A robot that waits this long for a new path, and gets none, is blocked for good.
  static constexpr double kBlockedForGoodS = 30.0;

  /// `before` was taken before the command was sent: bytes count from there.
  Follow(const api::StatusReply& before, std::string robot, std::uint64_t command);

  [[nodiscard]] Step step(const api::StatusReply& status);

 private:
  [[nodiscard]] std::optional<Step> ended(const api::CommandJson& command) const;
  [[nodiscard]] bool blocked_for_good(const api::CommandJson& command, double now_s);
  [[nodiscard]] std::string progress(const api::RobotJson& robot) const;

  std::string robot_;
  std::uint64_t command_;
  double started_s_;
  std::uint64_t bytes_up_ = 0;
  std::uint64_t bytes_down_ = 0;
  std::optional<double> blocked_since_s_;
  std::uint32_t blocked_revision_ = 0;
};

/// The same for a task of several legs.
class FollowTask {
 public:
  FollowTask(std::string robot, std::uint64_t task) : robot_(std::move(robot)), task_(task) {}

  [[nodiscard]] Follow::Step step(const api::StatusReply& status) const;

 private:
  std::string robot_;
  std::uint64_t task_;
};

}  // namespace cairn::cli
