#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/cairn_programs.h"

namespace cairn::test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

/// What operators asked for outlives a killed server.
class TasksOutliveTheServer : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(server_.wait_until_ready()) << server_.process().output();
    ASSERT_EQ(server_.cairn({"found", "lab"}).exit_code, 0);
    agent_ = std::make_unique<Process>(
        start_agent(folder_, "r1", {"--world", "room", "--site", "lab", "--speed", "4"}));
    ASSERT_TRUE(eventually([&] { return known_cells() > 500; }, 20s)) << agent_->output();
  }
  json robot() {
    const json status = server_.status();
    if (!status.is_object() || status["robots"].empty()) return json::object();
    return status["robots"][0];
  }
  json task() { return robot().value("task", json::object()); }
  std::uint64_t known_cells() {
    const json status = server_.status();
    return status.is_object() ? status["sites"][0].value("known_cells", std::uint64_t{0}) : 0;
  }
  void ask(const std::vector<std::string>& arguments) {
    const Finished asked = server_.cairn(arguments);
    ASSERT_EQ(asked.exit_code, 0) << asked.output;
  }
  /// kill -9, and another server on the same folder that has heard the robot.
  void kill_and_restart() {
    server_.process().kill();
    server_ = ServerProcess(folder_);
    ASSERT_TRUE(server_.wait_until_ready()) << server_.process().output();
    ASSERT_TRUE(eventually([&] { return !robot().empty(); }, 30s)) << agent_->output();
  }
  std::string logs() { return server_.process().output() + agent_->output(); }

  TempFolder folder_;
  ServerProcess server_{folder_};
  std::unique_ptr<Process> agent_;
};

TEST_F(TasksOutliveTheServer, ALoopGoesOnAndWhatWaitsWaits) {
  ask({"goto", "4,2.5", "2,2.5", "--loop", "--on-link-loss", "continue"});
  ask({"goto", "3", "2", "--queue"});
  const std::uint64_t id = task().value("id", std::uint64_t{0});
  ASSERT_GT(id, 0U);
  kill_and_restart();
  EXPECT_EQ(task().value("id", std::uint64_t{0}), id) << logs();
  EXPECT_EQ(task().value("state", ""), "active");
  EXPECT_EQ(task().value("waiting", 0), 1);
  const auto rounds = task().value("rounds", std::uint64_t{0});
  EXPECT_TRUE(eventually([&] { return task().value("rounds", std::uint64_t{0}) > rounds; }, 60s))
      << task() << logs();
}

TEST_F(TasksOutliveTheServer, AnExplorationGoesOnToItsEnd) {
  ask({"explore", "--on-link-loss", "continue"});
  const std::uint64_t id = task().value("id", std::uint64_t{0});
  kill_and_restart();
  EXPECT_EQ(task().value("id", std::uint64_t{0}), id) << logs();
  EXPECT_EQ(task().value("kind", ""), "explore");
  EXPECT_EQ(task().value("state", ""), "active");
  const std::uint64_t before = known_cells();
  EXPECT_TRUE(eventually([&] { return known_cells() > before + 1'000; }, 60s)) << logs();
}

TEST_F(TasksOutliveTheServer, AStoppedTaskStaysStopped) {
  ask({"goto", "10", "10", "--on-link-loss", "continue"});
  ask({"stop"});
  kill_and_restart();
  EXPECT_EQ(task().value("state", ""), "cancelled") << logs();
  ask({"goto", "3", "2.5"});
  EXPECT_EQ(task().value("id", 0), 2) << "no number is given twice";
}

}  // namespace
}  // namespace cairn::test
