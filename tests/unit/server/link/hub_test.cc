#include "server/link/hub.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <condition_variable>
#include <deque>
#include <mutex>

#include "proto/sync/robot_link.h"
#include "tests/unit/server/store/store_fixture.h"

namespace cairn::server {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

/// The air between the test and the hub.
struct Air {
  std::mutex mutex;
  std::condition_variable arrived;
  std::deque<proto::Datagram> up;
  std::deque<proto::Datagram> down;
  std::atomic<bool> proves_peers{false};
};

class AirCarrier : public proto::Carrier {
 public:
  explicit AirCarrier(std::shared_ptr<Air> air) : air_(std::move(air)) {}

  Status send(const proto::Datagram& frame) override {
    const std::lock_guard lock(air_->mutex);
    air_->down.push_back(frame);
    return {};
  }
  Result<std::optional<proto::Datagram>> receive(milliseconds timeout) override {
    std::unique_lock lock(air_->mutex);
    if (!air_->arrived.wait_for(lock, timeout, [this] { return !air_->up.empty(); })) {
      return std::optional<proto::Datagram>();
    }
    std::optional<proto::Datagram> first = std::move(air_->up.front());
    air_->up.pop_front();
    return first;
  }
  [[nodiscard]] std::size_t overhead_bytes() const override { return 28; }
  [[nodiscard]] std::optional<std::string> proven_robot(const std::string& peer) const override {
    return air_->proves_peers ? std::optional(peer) : std::nullopt;
  }

 private:
  std::shared_ptr<Air> air_;
};

/// A hub with one site, "quarry", and the test as its robots.
class HubTest : public StoreTest {
 protected:
  boost::asio::io_context context;
  std::shared_ptr<Air> air = std::make_shared<Air>();
  std::shared_ptr<Site> site;
  std::vector<proto::CommandReport> reports;
  std::vector<proto::CorridorRequest> requests;
  int connections = 0;
  std::shared_ptr<Hub> hub;

  HubTest() {
    auto world = World::open(found(), SensorModel{});
    EXPECT_TRUE(world);
    site = std::make_shared<Site>(context.get_executor(), std::move(world).value());
    std::vector<std::unique_ptr<proto::Carrier>> carriers;
    carriers.push_back(std::make_unique<AirCarrier>(air));
    hub = std::make_shared<Hub>(
        boost::asio::make_strand(boost::asio::any_io_executor(context.get_executor())),
        std::move(carriers),
        Hub::Listener{
            .connected = [this](Robot&) { ++connections; },
            .reported = [this](Robot&, const auto& report) { reports.push_back(report); },
            .asked = [this](Robot&, const auto& request) { requests.push_back(request); },
            .site_named =
                [this](const std::string& name) { return name == "quarry" ? site : nullptr; }});
    hub->start();
  }
  ~HubTest() override {
    hub->stop();
    context.run_for(milliseconds(20));  // The cancelled timers let go.
  }

  void say(const std::string& peer, const proto::Record& record, std::uint32_t session = 0,
           std::uint32_t number = 1) {
    proto::FrameWriter frame(
        {.direction = proto::Direction::up, .session = session, .number = number});
    frame.add(record);
    send(peer, std::move(frame).finish());
  }
  void send(const std::string& peer, std::vector<std::uint8_t> bytes) {
    const std::lock_guard lock(air->mutex);
    air->up.push_back({peer, std::move(bytes)});
    air->arrived.notify_one();
  }
  /// The next record of that kind from the hub; nullopt when none comes in good time.
  template <class R>
  std::optional<R> hear(const std::string& peer) {
    for (int tries = 0; tries < 400; ++tries) {
      if (const auto datagram = next_down()) {
        EXPECT_EQ(datagram->peer, peer);
        const auto frame = proto::decode_frame(datagram->bytes, proto::Direction::down);
        EXPECT_TRUE(frame);
        for (const proto::Record& record : frame->records) {
          if (const auto* found = std::get_if<R>(&record)) return *found;
        }
        continue;
      }
      context.run_one_for(milliseconds(10));
    }
    return std::nullopt;
  }
  template <class Done>
  bool run_until(Done done) {
    for (int tries = 0; tries < 400 && !done(); ++tries) context.run_one_for(milliseconds(10));
    return done();
  }
  [[nodiscard]] static proto::Hello hello(std::uint64_t boot = 7) {
    return {.robot = "rover-1", .site = "quarry", .boot = boot, .cell_size_mm = 125, .clock_ms = 1};
  }

 private:
  std::optional<proto::Datagram> next_down() {
    const std::lock_guard lock(air->mutex);
    if (air->down.empty()) return std::nullopt;
    proto::Datagram first = std::move(air->down.front());
    air->down.pop_front();
    return first;
  }
};

TEST_F(HubTest, WelcomesARobotWithItsBootAndTheSitesEpoch) {
  say("a", hello());
  const auto welcome = hear<proto::Welcome>("a");
  ASSERT_TRUE(welcome);
  EXPECT_NE(welcome->session, 0U);
  EXPECT_EQ(welcome->boot, 7U);
  EXPECT_EQ(welcome->epoch, sample_site().epoch);
  EXPECT_EQ(connections, 1);
}

TEST_F(HubTest, TeachesHowToFoundASiteItDoesNotHave) {
  proto::Hello lost = hello();
  lost.site = "moon";
  say("a", lost);
  const auto reject = hear<proto::Reject>("a");
  ASSERT_TRUE(reject);
  EXPECT_EQ(reject->reason, proto::RejectReason::unknown_site);
  EXPECT_EQ(reject->boot, 7U);
  EXPECT_THAT(reject->text, HasSubstr("cairn found moon"));
}

TEST_F(HubTest, TeachesWhichCellSizeTheSiteHas) {
  proto::Hello coarse = hello();
  coarse.cell_size_mm = 250;
  say("a", coarse);
  const auto reject = hear<proto::Reject>("a");
  ASSERT_TRUE(reject);
  EXPECT_EQ(reject->reason, proto::RejectReason::cell_size_differs);
  EXPECT_THAT(reject->text, HasSubstr("--cell-mm 125"));
}

TEST_F(HubTest, RefusesASecondAgentUnderARunningOnesName) {
  say("a", hello(7));
  const auto welcome = hear<proto::Welcome>("a");
  ASSERT_TRUE(welcome);
  proto::PoseReport pose;
  pose.asks = true;
  say("a", pose, welcome->session);
  ASSERT_TRUE(hear<proto::Ack>("a"));
  say("b", hello(8));
  const auto reject = hear<proto::Reject>("b");
  ASSERT_TRUE(reject);
  EXPECT_EQ(reject->reason, proto::RejectReason::robot_id_in_use);
  EXPECT_EQ(reject->boot, 8U);
}

TEST_F(HubTest, TakesOnlyTheProvenNameOverACarrierThatProvesNames) {
  air->proves_peers = true;
  say("rover-2", hello());
  const auto reject = hear<proto::Reject>("rover-2");
  ASSERT_TRUE(reject);
  EXPECT_EQ(reject->reason, proto::RejectReason::bad_name);
  EXPECT_THAT(reject->text, HasSubstr("--robot rover-2"));
  say("rover-1", hello());
  EXPECT_TRUE(hear<proto::Welcome>("rover-1"));
}

TEST_F(HubTest, ASessionInWhichNothingWasSaidDoesNotKeepTheRobotsName) {
  say("a", hello(7));
  ASSERT_TRUE(hear<proto::Welcome>("a"));
  say("a", hello(8));
  const auto welcome = hear<proto::Welcome>("a");
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->boot, 8U);
}

TEST_F(HubTest, LetsARobotReturnFromAnotherAddress) {
  say("a", hello());
  const auto first = hear<proto::Welcome>("a");
  ASSERT_TRUE(first);
  say("b", hello());
  const auto second = hear<proto::Welcome>("b");
  ASSERT_TRUE(second);
  EXPECT_NE(first->session, second->session);
}

TEST_F(HubTest, RepeatsItsWelcomeForARepeatedHello) {
  say("a", hello());
  const auto first = hear<proto::Welcome>("a");
  say("a", hello());
  const auto second = hear<proto::Welcome>("a");
  ASSERT_TRUE(first && second);
  EXPECT_EQ(*first, *second);
  EXPECT_EQ(connections, 1);
}

TEST_F(HubTest, SendsARobotOfAnUnknownSessionToSayHello) {
  say("a", proto::Bye{}, 12345);
  EXPECT_TRUE(hear<proto::Reset>("a"));
}

TEST_F(HubTest, DoesNotTakeASessionsFramesFromAnotherAddress) {
  say("a", hello());
  const auto welcome = hear<proto::Welcome>("a");
  ASSERT_TRUE(welcome);
  say("b", proto::CommandReport{3, 1, proto::CommandState::arrived, ""}, welcome->session);
  EXPECT_TRUE(hear<proto::Reset>("b"));
  EXPECT_TRUE(reports.empty());
}

TEST_F(HubTest, PassesOnWhatARobotReports) {
  say("a", hello());
  const auto welcome = hear<proto::Welcome>("a");
  ASSERT_TRUE(welcome);
  say("a", proto::CommandReport{3, 1, proto::CommandState::arrived, ""}, welcome->session);
  ASSERT_TRUE(run_until([this] { return !reports.empty(); }));
  EXPECT_EQ(reports.front().command, 3U);
}

TEST_F(HubTest, ShowsWhatARobotKeepsOnItsDisk) {
  say("a", hello());
  const auto welcome = hear<proto::Welcome>("a");
  ASSERT_TRUE(welcome);
  say("a", proto::SpoolReport{true, 12, 3'456'789, 5, 2}, welcome->session);
  ASSERT_TRUE(run_until([this] { return hub->find("rover-1")->spool.has_value(); }));
  const auto spool = describe(*hub->find("rover-1"), Hub::now()).link.spool;
  ASSERT_TRUE(spool);
  EXPECT_EQ(spool->state, "failed");
  EXPECT_EQ(spool->submaps, 12U);
  EXPECT_EQ(spool->dropped, 2U);
}

TEST_F(HubTest, CountsWhatIsNoFrame) {
  air->proves_peers = true;
  say("rover-1", hello());
  ASSERT_TRUE(hear<proto::Welcome>("rover-1"));
  send("rover-1", {1, 2, 3});
  EXPECT_TRUE(run_until([this] { return hub->find("rover-1")->frames_malformed == 1; }));
}

TEST_F(HubTest, SendsACommandUntilTheRobotReportsOnIt) {
  say("a", hello());
  const auto welcome = hear<proto::Welcome>("a");
  ASSERT_TRUE(welcome);
  proto::Command stop;
  stop.id = 9;
  stop.revision = 1;
  hub->command(*hub->find("rover-1"), stop, {}, std::chrono::minutes(1));
  const auto first = hear<proto::Command>("a");
  ASSERT_TRUE(first);
  EXPECT_EQ(first->id, 9U);
  EXPECT_TRUE(hear<proto::Command>("a"));  // Nobody answered: again.
}

/// A real robot's end of the link: what it says is in the store when it is told so.
TEST_F(HubTest, AcknowledgesEvidenceThatIsInTheStore) {
  proto::RobotLink robot({.robot = "rover-1", .site = "quarry", .boot = 7}, 28);
  robot.evidence().begin(7, {}, 125).surface.set({3, 5}, {40, 200});
  robot.evidence().touch(EvidenceLayer::surface, {{3, 5}});
  robot.evidence().close();
  const auto exchange = [&] {
    while (auto bytes = robot.next_frame(Hub::now())) send("a", std::move(*bytes));
    std::deque<proto::Datagram> down;
    {
      const std::lock_guard lock(air->mutex);
      down.swap(air->down);
    }
    for (const proto::Datagram& each : down) (void)robot.on_frame(each.bytes, Hub::now());
    return robot.connected() && robot.evidence().synchronised();
  };
  ASSERT_TRUE(run_until(exchange));
  ASSERT_TRUE(run_until([this] { return site->snapshot()->tiles.size() == 1; }));
  EXPECT_EQ(site->snapshot()->known_cells, 1U);
}

}  // namespace
}  // namespace cairn::server
