#include <gtest/gtest.h>

#include "tests/support/sync_world.h"

/// Both ends of a link in simulated time: whatever the link and the server do, they converge.
namespace cairn::proto {
namespace {

using namespace testing;  // NOLINT: the test's own world

constexpr int kSeeds = 300;

LinkFaults random_faults(Mapper& dice) {
  LinkFaults faults;
  faults.loss = dice.between(0, 40) / 100.0;
  faults.duplicate = dice.between(0, 20) / 100.0;
  faults.least_delay = milliseconds(dice.between(1, 300));
  faults.most_delay = faults.least_delay + milliseconds(dice.between(0, 400));
  return faults;
}

/// Twenty seconds of mapping, with restarts of the server.
void map_for_a_while(SyncWorld& world, Mapper& mapper) {
  for (int i = 0; i < 100; ++i) {
    mapper.see(world.robot.evidence());
    if (mapper.between(0, 14) == 0) mapper.close(world.robot.evidence());
    if (mapper.between(0, 39) == 0) world.server.restart();
    world.run_until(world.now + milliseconds(200));
  }
  mapper.close(world.robot.evidence());
}

void expect_all_held(const SyncWorld& world, const Mapper& mapper) {
  EXPECT_EQ(world.server.store.size(), mapper.closed.size());
  for (const auto& [sequence, submap] : mapper.closed) {
    const auto held = world.server.store.find(sequence);
    ASSERT_NE(held, world.server.store.end()) << "submap " << sequence;
    EXPECT_EQ(difference(submap, held->second), "") << "submap " << sequence;
  }
}

TEST(SyncProperty, WhateverTheLinkDoesTheServerEndsUpWithTheSameBits) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Mapper mapper(seed);
    const LinkFaults faults = random_faults(mapper);
    SyncWorld world(seed, faults, milliseconds(mapper.between(0, 300)));
    map_for_a_while(world, mapper);
    const auto& evidence = world.robot.evidence();
    ASSERT_TRUE(world.run_until(world.now + seconds(600), [&] { return evidence.synchronised(); }));
    EXPECT_EQ(evidence.submaps(), 0U);
    EXPECT_EQ(evidence.backlog_blocks(), 0U);
    EXPECT_EQ(evidence.dropped_submaps(), 0U);
    EXPECT_EQ(world.server.refusals, 0);
    EXPECT_TRUE(world.server.broken.empty()) << world.server.broken.front();
    expect_all_held(world, mapper);
    if (HasFailure()) break;
  }
}

TEST(SyncProperty, AnIdleLinkCarriesPosesAndTheirLazyAcksAlone) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Mapper mapper(seed);
    SyncWorld world(seed, random_faults(mapper));
    map_for_a_while(world, mapper);
    const auto& evidence = world.robot.evidence();
    ASSERT_TRUE(world.run_until(world.now + seconds(600), [&] { return evidence.synchronised(); }));
    world.run_until(world.now + seconds(5));
    const std::uint64_t before = world.frames();
    world.run_until(world.now + seconds(60));
    EXPECT_LE(world.frames() - before, 60U * 2U + 2U);  // A pose, an acknowledgement a second.
    EXPECT_GE(world.frames() - before, 60U);
    world.moving = false;
    world.run_until(world.now + seconds(20));
    const std::uint64_t standing = world.frames();
    world.run_until(world.now + seconds(60));
    EXPECT_LE(world.frames() - standing, 3U * 2U + 2U);
    EXPECT_GE(world.frames() - standing, 3U);
  }
}

TEST(SyncProperty, ALinkWithNothingToSayIsSilent) {
  SyncWorld world(1, {});
  Mapper mapper(1);
  world.posing = false;
  map_for_a_while(world, mapper);
  const auto& evidence = world.robot.evidence();
  ASSERT_TRUE(world.run_until(world.now + seconds(60), [&] { return evidence.synchronised(); }));
  world.run_until(world.now + seconds(5));
  const std::uint64_t before = world.frames();
  world.run_until(world.now + seconds(3600));
  EXPECT_EQ(world.frames(), before);
}

TEST(SyncProperty, AnOutageOfAMinuteIsCaughtUp) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Mapper mapper(seed);
    const LinkFaults faults = random_faults(mapper);
    SyncWorld world(seed, faults);
    map_for_a_while(world, mapper);
    for (auto* way : {&world.up, &world.down}) way->set_faults({.loss = 1.0});
    for (int i = 0; i < 60; ++i) {
      mapper.see(world.robot.evidence());
      world.run_until(world.now + seconds(1));
    }
    mapper.close(world.robot.evidence());
    for (auto* way : {&world.up, &world.down}) way->set_faults({});
    const auto& evidence = world.robot.evidence();
    ASSERT_TRUE(world.run_until(world.now + seconds(60), [&] { return evidence.synchronised(); }));
    expect_all_held(world, mapper);
  }
}

TEST(SyncProperty, AStoreMadeAnewGetsEverythingThatIsStillThere) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Mapper mapper(seed);
    SyncWorld world(seed, random_faults(mapper));
    for (int i = 0; i < 100; ++i) {
      mapper.see(world.robot.evidence());
      world.run_until(world.now + milliseconds(200));
      if (i != 50) continue;
      world.server.restart();
      world.server.store.clear();
      world.server.epoch = 2;
    }
    mapper.close(world.robot.evidence());
    const auto& evidence = world.robot.evidence();
    ASSERT_TRUE(world.run_until(world.now + seconds(600), [&] { return evidence.synchronised(); }));
    EXPECT_TRUE(world.server.broken.empty()) << world.server.broken.front();
    expect_all_held(world, mapper);
  }
}

TEST(SyncProperty, AStoreThatFellBackAsksFromWhatItHolds) {
  int refusals = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Mapper mapper(seed);
    SyncWorld world(seed, random_faults(mapper));
    auto& evidence = world.robot.evidence();
    Submap& submap = evidence.begin(0xB007, {}, 125);
    const auto change_the_block = [&] {
      const CellIndex cell{mapper.between(0, 15), mapper.between(0, 15)};
      ASSERT_TRUE(submap.surface.set(cell, {mapper.between(0, 500), 200}));
      evidence.touch(EvidenceLayer::surface, {cell});
    };
    const auto change_for_a_while = [&] {
      for (int i = 0; i < 20; ++i) {
        change_the_block();
        world.run_until(world.now + milliseconds(100));
      }
      ASSERT_TRUE(
          world.run_until(world.now + seconds(600), [&] { return evidence.synchronised(); }));
    };
    change_for_a_while();
    const auto backup = world.server.store;
    change_for_a_while();
    world.server.restart();
    world.server.store = backup;
    change_for_a_while();
    EXPECT_TRUE(same_cells(submap.surface, world.server.store.at(1).surface));
    refusals += world.server.refusals;
    if (HasFailure()) break;
  }
  EXPECT_GE(refusals, 50);
}

std::vector<std::uint8_t> path_of(int bytes) {
  std::vector<std::uint8_t> path;
  for (int i = 0; i < bytes; ++i) path.push_back(static_cast<std::uint8_t>(i % 251));
  return path;
}

TEST(SyncProperty, EachCommandIsHandedOutOnceWithItsWholePathAndReportedOn) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Mapper mapper(seed);
    SyncWorld world(seed, random_faults(mapper));
    ASSERT_TRUE(world.run_until(world.now + seconds(120), [&] { return bool(world.server.link); }));
    for (std::uint32_t revision = 0; revision < 5; ++revision) {
      const auto path = path_of(mapper.between(0, static_cast<int>(kMaxPathBytes)));
      Command command;
      command.id = 7;
      command.revision = revision;
      world.server.link->command(command, path, seconds(300), world.now);
      mapper.see(world.robot.evidence());
      // At 40 % loss either way one path in some thousands takes two to three minutes.
      ASSERT_TRUE(world.run_until(world.now + seconds(240),
                                  [&] { return world.orders.size() > revision; }));
      const auto& order = world.orders.back();
      EXPECT_EQ(order.command.revision, revision);
      EXPECT_EQ(order.path, path);
      const CommandReport report{7, revision, CommandState::accepted, ""};
      world.robot.report(report);
      ASSERT_TRUE(world.run_until(world.now + seconds(120), [&] {
        return !world.server.reports.empty() && world.server.reports.back() == report;
      }));
    }
    world.run_until(world.now + seconds(60));
    EXPECT_EQ(world.orders.size(), 5U);
    EXPECT_EQ(world.server.reports.size(), 5U);
    if (HasFailure()) break;
  }
}

TEST(SyncProperty, ACommandIsNeverValidLongerThanItWasMeantToBe) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Mapper mapper(seed);
    SyncWorld world(seed, random_faults(mapper));
    ASSERT_TRUE(world.run_until(world.now + seconds(120), [&] { return bool(world.server.link); }));
    const Duration valid = milliseconds(mapper.between(0, 60'000));
    const auto latest = static_cast<std::uint64_t>((world.now + valid) / milliseconds(1));
    Command command;
    command.id = 1;
    world.server.link->command(command, path_of(1500), valid, world.now);
    ASSERT_TRUE(world.run_until(world.now + seconds(120), [&] { return !world.orders.empty(); }));
    EXPECT_LE(world.orders[0].command.expires_clock_ms, latest);
    EXPECT_GE(world.orders[0].command.expires_clock_ms + 5'000, latest);
  }
}

}  // namespace
}  // namespace cairn::proto
