#include "proto/sync/robot_link.h"

#include <gtest/gtest.h>

#include <random>

namespace cairn::proto {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::uint64_t kBoot = 77;

class RobotLinkTest : public ::testing::Test {
 protected:
  static std::vector<std::uint8_t> down(std::uint32_t session, std::uint32_t number,
                                        const std::vector<Record>& records) {
    FrameWriter writer({Direction::down, session, number});
    for (const auto& record : records) EXPECT_TRUE(writer.add(record));
    return std::move(writer).finish();
  }
  std::optional<Frame> next() {
    const auto bytes = link.next_frame(now);
    if (!bytes) return std::nullopt;
    auto frame = decode_frame(*bytes, Direction::up);
    EXPECT_TRUE(frame);
    return *std::move(frame);
  }
  template <class R>
  static const R* find(const std::optional<Frame>& frame) {
    if (!frame) return nullptr;
    for (const auto& record : frame->records) {
      if (const auto* r = std::get_if<R>(&record)) return r;
    }
    return nullptr;
  }
  void welcome(std::uint32_t session = 5, std::uint64_t epoch = 1) {
    ASSERT_NE(find<Hello>(next()), nullptr);
    link.on_frame(down(session, 1, {Welcome{session, kBoot, epoch}}), now);
    ASSERT_TRUE(link.connected());
  }
  void see() {
    auto& evidence = link.evidence();
    if (evidence.open_submap() == nullptr) evidence.begin(kBoot, {}, 125);
    ASSERT_TRUE(evidence.open_submap()->surface.set({++seen_, 0}, {5, 200}));
    evidence.touch(EvidenceLayer::surface, {{seen_, 0}});
  }
  /// Heights that no codec can shorten.
  void see_noise(int cells) {
    std::mt19937 random(5);
    auto& evidence = link.evidence();
    evidence.begin(kBoot, {}, 125);
    std::vector<CellIndex> changed;
    for (int i = 0; i < cells; ++i) {
      const CellIndex cell{i % 200, i / 200};
      const auto height = static_cast<std::int32_t>(random() % 20'000);
      ASSERT_TRUE(evidence.open_submap()->surface.set(cell, {height, 200}));
      changed.push_back(cell);
    }
    evidence.touch(EvidenceLayer::surface, changed);
  }
  static PoseReport at(std::int32_t x_mm) {
    PoseReport pose;
    pose.T_site_robot.x_mm = x_mm;
    return pose;
  }
  static Command stop(std::uint64_t id) {
    Command c;
    c.id = id;
    return c;
  }

  RobotLink link{{.robot = "rover", .site = "quarry", .boot = kBoot}, 28};
  MonotonicTime now = seconds(10);
  int seen_ = 0;
};

TEST_F(RobotLinkTest, SaysHelloEverLessOftenUntilItIsWelcomed) {
  for (const int wait_ms : {300, 600, 1200, 2400, 3000, 3000}) {
    const auto frame = next();
    ASSERT_NE(find<Hello>(frame), nullptr);
    EXPECT_EQ(frame->header.session, 0U);
    EXPECT_EQ(find<Hello>(frame)->clock_ms, static_cast<std::uint64_t>(now / milliseconds(1)));
    EXPECT_EQ(link.next_due(now), now + milliseconds(wait_ms));
    EXPECT_FALSE(next());
    now = link.next_due(now);
  }
}

TEST_F(RobotLinkTest, AWelcomeForAnotherBootIsNotOurs) {
  (void)next();
  link.on_frame(down(5, 1, {Welcome{5, kBoot + 1, 1}}), now);
  EXPECT_FALSE(link.connected());
  EXPECT_FALSE(link.silence(now));
}

TEST_F(RobotLinkTest, FramesOfASessionCountFromOne) {
  welcome();
  see();
  const auto frame = next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->header, (FrameHeader{Direction::up, 5, 1}));
}

TEST_F(RobotLinkTest, APoseIsSentAtItsPeriodAndNeverTwice) {
  welcome();
  link.set_pose(at(0));
  EXPECT_NE(find<PoseReport>(next()), nullptr);
  EXPECT_FALSE(next());
  link.set_pose(at(500));
  EXPECT_FALSE(next());
  EXPECT_EQ(link.next_due(now), now + seconds(1));
  now += seconds(1);
  EXPECT_NE(find<PoseReport>(next()), nullptr);
  now += seconds(2);
  EXPECT_FALSE(next()) << "an old pose is no news";
}

TEST_F(RobotLinkTest, ARobotThatStandsSaysSoRarelyUntilItMoves) {
  welcome();
  link.set_pose(at(0));
  ASSERT_NE(find<PoseReport>(next()), nullptr);
  now += seconds(5);
  link.set_pose(at(4));  // Its pose trembles.
  EXPECT_FALSE(next());
  EXPECT_EQ(link.next_due(now), now + seconds(15));
  link.set_pose(at(100));
  EXPECT_NE(find<PoseReport>(next()), nullptr);
  link.set_pose(at(100));
  now += seconds(20);
  EXPECT_NE(find<PoseReport>(next()), nullptr);
}

TEST_F(RobotLinkTest, ThePoseTakesTheStateOfTheSpoolAlongWhenItChangedEveryFewSeconds) {
  welcome();
  int told = 0;
  for (int second = 0; second < 40; ++second) {
    const std::uint64_t bytes = second < 20 ? 4'000 + static_cast<unsigned>(second) : 4'019;
    link.set_spool({false, 3, bytes, 1, 0});
    link.on_frame(down(5, static_cast<std::uint32_t>(second) + 2, {Ack{0, 0}}), now);
    PoseReport pose;
    pose.speed_mm_s = 500;
    pose.clock_ms = static_cast<std::uint64_t>(second);
    link.set_pose(pose);
    const auto frame = next();
    if (const auto* spool = find<SpoolReport>(frame)) {
      EXPECT_EQ(*spool, (SpoolReport{false, 3, bytes, 1, 0}));
      EXPECT_NE(find<PoseReport>(frame), nullptr);
      ++told;
    }
    now += seconds(1);
  }
  EXPECT_EQ(told, 5) << "four times as it changes, then as it stays";
}

TEST_F(RobotLinkTest, ARobotUnderWayAsksWhetherTheServerIsThere) {
  welcome();
  PoseReport pose;
  pose.speed_mm_s = 500;
  for (const bool asks : {false, false, true, true}) {
    pose.clock_ms += 1'000;
    link.set_pose(pose);
    const auto frame = next();
    ASSERT_NE(find<PoseReport>(frame), nullptr);
    EXPECT_EQ(find<PoseReport>(frame)->asks, asks) << pose.clock_ms;
    now += seconds(1);
  }
  link.on_frame(down(5, 2, {Ack{2, 0}}), now);
  pose.clock_ms += 1'000;
  link.set_pose(pose);
  EXPECT_FALSE(find<PoseReport>(next())->asks);
}

TEST_F(RobotLinkTest, ReportsAndPoseLeaveInAShortFrameBeforeEvidence) {
  welcome();
  see();
  link.set_pose({});
  link.report({3, 0, CommandState::accepted, ""});
  const auto frame = next();
  ASSERT_EQ(frame->records.size(), 2U);
  EXPECT_TRUE(std::holds_alternative<CommandReport>(frame->records[0]));
  EXPECT_TRUE(std::holds_alternative<PoseReport>(frame->records[1]));
  EXPECT_NE(find<EvidencePatch>(next()), nullptr);
}

TEST_F(RobotLinkTest, EvidenceLeavesAtTheBudgetsPace) {
  welcome();
  see_noise(20'000);
  const MonotonicTime begin = now;
  const std::uint64_t before = link.counters().bytes_sent;
  while (now < begin + seconds(2)) {
    while (next()) {
    }
    now = std::max(now + Duration(1), link.next_due(now));
  }
  const auto sent = static_cast<double>(link.counters().bytes_sent - before);
  EXPECT_GT(sent * 8.0, 9'600 * 1.5);
  EXPECT_LT(sent * 8.0, 9'600 * 2.0 + 2 * 8 * Budget::kLongestPacket);
}

TEST_F(RobotLinkTest, AReportGoesOutThoughTheEvidenceWindowIsFull) {
  welcome();
  for (int i = 0; i < 60'000; ++i) see();
  while (next()) {
  }
  ASSERT_TRUE(link.evidence().has_news());
  link.report({3, 0, CommandState::stopped, "tilt"});
  const auto frame = next();
  ASSERT_NE(find<CommandReport>(frame), nullptr);
  EXPECT_EQ(frame->records.size(), 1U);
}

TEST_F(RobotLinkTest, LostEvidenceIsSentAgainAndCounted) {
  welcome();
  see();
  ASSERT_NE(find<EvidencePatch>(next()), nullptr);
  EXPECT_FALSE(next());
  now = link.next_due(now);
  ASSERT_NE(find<EvidencePatch>(next()), nullptr);
  EXPECT_EQ(link.counters().frames_lost, 1U);
  link.on_frame(down(5, 2, {Ack{2, 0}}), now);
  EXPECT_TRUE(link.evidence().synchronised());
}

TEST_F(RobotLinkTest, ACommandIsAcknowledgedSoonAndHandedOutOnce) {
  welcome();
  EXPECT_EQ(link.on_frame(down(5, 2, {stop(1)}), now).size(), 1U);
  EXPECT_FALSE(next());
  EXPECT_EQ(link.next_due(now), now + RobotLink::kAckDelay);
  now = link.next_due(now);
  const auto frame = next();
  ASSERT_NE(find<Ack>(frame), nullptr);
  EXPECT_EQ(find<Ack>(frame)->cumulative, 2U);
  EXPECT_TRUE(link.on_frame(down(5, 2, {stop(1)}), now).empty());
  EXPECT_TRUE(link.on_frame(down(5, 3, {stop(1)}), now).empty());
}

TEST_F(RobotLinkTest, FramesWithAcksAloneAreNotAnswered) {
  welcome();
  for (std::uint32_t n = 2; n < 50; ++n) link.on_frame(down(5, n, {Ack{0, 0}}), now);
  now += seconds(100);
  EXPECT_FALSE(next());
}

TEST_F(RobotLinkTest, AnOlderCommandIsAnsweredWithSupersededUnlessItsFateWasTold) {
  welcome();
  link.on_frame(down(5, 2, {stop(2)}), now);
  link.report({2, 0, CommandState::arrived, ""});
  link.on_frame(down(5, 3, {stop(3)}), now);
  link.on_frame(down(5, 4, {stop(1)}), now);
  (void)next();
  link.on_frame(down(5, 5, {stop(2), Ack{1, 0}}), now);
  link.on_frame(down(5, 6, {stop(2)}), now);
  const auto frame = next();
  ASSERT_NE(find<CommandReport>(frame), nullptr);
  EXPECT_EQ(find<CommandReport>(frame)->state, CommandState::arrived);
}

TEST_F(RobotLinkTest, AResetMakesItSayHelloAndSendWhatWasUnderWay) {
  welcome(5);
  see();
  ASSERT_NE(find<EvidencePatch>(next()), nullptr);
  link.on_frame(down(4, 9, {Reset{}}), now);
  EXPECT_TRUE(link.connected()) << "that was another session";
  link.on_frame(down(5, 9, {Reset{}}), now);
  EXPECT_FALSE(link.connected());
  welcome(6);
  const auto frame = next();
  EXPECT_EQ(frame->header.number, 1U);
  EXPECT_NE(find<EvidencePatch>(frame), nullptr);
}

TEST_F(RobotLinkTest, ALateWelcomeDoesNotReviveASessionThatWasLeft) {
  welcome(5);
  link.on_frame(down(5, 9, {Reset{}}), now);
  (void)next();
  link.on_frame(down(5, 1, {Welcome{5, kBoot, 1}}), now);
  EXPECT_FALSE(link.connected());
}

TEST_F(RobotLinkTest, SilenceWhileSomethingIsUnansweredLeadsToAHelloThatResumesTheSession) {
  welcome(5);
  see();
  for (const auto start = now; now < start + RobotLink::kSilence; now = link.next_due(now)) {
    const auto frame = next();
    EXPECT_EQ(find<Hello>(frame), nullptr);
  }
  const auto last_number = link.counters().frames_sent - 1;
  EXPECT_NE(find<Hello>(next()), nullptr);
  link.on_frame(down(5, 2, {Welcome{5, kBoot, 1}}), now);
  const auto frame = next();
  ASSERT_NE(find<EvidencePatch>(frame), nullptr);
  EXPECT_EQ(frame->header.number, last_number + 1) << "numbers of a session are used once";
}

TEST_F(RobotLinkTest, AnotherStoreIsSentEverythingAgain) {
  welcome(5, 1);
  see();
  (void)next();
  link.on_frame(down(5, 2, {Ack{1, 0}}), now);
  EXPECT_TRUE(link.evidence().synchronised());
  link.on_frame(down(5, 3, {Reset{}}), now);
  welcome(6, 2);
  EXPECT_FALSE(link.evidence().synchronised());
}

TEST_F(RobotLinkTest, ARobotIdInUseIsRetriedForAWhileThenFinal) {
  const auto reject = down(0, 0, {Reject{kBoot, RejectReason::robot_id_in_use, ""}});
  const auto start = now;
  while (!link.rejected()) {
    ASSERT_LE(now, start + seconds(40));
    (void)next();
    link.on_frame(reject, now);
    now = link.next_due(now);
  }
  EXPECT_GE(now, start + seconds(30));
  EXPECT_EQ(link.rejected()->code, ErrorCode::conflict);
  EXPECT_NE(link.rejected()->message.find("'rover'"), std::string::npos);
  EXPECT_FALSE(next());
}

TEST_F(RobotLinkTest, OtherRejectionsAreFinalAndSayWhatToDo) {
  (void)next();
  link.on_frame(down(0, 0, {Reject{kBoot + 1, RejectReason::unknown_site, ""}}), now);
  EXPECT_FALSE(link.rejected()) << "that answered another boot";
  link.on_frame(down(0, 0, {Reject{kBoot, RejectReason::unknown_site, "try pit"}}), now);
  ASSERT_TRUE(link.rejected());
  EXPECT_EQ(link.rejected()->code, ErrorCode::not_found);
  EXPECT_NE(link.rejected()->message.find("try pit"), std::string::npos);
}

TEST_F(RobotLinkTest, MalformedFramesAreCountedAndBringNothing) {
  welcome();
  EXPECT_TRUE(link.on_frame(std::vector<std::uint8_t>{1, 2, 3}, now).empty());
  EXPECT_EQ(link.counters().frames_malformed, 1U);
}

TEST_F(RobotLinkTest, BytesAreCountedWithTheCarriersOverhead) {
  const auto bytes = link.next_frame(now);
  EXPECT_EQ(link.counters().bytes_sent, bytes->size() + 28);
  const auto answer = down(5, 1, {Welcome{5, kBoot, 1}});
  link.on_frame(answer, now);
  EXPECT_EQ(link.counters().bytes_received, answer.size() + 28);
}

TEST_F(RobotLinkTest, GoodbyeNeedsASession) {
  EXPECT_FALSE(link.goodbye());
  welcome();
  const auto frame = decode_frame(*link.goodbye(), Direction::up);
  EXPECT_TRUE(std::holds_alternative<Bye>(frame->records.at(0)));
}

CorridorRequest request_at(std::int32_t x_mm) {
  CorridorRequest request;
  request.command = 4;
  request.x_mm = x_mm;
  return request;
}

TEST_F(RobotLinkTest, ARequestIsSentUntilAcknowledgedAndInEverySession) {
  welcome();
  link.request(request_at(1));
  const auto first = next();
  ASSERT_NE(find<CorridorRequest>(first), nullptr);
  EXPECT_EQ(find<CorridorRequest>(next()), nullptr);
  bool again = false;
  for (const auto end = now + seconds(10); now < end && !again; now = link.next_due(now)) {
    again = find<CorridorRequest>(next()) != nullptr;
  }
  EXPECT_TRUE(again);
  link.on_frame(down(5, 2, {Reset{}}), now);
  welcome(6);
  const auto anew = next();
  ASSERT_NE(find<CorridorRequest>(anew), nullptr);
  link.on_frame(down(6, 2, {Ack{anew->header.number, 0}}), now);
  for (const auto end = now + seconds(60); now < end; now = link.next_due(now)) {
    EXPECT_EQ(find<CorridorRequest>(next()), nullptr);
  }
}

TEST_F(RobotLinkTest, OnlyTheNewestRequestIsMade) {
  welcome();
  link.request(request_at(1));
  link.request(request_at(2));
  EXPECT_EQ(find<CorridorRequest>(next())->x_mm, 2);
}

TEST_F(RobotLinkTest, ACorridorIsHandedOutAfterItsOrderAndAcknowledged) {
  welcome();
  CorridorPart part;
  part.command = 4;
  part.directions = {7};
  EXPECT_TRUE(link.on_frame(down(5, 2, {part}), now).empty());
  EXPECT_TRUE(link.take_corridors().empty());
  Command command;
  command.id = 4;
  EXPECT_EQ(link.on_frame(down(5, 3, {command}), now).size(), 1U);
  EXPECT_EQ(link.take_corridors(), std::vector<CorridorPart>{part});
  now += RobotLink::kMapAckDelay;
  EXPECT_NE(find<Ack>(next()), nullptr);
}

}  // namespace
}  // namespace cairn::proto
