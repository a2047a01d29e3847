#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <utility>

#include "proto/codec/frame.h"
#include "proto/dds/endpoint.h"
#include "proto/dds/robot_carrier.h"
#include "proto/sync/patch_receiver.h"
#include "proto/sync/robot_link.h"
#include "robot_agent/input/simulator.h"
#include "robot_agent/pipeline/mapper.h"
#include "server/store/sqlite_store.h"
#include "tests/support/cairn_programs.h"

namespace cairn::test {
namespace {

using namespace std::chrono_literals;

/// Watches what a robot sends and what the server acknowledges, from the bytes alone.
class WitnessCarrier final : public proto::Carrier {
 public:
  explicit WitnessCarrier(std::unique_ptr<proto::Carrier> inner) : inner_(std::move(inner)) {}

  Status send(const proto::Datagram& datagram) override {
    const auto frame = proto::decode_frame(datagram.bytes, proto::Direction::up);
    if (frame && frame->header.session != session_) {
      session_ = frame->header.session;
      sent_.clear();
      patches_ = {};
    }
    if (frame) sent_[frame->header.number] = read(*frame);
    return inner_->send(datagram);
  }
  Result<std::optional<proto::Datagram>> receive(std::chrono::milliseconds timeout) override {
    auto received = inner_->receive(timeout);
    if (received && received->has_value()) look(**received);
    return received;
  }
  [[nodiscard]] std::size_t overhead_bytes() const override { return inner_->overhead_bytes(); }

  using Place = std::pair<std::uint32_t, BlockKey>;
  /// The newest acknowledged version of each block of each submap.
  [[nodiscard]] const std::map<Place, std::uint32_t>& acknowledged() const { return acknowledged_; }

 private:
  void look(const proto::Datagram& datagram) {
    const auto frame = proto::decode_frame(datagram.bytes, proto::Direction::down);
    if (!frame || frame->header.session != session_) return;
    for (const proto::Record& record : frame->records) {
      const auto* ack = std::get_if<proto::Ack>(&record);
      if (ack == nullptr) continue;
      std::erase_if(sent_, [&](const auto& sent) {
        const std::uint32_t beyond = sent.first - ack->cumulative - 2;
        const bool done =
            sent.first <= ack->cumulative || (sent.first >= ack->cumulative + 2 && beyond < 64 &&
                                              ((ack->bitmap >> beyond) & 1U) != 0);
        if (done) note(sent.second);
        return done;
      });
    }
  }
  void note(const std::vector<proto::BlockUpdate>& blocks) {
    for (const proto::BlockUpdate& block : blocks) {
      std::uint32_t& version = acknowledged_[{block.sequence, block.key}];
      version = std::max(version, block.version);
    }
  }
  std::vector<proto::BlockUpdate> read(const proto::Frame& frame) {
    std::vector<proto::BlockUpdate> blocks;
    for (const proto::Record& record : frame.records) {
      const auto* patch = std::get_if<proto::EvidencePatch>(&record);
      if (patch == nullptr) continue;
      const auto read = patches_.read(frame.header.number, *patch);
      EXPECT_EQ(read.outcome, proto::PatchReceiver::Outcome::read);
      blocks.insert(blocks.end(), read.blocks.begin(), read.blocks.end());
    }
    return blocks;
  }

  std::unique_ptr<proto::Carrier> inner_;
  std::uint32_t session_ = 0;
  std::map<std::uint32_t, std::vector<proto::BlockUpdate>> sent_;
  proto::PatchReceiver patches_;
  std::map<Place, std::uint32_t> acknowledged_;
};

/// A robot in this process that drives in circles through the simulated room and maps.
class CirclingRobot {
 public:
  explicit CirclingRobot(std::uint64_t boot) {
    auto dds =
        proto::DdsRobotCarrier::create(*proto::parse_dds_url(ServerProcess::dds_url()), "r1");
    EXPECT_TRUE(dds) << dds.error().message;
    carrier_ = std::make_unique<WitnessCarrier>(std::move(*dds));
    agent::SimulatorConfig simulator;
    simulator.world = "room";
    input_ = std::move(*agent::make_simulator(simulator));
    proto::RobotLinkConfig link;
    link.robot = "r1";
    link.site = "lab";
    link.boot = boot;
    link_ = std::make_unique<proto::RobotLink>(link, carrier_->overhead_bytes());
    agent::MapperConfig mapper;
    mapper.submap_distance_m = 2.0;
    mapper_ = std::make_unique<agent::Mapper>(mapper, input_->lasers(), input_->start(), boot,
                                              link_->evidence());
  }

  /// Lives for this long, ten times faster than real.
  void live(std::chrono::milliseconds time, bool mapping = true) {
    const auto begin = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - begin < time) {
      if (mapping) drive_on();
      exchange();
    }
  }
  bool synchronise(std::chrono::milliseconds timeout) {
    mapper_->finish();
    return eventually(
        [this] {
          exchange();
          return link_->evidence().synchronised();
        },
        timeout);
  }
  [[nodiscard]] const WitnessCarrier& witness() const { return *carrier_; }
  [[nodiscard]] bool connected() const { return link_->connected(); }

 private:
  void drive_on() {
    input_->drive({0.3, 0.5});
    log_time_ += 50ms;
    auto readings = input_->advance(log_time_);
    ASSERT_TRUE(readings);
    for (const agent::Reading& reading : *readings) {
      if (const auto* motion = std::get_if<MotionReading>(&reading)) mapper_->take_motion(*motion);
      if (const auto* scan = std::get_if<Scan>(&reading)) mapper_->take_scan(*scan);
    }
  }
  void exchange() {
    const auto now = std::chrono::duration_cast<MonotonicTime>(
        std::chrono::steady_clock::now().time_since_epoch());
    while (auto bytes = link_->next_frame(now)) (void)carrier_->send({{}, std::move(*bytes)});
    for (auto timeout = 5ms;; timeout = 0ms) {
      auto received = carrier_->receive(timeout);
      ASSERT_TRUE(received);
      if (!received->has_value()) return;
      (void)link_->on_frame((*received)->bytes, now);
    }
  }

  std::unique_ptr<WitnessCarrier> carrier_;
  std::unique_ptr<agent::Input> input_;
  std::unique_ptr<proto::RobotLink> link_;
  std::unique_ptr<agent::Mapper> mapper_;
  MonotonicTime log_time_{};
};

/// What the witness saw acknowledged and the store does not hold.
std::vector<std::string> missing(const TempFolder& folder, std::uint64_t boot,
                                 const WitnessCarrier& witness) {
  auto store = server::SqliteStore::open(site_folder(folder) / "lab.cairn");
  if (!store) return {store.error().message};
  std::map<WitnessCarrier::Place, std::uint32_t> held;
  std::set<std::uint32_t> sequences;
  for (const auto& [place, version] : witness.acknowledged()) sequences.insert(place.first);
  for (const std::uint32_t sequence : sequences) {
    const auto blocks = (*store)->blocks_of({boot, sequence});
    if (!blocks) return {blocks.error().message};
    for (const server::BlockRow& row : *blocks) held[{sequence, row.key}] = row.version;
  }
  std::vector<std::string> lost;
  for (const auto& [place, version] : witness.acknowledged()) {
    if (held[place] >= version) continue;
    lost.push_back("submap " + std::to_string(place.first) + ": version " +
                   std::to_string(version) + " acknowledged, " + std::to_string(held[place]) +
                   " held");
  }
  return lost;
}

TEST(Crash, AServerKilledWhileMappingHoldsEveryAcknowledgedEvidenceExactlyOnce) {
  constexpr std::uint64_t kBoot = 0xC0FFEE;
  constexpr int kKills = 25;
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const TempFolder folder;
  std::unique_ptr<CirclingRobot> robot;
  for (int kill = 0; kill <= kKills; ++kill) {
    ServerProcess server(folder);
    ASSERT_TRUE(server.wait_until_ready()) << server.process().output();
    if (kill == 0) {
      ASSERT_EQ(server.cairn({"found", "lab"}).exit_code, 0);
      robot = std::make_unique<CirclingRobot>(kBoot);
    }
    const std::size_t before = robot->witness().acknowledged().size();
    ASSERT_TRUE(eventually(
        [&] {
          robot->live(20ms);
          return robot->witness().acknowledged().size() > before;
        },
        20s))
        << "after kill " << kill << ": nothing is acknowledged";
    if (kill == kKills) {
      EXPECT_TRUE(robot->synchronise(30s));
      break;
    }
    robot->live(std::chrono::milliseconds(random() % 300));
    server.process().kill();
    const std::vector<std::string> lost = missing(folder, kBoot, robot->witness());
    ASSERT_TRUE(lost.empty()) << "after kill " << kill << ": " << lost.front();
  }
  const Finished audited = audit(folder);
  EXPECT_EQ(audited.exit_code, 0) << audited.output;
  EXPECT_NE(audited.output.find("sound"), std::string::npos) << audited.output;
}

TEST(Crash, TheWitnessNoticesEvidenceThatIsGone) {
  constexpr std::uint64_t kBoot = 0xBEEF;
  const TempFolder folder;
  {
    ServerProcess server(folder);
    ASSERT_TRUE(server.wait_until_ready()) << server.process().output();
    ASSERT_EQ(server.cairn({"found", "lab"}).exit_code, 0);
    CirclingRobot robot(kBoot);
    ASSERT_TRUE(eventually(
        [&] {
          robot.live(20ms);
          return !robot.witness().acknowledged().empty();
        },
        20s));
    server.process().kill();
    ASSERT_TRUE(missing(folder, kBoot, robot.witness()).empty());
    EXPECT_FALSE(missing(folder, kBoot + 1, robot.witness()).empty());
  }
}

/// A log of a robot that circles in a square hall.
std::string write_log(const TempFolder& folder) {
  const std::filesystem::path file = folder.path() / "hall.log";
  std::ofstream log(file);
  for (int i = 0; i < 3000; ++i) {
    const double turned = i * 0.01;
    const double x = 3.0 * std::sin(turned);
    const double y = 3.0 * (1.0 - std::cos(turned));
    log << "FLASER 180";
    for (int beam = 0; beam < 180; ++beam) {
      const double angle = turned + (beam - 90 + 0.01) * 3.14159265 / 180.0;  // Never along a wall.
      const double to_x = ((std::cos(angle) > 0 ? 9.0 : -9.0) - x) / std::cos(angle);
      const double to_y = ((std::sin(angle) > 0 ? 12.0 : -6.0) - y) / std::sin(angle);
      log << ' ' << std::clamp(std::min(to_x, to_y), 0.0, 60.0);
    }
    const double yaw = std::remainder(turned, 2.0 * 3.14159265);
    for (int pose = 0; pose < 2; ++pose) log << ' ' << x << ' ' << y << ' ' << yaw;
    log << ' ' << i * 0.2 << " host " << i * 0.2 << '\n';
  }
  return file.string();
}

TEST(Crash, AgentsKilledWhileMappingLeaveASoundStore) {
  constexpr int kKills = 25;
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const TempFolder folder;
  const std::string log = write_log(folder);
  ServerProcess server(folder);
  ASSERT_TRUE(server.wait_until_ready()) << server.process().output();
  ASSERT_EQ(server.cairn({"found", "lab"}).exit_code, 0);
  for (int kill = 0; kill < kKills; ++kill) {
    const std::string name = "r" + std::to_string(kill);
    Process agent = start_agent(folder, name, {"--site", "lab", "--replay", log});
    ASSERT_TRUE(agent.wait_for_output("connected", 20s)) << agent.output();
    const int wait_steps = static_cast<int>(random() % 60);
    for (int i = 0; i < wait_steps; ++i) pause_briefly();
    agent.kill();
  }
  const nlohmann::json site = server.status()["sites"][0];
  EXPECT_GT(site["submaps"].get<int>(), kKills / 2);
  server.process().kill();
  const Finished audited = audit(folder);
  EXPECT_EQ(audited.exit_code, 0) << audited.output;
}

}  // namespace
}  // namespace cairn::test
