#include "robot_agent/spool/spool.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>

#include "tests/support/process.h"
#include "tests/unit/robot_agent/spool/samples.h"

namespace cairn::agent {
namespace {

using namespace std::chrono_literals;
using testing::kOwner;
using testing::see;

constexpr std::uint64_t kBoot = 77;

/// One run of an agent: its sender and its spool.
struct AgentRun {
  explicit AgentRun(const SpoolConfig& config, std::uint64_t run_boot)
      : boot(run_boot), spool(config, run_boot) {}

  void look() {
    clock += 500ms;
    spool.look(sender, clock);
  }
  void map(int submaps, int size = 40) {
    for (int i = 0; i < submaps; ++i) {
      sender.begin(boot, {}, 125);
      see(sender, {i * 50, 0}, size, random);
      sender.close();
    }
  }
  bool flush() { return spool.flush(sender, clock, 10s); }
  /// Everything arrives.
  void deliver() {
    while (sender.has_news()) {
      proto::FrameWriter frame({proto::Direction::up, 1, ++number});
      if (sender.fill(frame, number) == 0) break;
      sender.on_acked(number);
    }
  }
  bool eventually(const std::function<bool()>& condition) {
    return test::eventually(
        [&] {
          look();
          return condition();
        },
        10s);
  }

  std::uint64_t boot;
  proto::EvidenceSender sender;
  std::mt19937 random{5};
  MonotonicTime clock{};
  std::uint32_t number = 0;
  Spool spool;
};

class SpoolTest : public ::testing::Test {
 protected:
  SpoolConfig config(std::uint64_t most_bytes = 1U << 30U) {
    return {temp.path() / "spool", most_bytes, kOwner, {}};
  }
  std::size_t files() {
    std::size_t count = 0;
    std::error_code not_there_yet;
    for (const auto& file :
         std::filesystem::directory_iterator(temp.path() / "spool", not_there_yet)) {
      count += file.path().extension() == SpoolFolder::kSuffix ? 1 : 0;
    }
    return count;
  }

  test::TempFolder temp;
};

TEST_F(SpoolTest, WhatIsClosedIsOnDiskUntilTheServerHoldsIt) {
  AgentRun run(config(), kBoot);
  run.map(3);
  ASSERT_TRUE(run.eventually([&] { return files() == 3; }));
  EXPECT_EQ(run.spool.report().submaps, 3U);
  run.deliver();
  EXPECT_TRUE(run.eventually([&] { return files() == 0; }));
  EXPECT_EQ(run.spool.report().submaps, 0U);
}

TEST_F(SpoolTest, TheOpenSubmapIsWrittenEveryFewSecondsOfItsChanges) {
  AgentRun run(config(), kBoot);
  run.sender.begin(kBoot, {}, 125);
  see(run.sender, {0, 0}, 10, run.random);
  for (int i = 0; i < 6; ++i) run.look();
  ASSERT_TRUE(run.eventually([&] { return files() == 1; }));
  const auto before = run.spool.report().bytes;
  see(run.sender, {100, 0}, 30, run.random);
  EXPECT_TRUE(run.eventually([&] { return run.spool.report().bytes > before; }));
}

TEST_F(SpoolTest, TheNextRunDeliversWhatWasLeftUnderItsOwnName) {
  std::optional<proto::KeptSubmap> left;
  {
    AgentRun first(config(), kBoot);
    first.map(2);
    left = first.sender.copy_of({kBoot, 2});
    ASSERT_TRUE(first.flush());
  }
  AgentRun next(config(), kBoot + 1);
  ASSERT_TRUE(next.eventually([&] { return next.sender.submaps() == 2; }));
  EXPECT_TRUE(next.spool.all_taken_up());
  const auto again = next.sender.copy_of({kBoot, 2});
  ASSERT_TRUE(again);
  EXPECT_TRUE(testing::same(*again, *left));
  next.deliver();
  EXPECT_TRUE(next.eventually([&] { return files() == 0; }));
}

TEST_F(SpoolTest, WhatTheSenderHasNoRoomForWaitsOnDiskAndComesBack) {
  constexpr int kMore = 5;
  AgentRun run(config(), kBoot);
  for (int i = 0; i < static_cast<int>(proto::EvidenceSender::kMaxSubmaps) + kMore; ++i) {
    run.map(1, 2);
    ASSERT_TRUE(i % 8 != 7 || run.flush());
  }
  ASSERT_TRUE(run.flush());
  ASSERT_EQ(run.sender.dropped_submaps(), static_cast<unsigned>(kMore));
  run.look();
  ASSERT_TRUE(run.flush());
  EXPECT_EQ(run.spool.report().dropped, 0U);
  EXPECT_EQ(run.spool.report().submaps, proto::EvidenceSender::kMaxSubmaps + kMore);
  EXPECT_TRUE(run.eventually([&] {
    run.deliver();
    return files() == 0;
  }));
  EXPECT_EQ(run.spool.report().submaps, 0U);
}

TEST_F(SpoolTest, WhatHadToGoIsCountedAndSaid) {
  AgentRun run(config(20'000), kBoot);
  run.map(30);
  ASSERT_TRUE(run.eventually([&] { return run.spool.report().dropped > 3; }));
  EXPECT_GT(run.spool.report().thinned, 3U);
  EXPECT_LE(run.spool.report().bytes, 20'000U);
  const auto news = run.spool.take_news();
  ASSERT_FALSE(news.empty());
  EXPECT_NE(news[0].find("evidence had to go"), std::string::npos) << news[0];
}

TEST_F(SpoolTest, AFolderThatCannotBeUsedIsSaidOnceAndUsedAsSoonAsItCan) {
  std::ofstream(temp.path() / "spool") << "a file";
  AgentRun run(config(), kBoot);
  run.map(2);
  ASSERT_TRUE(run.eventually([&] { return run.spool.report().failed; }));
  for (int i = 0; i < 100; ++i) run.look();
  EXPECT_EQ(run.spool.take_news().size(), 1U);
  EXPECT_EQ(run.sender.submaps(), 2U);
  EXPECT_EQ(run.spool.report().submaps, 2U);
  std::filesystem::remove(temp.path() / "spool");
  EXPECT_TRUE(run.eventually([&] { return !run.spool.report().failed; }));
  EXPECT_EQ(run.spool.take_news().size(), 1U);
}

TEST_F(SpoolTest, DamagedFilesAreSaidAndCountedAndTheOthersDelivered) {
  {
    AgentRun first(config(), kBoot);
    first.map(3);
    ASSERT_TRUE(first.flush());
  }
  auto file = std::filesystem::directory_iterator(temp.path() / "spool");
  while (file->path().extension() != SpoolFolder::kSuffix) ++file;
  std::filesystem::resize_file(file->path(), 100);
  AgentRun next(config(), kBoot + 1);
  ASSERT_TRUE(next.eventually([&] { return next.spool.all_taken_up(); }));
  EXPECT_EQ(next.sender.submaps(), 2U);
  EXPECT_EQ(next.spool.report().dropped, 1U);
  EXPECT_EQ(next.spool.take_news().size(), 2U);  // What waits; what cannot be delivered.
}

}  // namespace
}  // namespace cairn::agent
