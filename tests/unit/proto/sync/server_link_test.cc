#include "proto/sync/server_link.h"

#include <gtest/gtest.h>

namespace cairn::proto {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class ServerLinkTest : public ::testing::Test {
 protected:
  std::vector<ServerLink::Event> arrive(std::uint32_t number, std::vector<Record> records) {
    return link.on_frame({{Direction::up, 5, number}, std::move(records)}, 100, now);
  }
  std::optional<Frame> next() {
    const auto bytes = link.next_frame(now);
    if (!bytes) return std::nullopt;
    return *decode_frame(*bytes, Direction::down);
  }
  template <class R>
  static const R* find(const std::optional<Frame>& frame) {
    if (!frame) return nullptr;
    for (const auto& record : frame->records) {
      if (const auto* r = std::get_if<R>(&record)) return r;
    }
    return nullptr;
  }
  void drain() {
    while (next()) {
    }
  }
  static Record head(std::uint32_t sequence = 1) {
    return SubmapHead{sequence, 1, {}, false, 0, 0};
  }
  static PoseReport pose(std::uint64_t clock_ms) {
    PoseReport p;
    p.clock_ms = clock_ms;
    return p;
  }
  static Command command(std::uint64_t id, std::uint32_t revision = 0) {
    Command c;
    c.id = id;
    c.revision = revision;
    return c;
  }

  MonotonicTime now = seconds(50);
  ServerLink link{5, Hello{"rover", "quarry", 77, 125, 1'000}, 9, 28, now};
};

TEST_F(ServerLinkTest, BeginsWithAWelcomeAndRepeatsItWhenAsked) {
  for (int i = 0; i < 2; ++i) {
    const auto frame = next();
    ASSERT_NE(find<Welcome>(frame), nullptr);
    EXPECT_EQ(*find<Welcome>(frame), (Welcome{5, 77, 9}));
    EXPECT_EQ(frame->header.session, 5U);
    EXPECT_FALSE(next());
    link.welcome_again();
  }
}

TEST_F(ServerLinkTest, EvidenceIsAcknowledgedOnlyWhenDurable) {
  drain();
  const auto events = arrive(1, {head()});
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(std::get<ServerLink::Evidence>(events[0]).number, 1U);
  now += seconds(10);
  EXPECT_FALSE(next());
  link.durable(1);
  const auto frame = next();
  ASSERT_NE(find<Ack>(frame), nullptr);
  EXPECT_EQ(find<Ack>(frame)->cumulative, 1U);
}

TEST_F(ServerLinkTest, AFrameSeenBeforeBringsNothingButItsAcknowledgement) {
  drain();
  (void)arrive(1, {head()});
  EXPECT_TRUE(arrive(1, {head()}).empty());
  now += seconds(2);
  EXPECT_FALSE(next()) << "it is not durable yet";
  link.durable(1);
  EXPECT_NE(find<Ack>(next()), nullptr);
  EXPECT_TRUE(arrive(1, {head()}).empty());
  now += RobotLink::kAckDelay;
  EXPECT_NE(find<Ack>(next()), nullptr);
}

TEST_F(ServerLinkTest, FramesMayBecomeDurableInAnyOrder) {
  drain();
  for (std::uint32_t n = 1; n <= 3; ++n) (void)arrive(n, {head(n)});
  now += RobotLink::kMapAckDelay;
  link.durable(3);
  link.durable(1);
  const auto delay_ms = static_cast<std::uint16_t>(RobotLink::kMapAckDelay / milliseconds(1));
  EXPECT_EQ(*find<Ack>(next()), (Ack{1, 0b1, delay_ms}));
  link.durable(2);
  EXPECT_EQ(*find<Ack>(next()), (Ack{3, 0, Ack::kDelayUnknown})) << "the newest was told before";
}

TEST_F(ServerLinkTest, PosesAreAcknowledgedLazily) {
  drain();
  EXPECT_EQ(arrive(1, {pose(2'000)}).size(), 1U);
  EXPECT_EQ(link.next_due(now), now + ServerLink::kLazyAckDelay);
  now += ServerLink::kLazyAckDelay;
  EXPECT_NE(find<Ack>(next()), nullptr);
  EXPECT_FALSE(next());
}

TEST_F(ServerLinkTest, APoseThatAsksIsAnsweredAtOnce) {
  drain();
  PoseReport asking = pose(2'000);
  asking.asks = true;
  (void)arrive(1, {asking});
  EXPECT_EQ(link.next_due(now), now + RobotLink::kAckDelay);
}

TEST_F(ServerLinkTest, AnOlderPoseThanTheNewestIsNoEvent) {
  EXPECT_EQ(arrive(2, {pose(2'000)}).size(), 1U);
  EXPECT_TRUE(arrive(1, {pose(1'500)}).empty());
}

TEST_F(ServerLinkTest, AReportThatWasOvertakenIsNoEvent) {
  EXPECT_EQ(arrive(2, {CommandReport{1, 0, CommandState::arrived, ""}}).size(), 1U);
  EXPECT_TRUE(arrive(1, {CommandReport{1, 0, CommandState::accepted, ""}}).empty());
  EXPECT_TRUE(arrive(3, {CommandReport{1, 0, CommandState::arrived, ""}}).empty());
  EXPECT_EQ(arrive(4, {CommandReport{2, 0, CommandState::accepted, ""}}).size(), 1U);
}

TEST_F(ServerLinkTest, AStopOvertakesEverythingElse) {
  drain();
  for (std::uint32_t n = 0; n < ServerLink::kMaxRefusals + 9; ++n) link.refuse({n, {}, 0});
  link.command(command(1), std::vector<std::uint8_t>(kMaxPathBytes), seconds(9), now);
  (void)arrive(1, {CommandReport{8, 0, CommandState::accepted, ""}});
  link.command(command(2), {}, seconds(9), now);
  const auto frame = next();
  ASSERT_TRUE(std::holds_alternative<Command>(frame->records.at(0)));
  EXPECT_EQ(std::get<Command>(frame->records[0]).id, 2U);
}

CorridorPart corridor_of(std::uint64_t command) {
  CorridorPart part;
  part.command = command;
  part.directions = {1, 2, 3};
  return part;
}

TEST_F(ServerLinkTest, ACorridorFollowsItsCommandUntilAcknowledged) {
  drain();
  link.command(command(1), std::vector<std::uint8_t>(40), seconds(9), now);
  link.corridor(corridor_of(1));
  const auto order = next();
  EXPECT_NE(find<Command>(order), nullptr);
  EXPECT_NE(find<PathPart>(order), nullptr);
  EXPECT_EQ(find<CorridorPart>(order), nullptr);
  const auto after = next();
  ASSERT_NE(find<CorridorPart>(after), nullptr);
  EXPECT_FALSE(next());
  bool again = false;
  for (const auto end = now + seconds(30); now < end && !again; now = link.next_due(now)) {
    again = find<CorridorPart>(next()) != nullptr;
  }
  EXPECT_TRUE(again) << "nobody acknowledged it";
}

TEST_F(ServerLinkTest, AnotherCommandEndsTheCorridorOfTheLast) {
  drain();
  link.command(command(1), {}, seconds(9), now);
  link.corridor(corridor_of(1));
  link.command(command(2), {}, seconds(9), now);
  for (const auto end = now + seconds(30); now < end; now = link.next_due(now)) {
    EXPECT_EQ(find<CorridorPart>(next()), nullptr);
  }
}

TEST_F(ServerLinkTest, ARequestForCorridorIsAnEventAndAcknowledgedSoon) {
  drain();
  CorridorRequest request;
  request.command = 4;
  const auto events = arrive(1, {request});
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(std::get<CorridorRequest>(events[0]), request);
  EXPECT_TRUE(arrive(1, {request}).empty());
  now += RobotLink::kAckDelay;
  EXPECT_NE(find<Ack>(next()), nullptr);
}

TEST_F(ServerLinkTest, ACommandIsSentUntilReportedOn) {
  drain();
  link.command(command(1), {}, seconds(9), now);
  int sent = 0;
  for (const auto end = now + seconds(60); now < end; now = link.next_due(now)) {
    if (find<Command>(next()) != nullptr) ++sent;
  }
  EXPECT_GE(sent, 5);
  EXPECT_LE(sent, 10);
  (void)arrive(1, {CommandReport{1, 0, CommandState::accepted, ""}});
  for (const auto end = now + seconds(60); now < end; now = link.next_due(now)) {
    EXPECT_EQ(find<Command>(next()), nullptr);
  }
}

TEST_F(ServerLinkTest, ValidityIsToldInTheRobotsClockAndDelayShortensIt) {
  drain();
  // The Hello was stamped 1 s and arrived at 50 s; whatever its delay, 60 s is at least 11 s.
  link.command(command(1), {}, seconds(10), now);
  EXPECT_EQ(find<Command>(next())->expires_clock_ms, 11'000U);
  now += seconds(4);
  (void)arrive(1, {pose(6'000)});  // A second later than the Hello's stamp lets expect.
  link.command(command(2), {}, seconds(10), now);
  EXPECT_EQ(find<Command>(next())->expires_clock_ms, 16'000U);
}

TEST_F(ServerLinkTest, ACommandThatIsLongOverIsNotValidBeforeTheClockBegan) {
  drain();
  link.command(command(1), {}, seconds(-30), now);
  EXPECT_EQ(find<Command>(next())->expires_clock_ms, 0U);
}

TEST_F(ServerLinkTest, RefusalsAreBoundedAndOnePerBlock) {
  drain();
  for (std::uint32_t n = 0; n < 3 * ServerLink::kMaxRefusals; ++n) link.refuse({n / 2, {}, n});
  std::size_t refusals = 0;
  for (const auto end = now + seconds(60); now < end; now = link.next_due(now)) {
    while (const auto frame = next()) refusals += frame->records.size();
  }
  EXPECT_EQ(refusals, ServerLink::kMaxRefusals);
}

TEST_F(ServerLinkTest, SilenceCountsFromTheLastFrame) {
  now += seconds(3);
  EXPECT_EQ(link.silence(now), seconds(3));
  (void)arrive(1, {pose(2'000)});
  EXPECT_EQ(link.silence(now), seconds(0));
}

TEST(Judge, AppliesWhatFitsDropsWhatIsThereRefusesWhatSkips) {
  EXPECT_EQ(judge(0, 0, 1), Verdict::apply);
  EXPECT_EQ(judge(3, 2, 5), Verdict::apply);
  EXPECT_EQ(judge(5, 2, 5), Verdict::stale);
  EXPECT_EQ(judge(6, 2, 5), Verdict::stale);
  EXPECT_EQ(judge(1, 2, 5), Verdict::refuse);
}

TEST_F(ServerLinkTest, NamesTheSubmapThatBorrowsASequence) {
  drain();
  const SubmapHead borrowed{kFirstBorrowedSequence, 1, {}, false, 0, 0, 0, {}, SubmapId{3, 12}};
  const auto events = arrive(1, {borrowed, head(4)});
  ASSERT_EQ(events.size(), 1U);
  const auto& evidence = std::get<ServerLink::Evidence>(events[0]);
  EXPECT_EQ(evidence.submap(77, kFirstBorrowedSequence), (SubmapId{3, 12}));
  EXPECT_EQ(evidence.submap(77, 4), (SubmapId{77, 4}));
}

TEST_F(ServerLinkTest, TakesNothingThatBorrowsASequenceNobodyNamed) {
  drain();
  BlockUpdate block{kFirstBorrowedSequence + 1, {}, 0, 1, {}};
  block.delta.changed.set(3);
  block.delta.cells[3] = {10, 200};
  const EvidencePatch patch{
      block.sequence, 0, {}, write_patch({&block, 1}, {block.sequence, 0}, {}, {}, 1000).bytes};
  EXPECT_TRUE(arrive(1, {patch}).empty());
  now += seconds(5);
  EXPECT_EQ(find<Ack>(next()), nullptr);
  SubmapHead named{block.sequence, 1, {}, false, 0, 0};
  named.earlier = SubmapId{3, 12};
  ASSERT_EQ(arrive(2, {named, patch}).size(), 1U);
  const auto events = arrive(3, {patch});
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(std::get<ServerLink::Evidence>(events[0]).submap(77, block.sequence),
            (SubmapId{3, 12}));
}

}  // namespace
}  // namespace cairn::proto
