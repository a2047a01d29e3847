#include <gtest/gtest.h>

#include "robot_agent/pipeline/replica.h"
#include "tests/support/evidence_frames.h"
#include "tests/support/process.h"
#include "tests/support/sync_world.h"
#include "tests/support/virtual_server.h"

/// The long-term map at both ends of a link in simulated time: it ends up the same, and what is the
/// same does not travel again.
namespace cairn {
namespace {

using proto::testing::frames_of;
using proto::testing::LinkFaults;
using proto::testing::LossyLink;
using proto::testing::Mapper;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::uint64_t kOtherBoot = 9;

/// A robot that maps and keeps a replica, a server, and others who map too.
class MapWorld {
 public:
  explicit MapWorld(std::uint64_t seed, LinkFaults faults = {})
      : up(seed * 8 + 1, faults),
        down(seed * 8 + 2, faults),
        server(folder_.path(), seed, 28),
        mapper(seed * 8 + 3),
        other(seed * 8 + 4) {}

  test::TempFolder folder_;
  LossyLink up;
  LossyLink down;
  test::VirtualServer server;
  proto::RobotLink robot{
      {.robot = "rover", .site = "lab", .boot = 0xB007, .digest_period = seconds(60)}, 28};
  agent::Replica replica{125, SensorModel{}, std::size_t{1} << 28U};
  Mapper mapper;
  Mapper other;
  proto::EvidenceSender others_evidence;
  std::uint32_t others_frames = 0;
  MonotonicTime now = seconds(100);

  void map_for_a_while() {
    for (int i = 0; i < 40; ++i) {
      mapper.see(robot.evidence());
      if (mapper.between(0, 9) == 0) close();
      run(milliseconds(250));
    }
    close();
  }
  void others_map() {
    for (int i = 0; i < 20; ++i) other.see(others_evidence);
    other.close(others_evidence);
    for (const auto& evidence : frames_of(others_evidence, others_frames)) {
      (void)server.world().stage("r2", kOtherBoot, evidence);
    }
    ASSERT_TRUE(server.world().commit());
  }
  void run(Duration length) {
    for (const MonotonicTime end = now + length; now < end; now += milliseconds(10)) step();
  }
  [[nodiscard]] bool same() {
    server.world().publish();
    const auto map = server.world().snapshot();
    HeightMap held(125);
    for (const auto& [key, tile] : map->tiles) held.insert(key, tile->unpack());
    return proto::testing::same_cells(held, replica.now());
  }
  [[nodiscard]] bool becomes_same(Duration limit) {
    for (const MonotonicTime end = now + limit; now < end;) {
      run(seconds(1));
      if (robot.evidence().synchronised() && same()) return true;
    }
    return false;
  }

 private:
  void close() {
    Submap* const open = robot.evidence().open_submap();
    if (open == nullptr) return;
    Submap closed = *open;
    closed.closed = true;
    mapper.close(robot.evidence());
    replica.add(std::move(closed));
  }
  void step() {
    while (const auto bytes = up.receive(now)) server.on_frame(*bytes, now);
    while (const auto bytes = down.receive(now)) (void)robot.on_frame(*bytes, now);
    for (const proto::MapUpdate& update : robot.take_map_updates()) {
      std::vector<agent::GivenTile> tiles;
      for (const auto& [key, tile, holds] : update.tiles) tiles.push_back({key, tile, holds});
      replica.take(tiles);
    }
    compare();
    proto::PoseReport pose;
    pose.clock_ms = static_cast<std::uint64_t>(now / milliseconds(1));
    robot.set_pose(pose);
    while (const auto bytes = robot.next_frame(now)) up.send(*bytes, now);
    while (const auto bytes = server.next_frame(now)) down.send(*bytes, now);
  }
  void compare() {
    const auto wish = robot.digest_wish(now);
    if (wish == proto::RobotLink::DigestWish::none) return;
    auto digests = replica.digests(robot.evidence().held_up_to());
    if (wish == proto::RobotLink::DigestWish::all && !digests.empty()) digests.back().last = true;
    robot.tell_digests(std::move(digests), now);
  }
};

LinkFaults some_faults(std::uint64_t seed) {
  return {.loss = 0.05 * static_cast<double>(seed % 7),
          .duplicate = 0.05,
          .least_delay = milliseconds(50),
          .most_delay = milliseconds(350)};
}

TEST(MapDigests, BothEndsBecomeTheSameWhateverTheLinkDoes) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    MapWorld world(seed, some_faults(seed));
    world.others_map();
    world.map_for_a_while();
    world.others_map();
    if (seed % 2 == 0) world.server.restart();
    EXPECT_TRUE(world.becomes_same(seconds(180)));
    EXPECT_GT(world.replica.now().tiles().size(), 1U);
  }
}

TEST(MapDigests, AfterARestartOfTheServerNothingTravelsThatIsThere) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    MapWorld world(seed);
    world.others_map();
    world.map_for_a_while();
    ASSERT_TRUE(world.becomes_same(seconds(120)));
    world.run(seconds(5));
    world.server.restart();
    world.run(seconds(40));  // It hears of it when the robot next says where it is.
    ASSERT_NE(world.server.link(), nullptr);
    EXPECT_EQ(world.server.link()->map().steps_done(), 0U);
    EXPECT_TRUE(world.same());
    world.others_map();
    EXPECT_TRUE(world.becomes_same(seconds(60)));
  }
}

TEST(MapDigests, AReplicaThatWentAstrayIsHealedInBoundedTime) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    MapWorld world(seed, some_faults(seed));
    world.others_map();
    world.map_for_a_while();
    ASSERT_TRUE(world.becomes_same(seconds(180)));
    auto tile = world.replica.now().tiles().begin();
    for (std::uint64_t i = 0; i < seed % 4; ++i) ++tile;
    Tile wrong = *tile->second;
    for (int i = 0; i < 50; ++i) wrong.set(i * 7, {});
    wrong.set(3, {wrong.datum_mm() + 7, 99});
    world.replica.take({{tile->first, wrong, world.robot.evidence().held_up_to()}});
    ASSERT_FALSE(world.same());
    EXPECT_TRUE(world.becomes_same(seconds(180)));
  }
}

TEST(MapDigests, AServerThatLostATileGetsNoneAndTheRobotForgetsIt) {
  MapWorld world(3);
  world.others_map();
  ASSERT_TRUE(world.becomes_same(seconds(60)));
  Tile ghost(0);
  ghost.set(5, {10, 200});
  world.replica.take({{{0, 9, 9}, ghost, 0}});
  ASSERT_FALSE(world.same());
  EXPECT_TRUE(world.becomes_same(seconds(150)));
}

}  // namespace
}  // namespace cairn
