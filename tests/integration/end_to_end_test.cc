#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/cairn_programs.h"

namespace cairn::test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

class EndToEnd : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(server_.wait_until_ready()) << server_.process().output();
    ASSERT_EQ(server_.cairn({"found", "lab"}).exit_code, 0);
  }
  bool connected(const std::string& robot) {
    return eventually([&] { return robot_json(robot).value("connected", false); }, 20s);
  }
  void send(const std::string& x, const std::string& y) {
    const Finished sent = server_.cairn({"goto", x, y});
    ASSERT_EQ(sent.exit_code, 0) << sent.output;
  }
  json robot_json(const std::string& robot) {
    const json status = server_.status();
    if (!status.is_object()) return json::object();
    for (const json& candidate : status["robots"]) {
      if (candidate["id"] == robot) return candidate["link"];
    }
    return json::object();
  }
  std::uint64_t known_cells() {
    const json status = server_.status();
    return status.is_object() ? status["sites"][0].value("known_cells", std::uint64_t{0}) : 0;
  }

  TempFolder folder_;
  ServerProcess server_{folder_};
};

TEST_F(EndToEnd, ARobotArrivesWhereItIsSentAndTheMapOutlivesACrash) {
  Process agent = start_agent(folder_, "r1", {"--world", "room", "--site", "lab", "--speed", "4"});
  ASSERT_TRUE(connected("r1")) << agent.output();
  ASSERT_TRUE(eventually([&] { return known_cells() > 500; }, 20s));

  const Finished drive = server_.cairn({"goto", "5", "2.5", "--follow"}, 60s);
  EXPECT_EQ(drive.exit_code, 0) << drive.output << agent.output();
  EXPECT_NE(drive.output.find("arrived"), std::string::npos) << drive.output;
  ASSERT_TRUE(agent.wait_for_output("truth:", 5s)) << agent.output();
  EXPECT_NE(agent.output().find(" 0 collisions"), std::string::npos) << agent.output();
  const json robot = server_.status()["robots"][0];
  EXPECT_LT(std::hypot(robot["x_m"].get<double>() - 5.0, robot["y_m"].get<double>() - 2.5), 0.125);

  const std::string picture = (folder_.path() / "map.png").string();
  EXPECT_EQ(server_.cairn({"map", "--png", picture}).exit_code, 0);
  EXPECT_GT(std::filesystem::file_size(picture), 5'000U);

  agent.signal(SIGTERM);
  EXPECT_EQ(agent.wait(5s), 0);
  // The snapshot follows the map at its own pace: it has come when it stays for longer than that.
  std::uint64_t before = 0;
  int same = 0;
  ASSERT_TRUE(eventually(
      [&] {
        const std::uint64_t now = known_cells();
        same = std::exchange(before, now) == now ? same + 1 : 0;
        return same == 10;
      },
      10s));
  server_.process().kill();
  server_ = ServerProcess(folder_);
  ASSERT_TRUE(server_.wait_until_ready()) << server_.process().output();
  EXPECT_EQ(known_cells(), before);
}

TEST_F(EndToEnd, ARobotExploresAnAreaGoesRoundAndReturns) {
  Process agent = start_agent(folder_, "r1", {"--world", "room", "--site", "lab", "--speed", "6"});
  ASSERT_TRUE(connected("r1")) << agent.output();
  ASSERT_TRUE(eventually([&] { return known_cells() > 500; }, 20s));
  const std::uint64_t before = known_cells();

  const Finished explored = server_.cairn({"explore", "r1", "--area", "1,1,5,4", "--follow"}, 90s);
  EXPECT_EQ(explored.exit_code, 0) << explored.output << agent.output();
  EXPECT_NE(explored.output.find("left to explore"), std::string::npos) << explored.output;
  EXPECT_GT(known_cells(), before + 300);
  EXPECT_NE(server_.cairn({"explore", "--area", "2,2,3,3"}).exit_code, 0) << "it is known";

  const Finished round = server_.cairn({"goto", "r1", "3.5,2.5", "2.5,3", "--follow"}, 60s);
  EXPECT_EQ(round.exit_code, 0) << round.output << agent.output();
  EXPECT_NE(round.output.find("goto done, 2 of 2 places"), std::string::npos) << round.output;

  ASSERT_EQ(server_.cairn({"goto", "3.5,2.5", "3,2"}).exit_code, 0);
  const Finished queued = server_.cairn({"return", "--queue", "--follow"}, 60s);
  EXPECT_EQ(queued.exit_code, 0) << queued.output << agent.output();
  EXPECT_NE(queued.output.find("queued"), std::string::npos) << queued.output;
  const json robot = server_.status()["robots"][0];
  EXPECT_LT(std::hypot(robot["x_m"].get<double>() - 2.5, robot["y_m"].get<double>() - 2.5), 0.2);
  EXPECT_EQ(robot["task"]["kind"], "return");
}

TEST_F(EndToEnd, AStopReachesADrivingRobot) {
  Process agent = start_agent(folder_, "r1", {"--world", "room", "--site", "lab"});
  ASSERT_TRUE(connected("r1")) << agent.output();
  ASSERT_TRUE(eventually([&] { return known_cells() > 500; }, 20s));
  send("6", "2.5");
  ASSERT_TRUE(eventually([&] { return server_.status()["robots"][0]["drive"] == "driving"; }, 10s));
  EXPECT_EQ(server_.cairn({"stop"}).exit_code, 0);
  EXPECT_TRUE(eventually(
      [&] {
        const json robot = server_.status()["robots"][0];
        return robot["drive"] == "stopped" && robot["speed_m_s"].get<double>() == 0.0;
      },
      10s));
}

TEST_F(EndToEnd, ARobotThatHearsNothingAnyMoreStopsByItself) {
  Process agent = start_agent(folder_, "r1", {"--world", "room", "--site", "lab"});
  ASSERT_TRUE(connected("r1")) << agent.output();
  ASSERT_TRUE(eventually([&] { return known_cells() > 500; }, 20s));
  send("8", "2.5");
  ASSERT_TRUE(eventually([&] { return server_.status()["robots"][0]["drive"] == "driving"; }, 10s));
  server_.process().kill();
  EXPECT_TRUE(agent.wait_for_output("the link was silent", 15s)) << agent.output();
}

TEST_F(EndToEnd, ASecondAgentWithTheSameIdIsTurnedAway) {
  Process first = start_agent(folder_, "twin", {"--world", "room", "--site", "lab"});
  ASSERT_TRUE(connected("twin")) << first.output();
  Process second({agent_program(), "--server", ServerProcess::dds_url(), "--robot", "twin",
                  "--world", "room", "--site", "lab"},
                 folder_.path() / "second.log");
  EXPECT_EQ(second.wait(60s), 1) << second.output();
  EXPECT_NE(second.output().find("in use"), std::string::npos) << second.output();
  EXPECT_TRUE(robot_json("twin").value("connected", false)) << "the first one goes on";
}

TEST_F(EndToEnd, AServerThatComesBackFindsItsRobotAgain) {
  Process agent = start_agent(folder_, "r1", {"--world", "room", "--site", "lab"});
  ASSERT_TRUE(connected("r1")) << agent.output();
  server_.process().kill();
  server_ = ServerProcess(folder_);
  ASSERT_TRUE(server_.wait_until_ready()) << server_.process().output();
  EXPECT_TRUE(connected("r1")) << agent.output();
}

}  // namespace
}  // namespace cairn::test
