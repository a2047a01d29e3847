#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tests/support/link_emulator/channel.h"
#include "tests/support/sync_world.h"

namespace cairn::bench {

/// Both ends of the synchronisation over the emulator's channels, in virtual time: what a thousand
/// trials over a slow radio would take hours for. Frames cost what the carrier adds to them.
class VirtualLink {
 public:
  VirtualLink(std::uint64_t seed, const test::ChannelConfig& radio, std::size_t overhead_bytes);

  /// The robot maps, and the server tells it of the map, as fast as the link takes it.
  void set_load(bool load) { load_ = load; }
  void set(const test::ChannelConfig& radio);
  void run(Duration length);

  /// Sends a stop and has the robot report on it at once.
  struct StopDelays {
    double there_s = 0.0;           ///< Until the robot has it.
    double there_and_back_s = 0.0;  ///< Until the server knows that.
  };
  /// nullopt when that took more than a minute.
  std::optional<StopDelays> stop();

  struct Recovery {
    double seconds = 0.0;
    std::uint64_t bytes = 0;  ///< Both ways, offered to the link.
  };
  /// Lets nothing through for `length`, while the robot changes some cells, and measures from the
  /// link's return until the server holds everything.
  Recovery outage(Duration length, int changes);

  /// A cell changes ten times a second: how old the server's value is, on the average.
  [[nodiscard]] double mean_staleness_s(Duration length);

  [[nodiscard]] std::uint64_t offered_bytes() const;
  [[nodiscard]] bool synchronised() const { return robot_.evidence().synchronised(); }
  [[nodiscard]] proto::EvidenceSender& evidence() { return robot_.evidence(); }

 private:
  void step();
  void make_load();
  void carry(test::Channel& channel, const std::vector<std::uint8_t>& frame);
  [[nodiscard]] MonotonicTime next_event() const;

  std::size_t overhead_;
  test::ChannelConfig radio_;
  test::Channel up_;
  test::Channel down_;
  proto::testing::TestServer server_;
  proto::RobotLink robot_;
  proto::testing::Mapper mapper_;
  MonotonicTime now_ = std::chrono::seconds(100);
  MonotonicTime load_due_{};
  bool load_ = false;
  std::uint64_t commands_ = 0;
  std::vector<proto::RobotLink::Order> orders_;
};

}  // namespace cairn::bench
