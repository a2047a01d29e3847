#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/support/cairn_programs.h"

namespace cairn::test {
namespace {

using namespace std::chrono_literals;

/// It ended with this exit code and said one of its lines with this text.
void expect_refusal(const Finished& finished, int exit_code, const std::string& text) {
  EXPECT_EQ(finished.exit_code, exit_code) << finished.output;
  EXPECT_NE(finished.output.find(text), std::string::npos) << finished.output;
}

std::string written(const TempFolder& folder, const std::string& name, const std::string& text) {
  const std::filesystem::path file = folder.path() / name;
  std::ofstream(file) << text;
  return file.string();
}

class BadServerInput : public ::testing::Test {
 protected:
  Finished server(std::vector<std::string> more) {
    more.insert(more.begin(), server_program());
    return run(more, 20s);
  }
  TempFolder folder_;
  std::string data_ = site_folder(folder_).string();
  std::string listen_ = ServerProcess::dds_url();
};

TEST_F(BadServerInput, AnUnknownConfigKeyIsNamed) {
  const std::string config = written(folder_, "server.toml", "data = \"x\"\nfavourite = 3\n");
  expect_refusal(server({"--config", config}), 2, "favourite");
}

TEST_F(BadServerInput, AnUnknownFlagIsNamed) {
  expect_refusal(server({"--data", data_, "--frobnicate"}), 2, "frobnicate");
}

TEST_F(BadServerInput, ADataFolderThatCannotBeMadeIsNamed) {
  const std::string file = written(folder_, "plain", "not a folder");
  expect_refusal(server({"--data", file + "/sites", "--listen", listen_}), 1, "--data");
}

TEST_F(BadServerInput, AnApiPortInUseIsNamed) {
  ServerProcess first(folder_);
  ASSERT_TRUE(first.wait_until_ready()) << first.process().output();
  const std::string port = first.address().substr(first.address().find(':') + 1);
  const TempFolder other;
  const unsigned next_domain = own_dds_domain() + 100;
  expect_refusal(
      server({"--data", site_folder(other).string(), "--listen",
              "dds://127.0.0.1?domain=" + std::to_string(next_domain), "--api-port", port}),
      1, port);
}

TEST_F(BadServerInput, ASecondServerOnTheSameDomainIsRefused) {
  ServerProcess first(folder_);
  ASSERT_TRUE(first.wait_until_ready()) << first.process().output();
  const TempFolder other;
  expect_refusal(
      server({"--data", site_folder(other).string(), "--listen", listen_, "--api-port", "0"}), 1,
      "domain");
}

TEST_F(BadServerInput, ADataFolderHeldByAnotherServerIsRefused) {
  ServerProcess first(folder_);
  ASSERT_TRUE(first.wait_until_ready()) << first.process().output();
  ASSERT_EQ(first.cairn({"found", "lab"}).exit_code, 0);
  const unsigned next_domain = own_dds_domain() + 100;
  expect_refusal(
      server({"--data", data_, "--listen", "dds://127.0.0.1?domain=" + std::to_string(next_domain),
              "--api-port", "0"}),
      1, "another");
}

TEST_F(BadServerInput, AFileThatIsNoSiteIsNamedAndLeftAlone) {
  std::filesystem::create_directories(data_);
  const std::string text(5000, 'x');
  std::ofstream(data_ + "/odd.cairn") << text;
  expect_refusal(server({"--data", data_, "--listen", listen_, "--api-port", "0"}), 1, "odd.cairn");
  EXPECT_EQ(std::filesystem::file_size(data_ + "/odd.cairn"), text.size());
}

TEST_F(BadServerInput, AStrangeListenAddressTeachesTheForm) {
  expect_refusal(server({"--data", data_, "--listen", "tcp://here"}), 1, "dds://HOST");
}

class BadAgentInput : public ::testing::Test {
 protected:
  Finished agent(std::vector<std::string> more) {
    more.insert(more.begin(), {agent_program(), "--server", ServerProcess::dds_url()});
    return run(more, 30s);
  }
  TempFolder folder_;
};

TEST_F(BadAgentInput, AnUnknownWorldListsTheKnownOnes) {
  expect_refusal(agent({"--world", "atlantis"}), 1, "room");
}

TEST_F(BadAgentInput, AMissingLogIsNamed) {
  expect_refusal(agent({"--replay", "/nowhere/to/be/found.log"}), 1, "/nowhere/to/be/found.log");
}

TEST_F(BadAgentInput, WithoutAnInputItSaysWhatItNeeds) { expect_refusal(agent({}), 2, "--world"); }

TEST_F(BadAgentInput, BadNamesAreExplained) {
  expect_refusal(agent({"--world", "room", "--robot", "Robot One"}), 1, "--robot");
  expect_refusal(agent({"--world", "room", "--site", "My Site"}), 1, "--site");
}

/// Logs are read as they are replayed, so these need a server.
class BadLog : public BadAgentInput {
 protected:
  void SetUp() override {
    ASSERT_TRUE(server_.wait_until_ready()) << server_.process().output();
    ASSERT_EQ(server_.cairn({"found", "lab"}).exit_code, 0);
  }
  Finished replay(const std::string& text) {
    return agent({"--site", "lab", "--replay", written(folder_, "bad.log", text)});
  }
  static std::string scan(const std::string& range, const std::string& x) {
    return "FLASER 3 1.0 " + range + " 2.0 0 0 0 " + x + " 0 0 1.5 host 1.5\n";
  }
  ServerProcess server_{folder_};
};

TEST_F(BadLog, ARangeThatIsNoNumberIsNamedByItsLine) {
  expect_refusal(replay(scan("1.0", "0") + scan("nan", "0")), 1, "line 2");
}

TEST_F(BadLog, APositionBeyondTheWorldIsNamedByItsLine) {
  expect_refusal(replay(scan("1.0", "0") + scan("1.0", "1e9")), 1, "line 2");
}

TEST_F(BadLog, ATruncatedLogIsAnError) {
  const std::string whole = scan("1.0", "0") + scan("1.0", "0.1");
  expect_refusal(replay(whole.substr(0, whole.size() - 30)), 1, "line 2");
}

TEST_F(BadLog, AnUnknownSiteTellsHowToFoundIt) {
  const std::string log = written(folder_, "good.log", scan("1.0", "0"));
  expect_refusal(agent({"--site", "nowhere", "--replay", log}), 1, "cairn found nowhere");
}

TEST_F(BadLog, OtherCellsThanTheSitesAreRefused) {
  const std::string log = written(folder_, "good.log", scan("1.0", "0"));
  expect_refusal(agent({"--site", "lab", "--cell-mm", "50", "--replay", log}), 1, "--cell-mm 125");
}

class BadOperatorInput : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(server_.wait_until_ready()) << server_.process().output(); }
  TempFolder folder_;
  ServerProcess server_{folder_};
};

TEST_F(BadOperatorInput, NoServerIsSaidInOneLine) {
  expect_refusal(run({cli_program(), "--server", "127.0.0.1:9", "status"}), 1, "no server at");
}

TEST_F(BadOperatorInput, AGoalWithoutARobotIsExplained) {
  expect_refusal(server_.cairn({"goto", "1", "2"}), 1, "no robot");
}

TEST_F(BadOperatorInput, ABadSiteNameIsExplained) {
  expect_refusal(server_.cairn({"found", "My Site"}), 1, "a-z");
}

TEST_F(BadOperatorInput, ASiteIsFoundedOnce) {
  ASSERT_EQ(server_.cairn({"found", "lab"}).exit_code, 0);
  expect_refusal(server_.cairn({"found", "lab"}), 1, "lab");
}

TEST_F(BadOperatorInput, GoalsThatCannotBeReachedSayWhy) {
  ASSERT_EQ(server_.cairn({"found", "lab"}).exit_code, 0);
  Process agent = start_agent(folder_, "r1", {"--world", "room", "--site", "lab"});
  ASSERT_TRUE(eventually(
      [&] {
        const nlohmann::json status = server_.status();
        return status.is_object() && !status["robots"].empty() &&
               status["sites"][0]["known_cells"].get<int>() > 500;
      },
      20s))
      << agent.output();
  ASSERT_TRUE(
      eventually([&] { return server_.status()["robots"][0]["x_m"].get<double>() > 0.0; }, 10s));
  expect_refusal(server_.cairn({"goto", "400", "2", "--unknown", "blocked"}), 1, "no path");
  expect_refusal(server_.cairn({"goto", "1e9", "2"}), 2, "metres");
  expect_refusal(server_.cairn({"goto", "nan", "2"}), 2, "metres");
}

}  // namespace
}  // namespace cairn::test
