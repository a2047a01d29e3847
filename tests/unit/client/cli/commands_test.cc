#include "client/cli/commands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "server/api/api_server.h"
#include "tests/unit/server/api/fake_service.h"

namespace cairn::cli {
namespace {

using testing::HasSubstr;

class CommandsTest : public testing::Test {
 protected:
  CommandsTest() : server_(server::ApiServer::start(io_, {"127.0.0.1", 0}, service_).value()) {
    api::RobotJson robot;
    robot.id = "r1";
    robot.site = "yard";
    robot.drive = "driving";
    robot.localization = "localized";
    robot.command = api::CommandJson{7, "goto", "arrived", "", {1, 2}, 0, 1, {}};
    service_.status_reply.robots = {robot};
    thread_ = std::thread([this] { io_.run(); });
  }
  ~CommandsTest() override {
    server_.reset();
    work_.reset();
    thread_.join();
  }

  int cairn(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(),
                     {"--server", "127.0.0.1:" + std::to_string(server_->port())});
    const auto parsed = parse_arguments(arguments);
    out_.str("");
    err_.str("");
    return run(std::get<Invocation>(parsed), {out_, err_, false});
  }

  server::FakeService service_;
  boost::asio::io_context io_;
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{
      io_.get_executor()};
  std::unique_ptr<server::ApiServer> server_;
  std::thread thread_;
  std::ostringstream out_;
  std::ostringstream err_;
};

TEST_F(CommandsTest, StatusIsATableOrJson) {
  EXPECT_EQ(cairn({"status"}), kExitOk);
  EXPECT_THAT(out_.str(), HasSubstr("r1"));
  EXPECT_EQ(cairn({"status", "--json"}), kExitOk);
  EXPECT_EQ(nlohmann::json::parse(out_.str())["robots"][0]["id"], "r1");
}

TEST_F(CommandsTest, GotoReturnsOnceTheCommandIsSentOrFollowsToArrival) {
  EXPECT_EQ(cairn({"goto", "-1", "2"}), kExitOk);
  EXPECT_THAT(out_.str(), HasSubstr("goal sent to r1 (command 7): 5.0 m of way"));
  EXPECT_EQ(cairn({"goto", "-1", "2", "--follow"}), kExitOk);
  EXPECT_THAT(out_.str(), HasSubstr("r1 arrived"));
}

TEST_F(CommandsTest, TasksAreSentAndFollowedToTheirEnd) {
  EXPECT_EQ(cairn({"explore", "--area", "0,0,5,5"}), kExitOk);
  EXPECT_THAT(out_.str(), HasSubstr("task to explore sent to r1 (command 9)"));
  EXPECT_EQ(service_.last_explore->area->east_m, 5.0);
  EXPECT_EQ(cairn({"goto", "1,2", "3,4", "--loop"}), kExitOk);
  EXPECT_EQ(service_.last_goto->then[0].y_m, 4.0);

  auto& task = service_.status_reply.robots[0].task.emplace();
  task.id = 2;
  task.kind = "explore";
  task.state = "done";
  task.legs = 5;
  EXPECT_EQ(cairn({"explore", "--follow"}), kExitOk) << err_.str();
  EXPECT_THAT(out_.str(), HasSubstr("r1 explore done, 5 places"));
  task.state = "failed";
  task.why = "stuck";
  EXPECT_EQ(cairn({"explore", "--follow"}), kExitFailed);
  EXPECT_EQ(err_.str(), "cairn: r1 explore failed, 5 places: stuck\n");
  task.id = 4;
  EXPECT_EQ(cairn({"return", "--follow"}), kExitFailed);
  EXPECT_THAT(err_.str(), HasSubstr("does task 4"));
}

TEST_F(CommandsTest, FollowFailsWhenTheRobotRefuses) {
  service_.status_reply.robots[0].command->state = "refused";
  service_.status_reply.robots[0].command->why = "lost";
  EXPECT_EQ(cairn({"goto", "-1", "2", "--follow"}), kExitFailed);
  EXPECT_EQ(err_.str(), "cairn: refused: lost\n");
}

TEST_F(CommandsTest, AFailureIsOneLine) {
  EXPECT_EQ(cairn({"stop", "--robot", "ghost"}), kExitFailed);
  EXPECT_EQ(err_.str(), "cairn: no robot ghost: see `cairn status`\n");
}

TEST_F(CommandsTest, FoundPlanAndLinkAnswer) {
  EXPECT_EQ(cairn({"found", "yard"}), kExitOk);
  EXPECT_EQ(cairn({"plan", "--from", "-1,2", "--to", "3,4"}), kExitOk);
  EXPECT_THAT(out_.str(), HasSubstr("(-1.00, 2.00)"));
  EXPECT_EQ(cairn({"link"}), kExitOk);
  EXPECT_THAT(out_.str(), HasSubstr("ROUND TRIP"));
}

TEST_F(CommandsTest, MapWritesAPicture) {
  service_.tiles = {{{0, 0, 0}, server::full_tile(1)}, {{0, -1, 0}, server::full_tile(2)}};
  const std::string file = testing::TempDir() + "cairn_commands_test.png";
  EXPECT_EQ(cairn({"map", "--png", file}), kExitOk) << err_.str();
  EXPECT_GT(std::filesystem::file_size(file), 1000U);
}

TEST_F(CommandsTest, SaysWhatToDoWhenThereIsNoServer) {
  const auto port = server_->port();
  server_->stop();
  std::string error;
  for (int i = 0; i < 200 && error.find("no server at") == std::string::npos; ++i) {
    EXPECT_EQ(cairn({"status"}), kExitFailed);
    error = err_.str();
  }
  EXPECT_EQ(error, "cairn: no server at 127.0.0.1:" + std::to_string(port) +
                       ": start cairn-server or give --server HOST:PORT\n");
}

}  // namespace
}  // namespace cairn::cli
