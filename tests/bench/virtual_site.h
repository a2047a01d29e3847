#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "proto/carrier.h"
#include "robot_agent/pipeline/agent.h"
#include "tests/support/link_emulator/channel.h"
#include "tests/support/virtual_server.h"

namespace cairn::bench {

using test::VirtualServer;

/// A simulated robot with the whole agent, a server and the emulator's channels between them, in
/// virtual time: minutes of a patrol in seconds, and every frame the same for the same seed.
class VirtualSite {
 public:
  struct Config {
    std::string world = "room";
    std::uint64_t seed = 1;
    test::ChannelConfig radio;
    std::size_t overhead_bytes = 44;  ///< Of udp://; dds:// has 92.
    double max_speed_m_s = 0.6;
    bool spool = false;
  };
  VirtualSite(const Config& config, std::filesystem::path folder);

  /// Drives from place to place, round and round, as the server's orders say.
  void patrol(std::vector<Eigen::Vector2d> places_m) { places_m_ = std::move(places_m); }
  /// Somebody who sees the robot steers it from place to place, once: what it maps does not hang
  /// on the link.
  void steer_along(std::vector<Eigen::Vector2d> places_m);
  [[nodiscard]] bool steering() const { return !steer_to_m_.empty(); }
  /// The robot sees nothing more: its last submap is closed.
  void finish();
  void run(Duration length);
  /// False when `done` did not come true in time.
  bool run_until(const std::function<bool()>& done, Duration limit);

  void set_radio(const test::ChannelConfig& radio);
  void restart_server() { server_.restart(); }
  /// kill -9 and a start of the agent where the robot stands.
  void restart_agent();

  [[nodiscard]] agent::Agent& agent() { return *agent_; }
  [[nodiscard]] VirtualServer& server() { return server_; }
  [[nodiscard]] MonotonicTime now() const { return now_; }
  [[nodiscard]] agent::Truth truth() const { return *input_->truth(); }
  [[nodiscard]] int rounds() const { return rounds_; }
  /// The server has all evidence, and both maps are the same to the bit.
  [[nodiscard]] bool in_step();
  struct Bytes {
    std::uint64_t up = 0;
    std::uint64_t down = 0;
  };
  /// Offered to the link, headers included.
  [[nodiscard]] Bytes bytes() const;

 private:
  /// The robot's end of the channels.
  class Carrier : public proto::Carrier {
   public:
    explicit Carrier(VirtualSite& site) : site_(site) {}
    Status send(const proto::Datagram& frame) override;
    Result<std::optional<proto::Datagram>> receive(std::chrono::milliseconds timeout) override;
    [[nodiscard]] std::size_t overhead_bytes() const override {
      return site_.config_.overhead_bytes;
    }

   private:
    VirtualSite& site_;
  };

  /// The robot's instruments, for an agent that begins while they run: somebody tells it where.
  class Instruments : public agent::Input {
   public:
    explicit Instruments(agent::Input& input) : input_(input), start_(input.start()) {}
    void start_at(const Pose& T_site_robot) { start_ = T_site_robot; }
    [[nodiscard]] const std::vector<LaserSpec>& lasers() const override { return input_.lasers(); }
    [[nodiscard]] Pose start() const override { return start_; }
    Result<std::vector<agent::Reading>> advance(MonotonicTime until) override {
      return input_.advance(until);
    }
    [[nodiscard]] bool finished() const override { return input_.finished(); }
    [[nodiscard]] std::optional<MonotonicTime> next_stamp() const override {
      return input_.next_stamp();
    }
    void drive(const agent::DriveCommand& command) override {
      if (!steered) input_.drive(command);
    }
    [[nodiscard]] bool can_drive() const override { return input_.can_drive(); }
    [[nodiscard]] std::optional<agent::Truth> truth() const override { return input_.truth(); }
    bool steered = false;  ///< By somebody else.

   private:
    agent::Input& input_;
    Pose start_;
  };

  void start_agent();
  void step();
  void steer();
  void order_next();
  /// Coded (PROTOCOL.md §8); empty when there is none.
  [[nodiscard]] std::vector<std::uint8_t> path_to(const Eigen::Vector2d& goal_m);

  Config config_;
  std::filesystem::path folder_;
  test::Channel up_;
  test::Channel down_;
  VirtualServer server_;
  std::unique_ptr<agent::Input> input_;
  Instruments instruments_;
  Carrier carrier_;
  std::unique_ptr<agent::Spool> spool_;
  std::unique_ptr<agent::Agent> agent_;
  MonotonicTime now_ = std::chrono::seconds(100);
  MonotonicTime input_begun_ = std::chrono::seconds(100);
  MonotonicTime agent_step_{};
  std::vector<Eigen::Vector2d> places_m_;
  std::size_t next_place_ = 0;
  std::deque<Eigen::Vector2d> steer_to_m_;
  std::uint64_t command_ = 0;
  bool under_way_ = false;
  std::size_t reports_seen_ = 0;
  int rounds_ = 0;
  bool finished_ = false;
  std::uint64_t boot_ = 0;
};

}  // namespace cairn::bench
