#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/common/result.h"
#include "proto/carrier.h"
#include "proto/sync/robot_link.h"
#include "robot_agent/drive/driver.h"
#include "robot_agent/input/input.h"
#include "robot_agent/pipeline/mapper.h"
#include "robot_agent/spool/spool.h"

namespace cairn::agent {

struct AgentConfig {
  proto::RobotLinkConfig link;
  MapperConfig mapper;
  DriverConfig driver;
  /// [blocks] A log replay waits while this much evidence is not yet acknowledged.
  std::size_t replay_backlog_blocks = 4'000;
};

/// How one order ended, for whoever watches the agent.
struct Journey {
  proto::CommandReport report;
  Pose believed;               ///< Where the robot believes it is.
  std::optional<Truth> truth;  ///< Where it is, if the input knows.
};

/// The onboard agent: input → pose → submap → outbox → link, and link → drive → input. One thread;
/// the caller owns the clock and the pace.
class Agent {
 public:
  /// `spool`: keeps evidence on disk; null for none. All of these outlive the agent.
  Agent(const AgentConfig& config, Input& input, proto::Carrier& carrier, Spool* spool = nullptr);

  /// Advances the input to `until` (its own time) and lets everything follow from it. `clock` is
  /// the robot's monotonic clock, which links and commands live by.
  Status step(MonotonicTime until, MonotonicTime clock);

  /// Sends what is due and takes what arrived, waiting at most `wait` for the first frame.
  Status exchange(MonotonicTime clock, std::chrono::milliseconds wait);

  /// No reading will come any more: closes the map.
  void finish() { mapper_.finish(); }
  /// The server holds all evidence, also of earlier runs.
  [[nodiscard]] bool delivered() const;
  /// Brings what the server does not hold to disk, if there is a spool. False: not all of it.
  bool keep_the_rest(MonotonicTime clock);
  /// Tells the server that this is the end.
  void say_goodbye();

  /// The evidence waiting for the server is at its bound: a replay should pause.
  [[nodiscard]] bool congested() const;
  [[nodiscard]] const proto::RobotLink& link() const { return link_; }
  [[nodiscard]] const Mapper& mapper() const { return mapper_; }
  [[nodiscard]] const Driver& driver() const { return driver_; }
  /// That came for its orders.
  [[nodiscard]] std::uint64_t corridors() const { return corridors_; }
  /// The newest order that ended since this was last asked.
  [[nodiscard]] std::optional<Journey> take_journey() { return std::exchange(journey_, {}); }

 private:
  void take_reading(const Reading& reading);
  void drive(MonotonicTime clock);
  void take_map();
  void compare_maps(MonotonicTime clock);
  void tell(MonotonicTime clock);
  Status send_due(MonotonicTime clock);

  AgentConfig config_;
  Input& input_;
  proto::Carrier& carrier_;
  proto::RobotLink link_;
  Spool* spool_;
  Mapper mapper_;
  Driver driver_;
  DriveCommand wheels_;
  std::optional<Journey> journey_;
  std::size_t next_digest_ = 0;
  std::uint64_t corridors_ = 0;
};

}  // namespace cairn::agent
