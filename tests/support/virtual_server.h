#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "proto/codec/frame.h"
#include "proto/sync/server_link.h"
#include "server/link/downlink.h"
#include "server/world/world.h"

namespace cairn::test {

/// The server of one site and one robot, without threads: its world and store are the real ones.
class VirtualServer {
 public:
  VirtualServer(std::filesystem::path folder, std::uint64_t seed, std::size_t overhead_bytes);

  void on_frame(const std::vector<std::uint8_t>& bytes, MonotonicTime now);
  std::optional<std::vector<std::uint8_t>> next_frame(MonotonicTime now);
  /// kill -9 and a start: sessions and what was not committed are gone.
  void restart();

  [[nodiscard]] proto::ServerLink* link() { return link_ ? &*link_ : nullptr; }
  [[nodiscard]] server::World& world() { return *world_; }
  [[nodiscard]] const std::optional<proto::PoseReport>& pose() const { return pose_; }
  [[nodiscard]] const std::vector<proto::CommandReport>& reports() const { return reports_; }

 private:
  void open();
  void take(proto::ServerLink::Event event, MonotonicTime now);
  void commit_if_due(MonotonicTime now);
  void tell_of_map(MonotonicTime now);

  std::filesystem::path folder_;
  std::mt19937_64 random_;
  std::size_t overhead_;
  std::unique_ptr<server::World> world_;
  std::optional<proto::ServerLink> link_;
  server::Downlink downlink_;
  std::deque<std::vector<std::uint8_t>> resets_;
  struct Staged {
    std::uint32_t number = 0;
    std::vector<proto::Refusal> refusals;
  };
  std::vector<Staged> staged_;  ///< Since the last commit.
  MonotonicTime commit_at_{};
  std::optional<proto::PoseReport> pose_;
  std::vector<proto::CommandReport> reports_;
};

}  // namespace cairn::test
