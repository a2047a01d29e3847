#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <thread>
#include <vector>

#include "core/common/result.h"
#include "tests/support/link_emulator/channel.h"
#include "tests/support/link_emulator/namespaces.h"

namespace cairn::test {

/// A radio link between two networks of this machine: programs run inside `robot` and `base` reach
/// each other over it and nothing else. Lives as long as the object.
class LinkEmulator {
 public:
  static constexpr const char* kRobotAddress = "10.77.0.1";
  static constexpr const char* kBaseAddress = "10.77.0.2";

  /// unavailable, with the reason, where the system does not allow it.
  static Result<std::unique_ptr<LinkEmulator>> create(std::uint64_t seed, const ChannelConfig& up,
                                                      const ChannelConfig& down);
  ~LinkEmulator();
  LinkEmulator(const LinkEmulator&) = delete;
  LinkEmulator& operator=(const LinkEmulator&) = delete;

  [[nodiscard]] const NetworkNamespace& robot() const { return robot_; }
  [[nodiscard]] const NetworkNamespace& base() const { return base_; }

  /// Times of outages are counted since `create`; see `age`.
  void set(const ChannelConfig& up, const ChannelConfig& down);
  [[nodiscard]] LinkTime age() const;

  struct Counters {
    ChannelCounters up;  ///< robot → base
    ChannelCounters down;
    [[nodiscard]] std::uint64_t offered_bytes() const {
      return up.offered.bytes + down.offered.bytes;
    }
  };
  [[nodiscard]] Counters counters() const;
  [[nodiscard]] nlohmann::json json() const;

 private:
  LinkEmulator(NetworkNamespace robot, NetworkNamespace base, std::uint64_t seed,
               const ChannelConfig& up, const ChannelConfig& down);
  void run();
  void take(int device, Channel& channel);
  void give(Channel& channel, int device);

  NetworkNamespace robot_;
  NetworkNamespace base_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  int stop_;  ///< An eventfd.
  mutable std::mutex mutex_;
  Channel up_;
  Channel down_;
  std::thread thread_;
};

}  // namespace cairn::test
