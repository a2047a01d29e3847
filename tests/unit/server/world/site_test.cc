#include "server/world/site.h"

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>

#include "tests/unit/server/world/world_fixture.h"

namespace cairn::server {
namespace {

using std::chrono::milliseconds;

/// A site whose strand runs when the test lets it.
class SiteTest : public WorldTest {
 protected:
  boost::asio::io_context context;
  std::shared_ptr<Site> site = std::make_shared<Site>(context.get_executor(), std::move(world));
  std::vector<Site::Outcome> outcomes;

  void submit(const Evidence& evidence) {
    site->submit("rover-1", 1, evidence,
                 [this](Site::Outcome outcome) { outcomes.push_back(std::move(outcome)); });
  }
  /// Runs the strand until `done`, or for so long that it will not be done any more.
  template <class Done>
  bool run_until(Done done) {
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!done() && std::chrono::steady_clock::now() < patience)
      context.run_one_for(milliseconds(50));
    return done();
  }
  void flush() {
    bool flushed = false;
    site->flush([&flushed] { flushed = true; });
    EXPECT_TRUE(run_until([&flushed] { return flushed; }));
  }
};

TEST_F(SiteTest, AcknowledgesEvidenceOnceItIsDurable) {
  Surveyor robot;
  robot.survey({0, 0}, 0);
  const std::vector<Evidence> frames = robot.frames();
  for (const Evidence& evidence : frames) submit(evidence);
  ASSERT_TRUE(run_until([&] { return outcomes.size() == frames.size(); }));
  for (const Site::Outcome& outcome : outcomes) EXPECT_TRUE(outcome.durable);
  EXPECT_EQ(disk->commits, 1);  // All that came together went in one transaction.
}

TEST_F(SiteTest, PublishesWhatItCommitted) {
  Surveyor robot;
  robot.survey({0, 0}, 0);
  for (const Evidence& evidence : robot.frames()) submit(evidence);
  EXPECT_TRUE(run_until([&] { return !site->snapshot()->tiles.empty(); }));
  EXPECT_TRUE(shows(*site->snapshot(), fold_of(robot.closed)));
}

TEST_F(SiteTest, AcknowledgesNothingWhileTheDiskRefuses) {
  disk->failing = {1};
  Surveyor robot;
  robot.survey({0, 0}, 0);
  const std::vector<Evidence> frames = robot.frames();
  for (const Evidence& evidence : frames) submit(evidence);
  ASSERT_TRUE(run_until([&] { return disk->commits == 1; }));
  EXPECT_TRUE(outcomes.empty());
  ASSERT_TRUE(run_until([&] { return outcomes.size() == frames.size(); }));  // The retry.
  EXPECT_EQ(disk->commits, 2);
  EXPECT_TRUE(outcomes.front().durable);
}

TEST_F(SiteTest, TellsWhatItRefused) {
  Surveyor robot;
  robot.begin();
  robot.see({0, 0}, 4, {0, 200});
  Evidence evidence = robot.frames().front();
  evidence.blocks.front().base = 3;
  evidence.blocks.front().version = 4;
  submit(evidence);
  ASSERT_TRUE(run_until([&] { return !outcomes.empty(); }));
  EXPECT_EQ(outcomes.front().refusals.size(), 1U);
}

TEST_F(SiteTest, WritesAndShowsEverythingInAnOrderlyEnd) {
  Surveyor robot;
  robot.survey({0, 0}, 0);
  for (const Evidence& evidence : robot.frames()) submit(evidence);
  flush();
  EXPECT_TRUE(shows(*site->snapshot(), fold_of(robot.closed)));
  site.reset();
  context.run_for(milliseconds(1));  // The cancelled timers let go of it.
  EXPECT_EQ(reopen()->submaps().value().size(), 1U);
}

TEST_F(SiteTest, DescribesItself) {
  Surveyor robot;
  robot.survey({0, 0}, 0);
  for (const Evidence& evidence : robot.frames()) submit(evidence);
  flush();
  std::optional<api::SiteJson> told;
  site->describe([&told](const api::SiteJson& json) { told = json; });
  ASSERT_TRUE(run_until([&] { return told.has_value(); }));
  EXPECT_EQ(told->name, "quarry");
  EXPECT_EQ(told->submaps_merged, 1U);
  EXPECT_EQ(told->known_cells, 1600U);
}

}  // namespace
}  // namespace cairn::server
