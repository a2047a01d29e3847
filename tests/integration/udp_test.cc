#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/cairn_programs.h"
#include "tests/support/udp_link.h"

namespace cairn::test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

/// A server that listens on DDS and on UDP at once.
class OverUdp : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(server_.wait_until_ready()) << server_.process().output();
    ASSERT_EQ(server_.cairn({"found", "lab"}).exit_code, 0);
  }
  Process start(const std::string& robot, const std::string& log) {
    std::vector<std::string> argv = udp_.agent_arguments(robot);
    argv.insert(argv.begin(), {agent_program(), "--world", "room", "--site", "lab"});
    return Process(argv, folder_.path() / (log + ".log"));
  }
  Process start(const std::string& robot) { return start(robot, robot); }
  bool connected(const std::string& robot) {
    return eventually(
        [&] {
          const json status = server_.status();
          if (!status.is_object()) return false;
          for (const json& candidate : status["robots"]) {
            if (candidate["id"] == robot) return candidate["link"].value("connected", false);
          }
          return false;
        },
        20s);
  }

  TempFolder folder_;
  UdpLink udp_{folder_, {"r1", "r2"}};
  ServerProcess server_{folder_, udp_.server_arguments()};
};

TEST_F(OverUdp, ARobotArrivesWhereItIsSent) {
  Process agent = start("r1");
  ASSERT_TRUE(connected("r1")) << agent.output();
  ASSERT_TRUE(eventually(
      [&] { return server_.status()["sites"][0].value("known_cells", 0U) > 500U; }, 20s));
  const Finished drive = server_.cairn({"goto", "2", "2.5", "--follow"}, 60s);
  EXPECT_EQ(drive.exit_code, 0) << drive.output << agent.output();
  EXPECT_NE(drive.output.find("arrived"), std::string::npos) << drive.output;
}

TEST_F(OverUdp, RobotsOnBothCarriersMapTheSameSite) {
  Process over_udp = start("r1");
  Process over_dds = start_agent(folder_, "r3", {"--world", "room", "--site", "lab"});
  EXPECT_TRUE(connected("r1")) << over_udp.output();
  EXPECT_TRUE(connected("r3")) << over_dds.output();
}

TEST_F(OverUdp, AServerThatComesBackFindsItsRobotAgain) {
  Process agent = start("r1");
  ASSERT_TRUE(connected("r1")) << agent.output();
  server_.process().kill();
  server_ = ServerProcess(folder_, udp_.server_arguments());
  ASSERT_TRUE(server_.wait_until_ready()) << server_.process().output();
  EXPECT_TRUE(connected("r1")) << agent.output();
}

TEST_F(OverUdp, AnAgentThatComesBackIsTakenAgain) {
  Process agent = start("r1");
  ASSERT_TRUE(connected("r1")) << agent.output();
  agent.kill();
  agent = start("r1");
  EXPECT_TRUE(agent.wait_for_output("connected to the server", 30s)) << agent.output();
}

TEST_F(OverUdp, ARobotCannotTakeAnothersName) {
  std::ifstream genuine(folder_.path() / "r1.key");
  std::string robot;
  std::string key;
  genuine >> robot >> key;
  std::ofstream(folder_.path() / "r2.key") << "r2 " << key << '\n';
  Process thief = start("r2");
  EXPECT_EQ(thief.wait(20s), 1) << thief.output();
  EXPECT_NE(thief.output().find("--robot r1"), std::string::npos) << thief.output();
}

TEST_F(OverUdp, ASecondAgentWithTheSameIdIsTurnedAway) {
  Process first = start("r1");
  ASSERT_TRUE(connected("r1")) << first.output();
  Process second = start("r1", "second");
  EXPECT_EQ(second.wait(60s), 1) << second.output();
  EXPECT_NE(second.output().find("in use"), std::string::npos) << second.output();
  EXPECT_TRUE(connected("r1")) << "the first one goes on";
}

TEST_F(OverUdp, AWrongKeyNeverConnects) {
  const std::string line = run({server_program(), "--new-key", "r1"}).output;
  std::ofstream(folder_.path() / "r1.key") << line;
  Process stranger = start("r1");
  EXPECT_FALSE(stranger.wait_for_output("connected to the server", 3s)) << stranger.output();
  EXPECT_TRUE(server_.status()["robots"].empty());
}

TEST(UdpKeys, AreAskedForWhereTheyAreNeeded) {
  const TempFolder folder;
  const Finished server =
      run({server_program(), "--data", folder.path().string(), "--listen", "udp://127.0.0.1:0"});
  EXPECT_EQ(server.exit_code, 1);
  EXPECT_NE(server.output.find("--keys"), std::string::npos) << server.output;
  const Finished agent = run({agent_program(), "--world", "room", "--server", "udp://127.0.0.1"});
  EXPECT_EQ(agent.exit_code, 1);
  EXPECT_NE(agent.output.find("--key"), std::string::npos) << agent.output;
}

}  // namespace
}  // namespace cairn::test
