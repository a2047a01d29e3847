#include "server/world/world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/random_records.h"
#include "tests/unit/server/world/world_fixture.h"

namespace cairn::server {
namespace {

// ---- What the map shows -------------------------------------------------------------------------

TEST_F(WorldTest, HasAnEmptyMapWhenNew) {
  EXPECT_TRUE(world->snapshot()->tiles.empty());
  EXPECT_EQ(world->snapshot()->cell_size_mm, 125);
  EXPECT_EQ(world->submaps(), 0U);
}

TEST_F(WorldTest, ShowsASubmapThatIsStillOpen) {
  Surveyor robot;
  robot.begin({.x_mm = 8000});
  robot.see({3, 5}, 4, kFloor);
  deliver(robot);
  EXPECT_EQ(cell({64 + 3, 5}), kFloor);
  EXPECT_EQ(world->merged(), 0U);
}

TEST_F(WorldTest, FoldsASubmapIntoTheLongTermMapWhenItIsClosed) {
  Surveyor robot;
  robot.survey({-20, 50}, 0);
  deliver(robot);
  EXPECT_EQ(world->merged(), 1U);
  EXPECT_TRUE(shows(*world->snapshot(), fold_of(robot.closed)));
}

TEST_F(WorldTest, ShowsTheFoldOfItsSubmapsInTheirOrder) {
  Surveyor robot;
  robot.survey({0, 0}, 0);
  robot.survey({20, 20}, 30, {.x_mm = -8000, .y_mm = 8000, .z_mm = 1000});
  robot.survey({5, 5}, 20, {.x_mm = 333, .y_mm = -77, .z_mm = 5, .yaw_1e4rad = 7000});
  deliver(robot);
  EXPECT_EQ(world->merged(), 3U);
  EXPECT_TRUE(shows(*world->snapshot(), fold_of(robot.closed)));
}

TEST_F(WorldTest, UnlearnsWhatALaterSubmapSawThrough) {
  Surveyor robot;
  robot.survey({0, 0}, 0);
  deliver(robot);
  ASSERT_EQ(cell({12, 12}).height_mm, 600);
  for (int i = 0; i < 3; ++i) {
    robot.begin();
    robot.see({10, 10}, 5, {100, 240}, EvidenceLayer::seen_through);
    robot.close();
  }
  deliver(robot);
  EXPECT_FALSE(cell({12, 12}).known());
  EXPECT_EQ(cell({1, 1}), kFloor);
}

TEST_F(WorldTest, MovesAnOpenSubmapWithoutATrace) {
  Surveyor robot;
  robot.begin();
  robot.see({3, 5}, 4, kFloor);
  deliver(robot);
  Evidence moved;
  moved.heads.push_back(
      {.sequence = 1, .version = 2, .T_site_submap = {.x_mm = 80'000, .y_mm = -8'000}});
  stage(robot, moved);
  commit_and_publish();
  EXPECT_FALSE(cell({3, 5}).known());
  EXPECT_EQ(cell({640 + 3, -64 + 5}), kFloor);
  EXPECT_EQ(world->snapshot()->tiles.size(), 1U);
}

TEST_F(WorldTest, KeepsTheSubmapsOfTwoRobotsApart) {
  Surveyor ada(1);
  Surveyor grace(2);
  ada.survey({0, 0}, 0);
  grace.survey({100, 0}, 0);
  deliver(ada);
  deliver(grace);
  EXPECT_EQ(world->merged(), 2U);
  EXPECT_TRUE(shows(*world->snapshot(), fold_of({ada.closed[0], grace.closed[0]})));
}

TEST_F(WorldTest, LeavesASnapshotThatIsBeingReadAsItWas) {
  Surveyor robot;
  robot.survey({0, 0}, 0);
  deliver(robot);
  const auto old = world->snapshot();
  const MapSnapshot copy = *old;
  robot.survey({0, 0}, 500);
  deliver(robot);
  EXPECT_TRUE(same_tiles(*old, copy));
  EXPECT_FALSE(same_tiles(*old, *world->snapshot()));
}

TEST_F(WorldTest, CountsTheCellsItShows) {
  Surveyor robot;
  robot.survey({0, 0}, 0);
  deliver(robot);
  EXPECT_EQ(world->snapshot()->known_cells, 40U * 40U);
  EXPECT_GT(world->snapshot()->memory_bytes, 3U * 40U * 40U);
}

TEST_F(WorldTest, GivesEveryOtherMapAnotherVersion) {
  Surveyor robot;
  robot.begin();
  robot.see({0, 0}, 4, kFloor);
  deliver(robot);
  const auto before = world->snapshot();
  robot.see({20, 0}, 4, kFloor);
  for (const Evidence& evidence : robot.frames()) stage(robot, evidence);
  world->publish();  // As the timer does, whether or not what is staged is durable yet.
  const auto between = world->snapshot();
  EXPECT_TRUE(same_tiles(*before, *between) || before->version != between->version);
  commit_and_publish();
  const auto after = world->snapshot();
  EXPECT_FALSE(same_tiles(*before, *after));
  EXPECT_NE(before->version, after->version);
}

// ---- Taking evidence ----------------------------------------------------------------------------

TEST_F(WorldTest, IsNotChangedByTheSameFrameTwice) {
  Surveyor robot;
  robot.survey({0, 0}, 0);
  const std::vector<Evidence> frames = robot.frames();
  for (int i = 0; i < 2; ++i) {
    for (const Evidence& evidence : frames) EXPECT_TRUE(stage(robot, evidence).accepted);
    commit_and_publish();
  }
  EXPECT_EQ(world->commits(), 1U);
  EXPECT_TRUE(shows(*world->snapshot(), fold_of(robot.closed)));
}

TEST_F(WorldTest, EndsTheSameInWhateverOrderFramesArrive) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    found_anew();
    Surveyor robot;
    std::vector<Evidence> frames;
    for (int i = 0; i < 5; ++i) {
      robot.survey({7 * i, 3 * i}, 10 * i);
      std::ranges::move(robot.frames(), std::back_inserter(frames));
    }
    ASSERT_GT(frames.size(), 4U);
    frames.push_back(frames.front());
    std::ranges::shuffle(frames, std::mt19937_64(seed));
    for (const Evidence& evidence : frames) EXPECT_TRUE(stage(robot, evidence).refusals.empty());
    commit_and_publish();
    EXPECT_TRUE(shows(*world->snapshot(), fold_of(robot.closed)));
  }
}

/// A robot scribbles submaps while frames are lost, doubled and overtaken, and resends what was not
/// acknowledged.
TEST_F(WorldTest, HoldsExactlyWhatTheRobotWroteAfterLossDoublesAndReordering) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    found_anew();
    std::mt19937_64 random(seed);
    Surveyor robot(seed);
    for (int round = 0; round < 60; ++round) {
      if (round < 30) {
        if (round % 10 == 0) robot.begin({.x_mm = 1000 * round});
        robot.scribble(random, {4 * round, 3 * round});
        if (round % 10 == 9) robot.close();
      }
      std::vector<Evidence> frames = robot.frames();
      if (!frames.empty()) frames.push_back(frames.front());
      std::ranges::shuffle(frames, random);
      for (const Evidence& evidence : frames) {
        if (random() % 4 == 0) {
          robot.evidence.on_lost(evidence.number);
          continue;
        }
        const World::Staged staged = stage(robot, evidence);
        for (const proto::Refusal& refusal : staged.refusals) robot.evidence.on_refused(refusal);
        ASSERT_TRUE(world->commit());
        if (staged.refusals.empty()) robot.evidence.on_acked(evidence.number);
      }
      world->publish();
    }
    EXPECT_TRUE(robot.evidence.synchronised());
    EXPECT_EQ(world->merged(), 3U);
    EXPECT_TRUE(shows(*world->snapshot(), fold_of(robot.closed)));
    EXPECT_TRUE(is_sound());
  }
}

TEST_F(WorldTest, RefusesABlockThatBuildsOnMoreThanItHolds) {
  Surveyor robot;
  robot.begin();
  robot.see({0, 0}, 4, kFloor);
  Evidence evidence = robot.frames().front();
  evidence.blocks.front().base = 3;
  evidence.blocks.front().version = 5;
  const World::Staged staged = stage(robot, evidence);
  ASSERT_EQ(staged.refusals.size(), 1U);
  EXPECT_EQ(staged.refusals.front(), (proto::Refusal{1, evidence.blocks.front().key, 0}));
  commit_and_publish();
  EXPECT_FALSE(cell({0, 0}).known());
}

TEST_F(WorldTest, SaysWhatItHoldsOfABlockItRefuses) {
  Surveyor robot;
  robot.begin();
  robot.see({0, 0}, 4, kFloor);
  Evidence evidence = robot.frames().front();
  stage(robot, evidence);
  evidence.blocks.front().base = 7;
  evidence.blocks.front().version = 8;
  const World::Staged staged = stage(robot, evidence);
  ASSERT_EQ(staged.refusals.size(), 1U);
  EXPECT_EQ(staged.refusals.front().held, 1U);
}

TEST_F(WorldTest, RefusesHeightsThatDoNotFitTheBlocksTile) {
  Surveyor robot;
  robot.begin();
  robot.see({0, 0}, 4, kFloor);
  Evidence evidence = robot.frames().front();
  stage(robot, evidence);
  proto::BlockUpdate& update = evidence.blocks.front();
  update.base = 1;
  update.version = 2;
  for (Cell& each : update.delta.cells) each.height_mm += 90'000;
  EXPECT_EQ(stage(robot, evidence).refusals.size(), 1U);
  commit_and_publish();
  EXPECT_EQ(cell({0, 0}), kFloor);
}

TEST_F(WorldTest, MergesASubmapOnlyWhenItIsComplete) {
  Surveyor robot;
  robot.survey({0, 0}, 0);
  std::vector<Evidence> frames = robot.frames();
  Evidence late;
  late.blocks.push_back(frames.back().blocks.back());
  frames.back().blocks.pop_back();
  for (const Evidence& evidence : frames) stage(robot, evidence);
  commit_and_publish();
  EXPECT_EQ(world->merged(), 0U);
  stage(robot, late);
  commit_and_publish();
  EXPECT_EQ(world->merged(), 1U);
  EXPECT_TRUE(shows(*world->snapshot(), fold_of(robot.closed)));
}

TEST_F(WorldTest, DoesNotMergeASubmapWithABlockInAnOlderVersion) {
  Surveyor robot;
  robot.begin();
  robot.see({0, 0}, 4, kFloor);
  const std::vector<Evidence> old = robot.frames();
  robot.see({0, 0}, 4, {100, 200});
  robot.close();
  robot.evidence.on_lost(1);
  std::vector<Evidence> late = robot.frames();
  Evidence head;
  head.heads = std::exchange(late.front().heads, {});
  stage(robot, old.front());
  stage(robot, head);
  commit_and_publish();
  EXPECT_EQ(world->merged(), 0U);
  for (const Evidence& evidence : late) stage(robot, evidence);
  commit_and_publish();
  EXPECT_EQ(world->merged(), 1U);
  EXPECT_EQ(cell({0, 0}).height_mm, 100);
}

TEST_F(WorldTest, KeepsBlocksThatArriveBeforeTheirHead) {
  Surveyor robot;
  robot.begin({.x_mm = 16'000});
  robot.see({3, 5}, 4, kFloor);
  Evidence blocks = robot.frames().front();
  Evidence head;
  head.heads = std::exchange(blocks.heads, {});
  stage(robot, blocks);
  commit_and_publish();
  EXPECT_TRUE(world->snapshot()->tiles.empty());  // Nobody knows where they lie.
  restart();
  stage(robot, head);
  commit_and_publish();
  EXPECT_EQ(cell({128 + 3, 5}), kFloor);
}

TEST_F(WorldTest, TakesNothingMoreForASubmapThatIsMerged) {
  Surveyor robot;
  robot.survey({0, 0}, 0);
  deliver(robot);
  Evidence late;
  late.heads.push_back({.sequence = 1, .version = 99, .T_site_submap = {.x_mm = 80'000}});
  EXPECT_TRUE(stage(robot, late).accepted);
  commit_and_publish();
  EXPECT_EQ(world->submaps(), 1U);
  EXPECT_TRUE(shows(*world->snapshot(), fold_of(robot.closed)));
}

TEST_F(WorldTest, AcceptsNoMoreThanItsBoundOfEvidenceThatIsNotYetDurable) {
  Surveyor robot;
  robot.begin();
  robot.see({0, 0}, 4, kFloor);
  Evidence evidence = robot.frames().front();
  const proto::BlockUpdate sample = evidence.blocks.front();
  for (std::size_t i = 0; i < World::kMaxStagedBlocks; i += 16) {
    evidence.blocks.assign(16, sample);
    for (std::uint8_t block = 0; block < 16; ++block) {
      evidence.blocks[block].key.tile.tx = static_cast<std::int32_t>(i / 16);
      evidence.blocks[block].key.block = block;
    }
    ASSERT_TRUE(stage(robot, evidence).accepted) << i;
  }
  EXPECT_FALSE(stage(robot, evidence).accepted);
  ASSERT_TRUE(world->commit());
  EXPECT_TRUE(stage(robot, evidence).accepted);
}

TEST_F(WorldTest, CanStoreWhateverARobotMaySay) {
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    proto::testing::RandomRecords records(seed);
    Evidence evidence;
    proto::BlockUpdate block = records.block();
    block.base = 0;
    proto::SubmapHead head{
        .sequence = block.sequence,
        .version = records.between<std::uint32_t>(1, ~0U),
        .T_site_submap = {records.between(-proto::kMaxCoordinateMm, proto::kMaxCoordinateMm),
                          records.between(-proto::kMaxCoordinateMm, proto::kMaxCoordinateMm),
                          records.between(-proto::kMaxCoordinateMm, proto::kMaxCoordinateMm),
                          records.between(-proto::kMaxYaw1e4rad, proto::kMaxYaw1e4rad)},
        .closed = records.percent(70),
        .blocks = 1,
        .final_versions = block.version};
    evidence.heads.push_back(head);
    evidence.blocks.push_back(std::move(block));
    ASSERT_TRUE(world->stage("rover-1", seed, evidence).accepted);
    const Status done = world->commit();
    ASSERT_TRUE(done) << "seed " << seed << ": " << done.error().message;
  }
  world->publish();
  const auto before = world->snapshot();
  restart();
  EXPECT_TRUE(same_tiles(*before, *world->snapshot()));
  EXPECT_TRUE(is_sound());
}

// ---- The disk -----------------------------------------------------------------------------------

TEST_F(WorldTest, ShowsTheSameMapAfterARestart) {
  Surveyor robot;
  robot.survey({0, 0}, 0);
  robot.survey({20, 20}, 30, {.x_mm = -777, .y_mm = 8000, .yaw_1e4rad = -3000});
  robot.begin({.x_mm = 8000});
  robot.see({0, 0}, 30, {40, 210});
  robot.see({3, 3}, 3, {-20, 90}, EvidenceLayer::seen_through);
  deliver(robot);
  const auto before = world->snapshot();
  restart();
  EXPECT_TRUE(same_tiles(*before, *world->snapshot()));
  EXPECT_EQ(before->version, world->snapshot()->version);
  EXPECT_EQ(world->merged(), 2U);
  EXPECT_EQ(world->submaps(), 3U);
}

TEST_F(WorldTest, GoesOnWithAnOpenSubmapAfterARestart) {
  Surveyor robot;
  robot.begin();
  robot.see({0, 0}, 30, kFloor);
  deliver(robot);
  robot.evidence.on_acked(1);
  robot.evidence.on_acked(2);
  restart();
  robot.see({5, 5}, 30, {10, 210});
  robot.close();
  deliver(robot);
  EXPECT_EQ(world->merged(), 1U);
  EXPECT_TRUE(shows(*world->snapshot(), fold_of(robot.closed)));
}

TEST_F(WorldTest, GoesOnCountingMergesAfterARestart) {
  Surveyor robot;
  robot.survey({0, 0}, 0);
  deliver(robot);
  restart();
  robot.survey({0, 0}, 30);
  deliver(robot);
  world.reset();
  const auto store = reopen();
  const auto rows = store->submaps();
  ASSERT_TRUE(rows);
  std::vector<std::uint64_t> orders;
  for (const SubmapRow& row : *rows) orders.push_back(row.merge_order);
  std::ranges::sort(orders);
  EXPECT_EQ(orders, (std::vector<std::uint64_t>{1, 2}));
}

TEST_F(WorldTest, LosesWhatWasNotCommitted) {
  Surveyor robot;
  robot.begin();
  robot.see({0, 0}, 4, kFloor);
  for (const Evidence& evidence : robot.frames()) stage(robot, evidence);
  EXPECT_TRUE(world->has_staged());
  restart();
  EXPECT_FALSE(world->has_staged());
  EXPECT_TRUE(world->snapshot()->tiles.empty());
}

TEST_F(WorldTest, WritesNothingWhenNothingIsNew) {
  ASSERT_TRUE(world->commit());
  EXPECT_EQ(disk->commits, 0);
}

TEST_F(WorldTest, KeepsEvidenceWhoseCommitFailedAndWritesItExactlyOnce) {
  Surveyor robot;
  robot.survey({0, 0}, 0);
  robot.survey({20, 20}, 30);
  disk->failing = {1, 2};
  for (const Evidence& evidence : robot.frames()) stage(robot, evidence);
  EXPECT_FALSE(world->commit());
  EXPECT_FALSE(world->commit());
  EXPECT_EQ(world->merged(), 0U);
  EXPECT_TRUE(world->has_staged());
  commit_and_publish();
  EXPECT_FALSE(world->has_staged());
  EXPECT_EQ(world->merged(), 2U);
  EXPECT_TRUE(shows(*world->snapshot(), fold_of(robot.closed)));
  restart();
  EXPECT_TRUE(shows(*world->snapshot(), fold_of(robot.closed)));
}

/// Whichever commit fails, the end is the same.
TEST_F(WorldTest, EndsTheSameWhicheverCommitFails) {
  for (int failing = 1; failing <= 8; ++failing) {
    SCOPED_TRACE("commit " + std::to_string(failing));
    found_anew();
    disk->commits = 0;
    disk->failing = {failing};
    Surveyor robot;
    constexpr int kSurveys = 9;
    for (int i = 0; i < kSurveys; ++i) {
      robot.survey({10 * i, 0}, 20 * i);
      for (const Evidence& evidence : robot.frames()) {
        stage(robot, evidence);
        (void)world->commit();
      }
    }
    commit_and_publish();
    EXPECT_GE(disk->commits, failing);
    EXPECT_TRUE(shows(*world->snapshot(), fold_of(robot.closed)));
    EXPECT_EQ(world->merged(), kSurveys);
    EXPECT_TRUE(is_sound());
  }
}

TEST_F(WorldTest, TakesMoreEvidenceOfASubmapWhoseMergeCouldNotBeWritten) {
  Surveyor robot;
  robot.survey({0, 0}, 0);
  disk->failing = {1};
  for (const Evidence& evidence : robot.frames()) stage(robot, evidence);
  EXPECT_FALSE(world->commit());
  robot.evidence.on_session(true);  // The robot resends what was never acknowledged.
  deliver(robot);
  EXPECT_EQ(world->merged(), 1U);
  EXPECT_TRUE(shows(*world->snapshot(), fold_of(robot.closed)));
}

// ---- Numbers of commands ------------------------------------------------------------------------

TEST_F(WorldTest, NeverGivesACommandANumberTwice) {
  std::set<std::uint64_t> numbers;
  for (int i = 0; i < 6; ++i) {
    if (i % 2 == 0) restart();
    const auto number = world->next_command_id();
    ASSERT_TRUE(number);
    EXPECT_NE(*number, 0U);
    EXPECT_TRUE(numbers.insert(*number).second) << *number;
  }
}

TEST_F(WorldTest, GivesNoNumberThatIsNotDurable) {
  disk->failing = {1};
  EXPECT_FALSE(world->next_command_id());
  EXPECT_TRUE(world->next_command_id());
}

}  // namespace
}  // namespace cairn::server
