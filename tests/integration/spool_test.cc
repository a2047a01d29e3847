#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "robot_agent/spool/kept_file.h"
#include "server/store/sqlite_store.h"
#include "tests/support/cairn_programs.h"

/// Evidence that the server could not take outlives the agent.
namespace cairn::test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

class SpoolTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(server_.wait_until_ready()) << server_.process().output();
    ASSERT_EQ(server_.cairn({"found", "lab"}).exit_code, 0);
  }
  Process start(std::vector<std::string> more = {}) {
    more.insert(more.begin(),
                {"--world", "room", "--site", "lab", "--speed", "4", "--spool", spool_.string()});
    return start_agent(folder_, "r1", more);
  }
  json robot() {
    const json status = server_.status();
    const bool there = status.is_object() && !status["robots"].empty();
    return there ? status["robots"][0] : json{{"link", json::object()}};
  }
  bool connected() {
    return eventually([&] { return robot()["link"].value("connected", false); }, 40s);
  }
  json spool_state() { return robot()["link"].value("spool", json::object()); }
  /// What the files in the spool hold now.
  std::map<SubmapId, proto::KeptSubmap> kept() {
    std::map<SubmapId, proto::KeptSubmap> all;
    for (const auto& file : std::filesystem::directory_iterator(spool_)) {
      if (file.path().extension() != ".submap") continue;
      std::ifstream in(file.path(), std::ios::binary);
      const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in), {}};
      const auto read = agent::read_kept(bytes, {"r1", "lab", 125});
      if (read) all.emplace(read->id, *read);
    }
    return all;
  }
  void restart_server() {
    server_ = ServerProcess(folder_);
    ASSERT_TRUE(server_.wait_until_ready()) << server_.process().output();
  }

  TempFolder folder_;
  std::filesystem::path spool_ = folder_.path() / "spool";
  ServerProcess server_{folder_};
};

TEST_F(SpoolTest, WhatWasMappedWhileTheServerWasAwayOutlivesTheAgentAndArrivesOnce) {
  Process agent = start();
  ASSERT_TRUE(connected()) << agent.output();
  ASSERT_EQ(server_.cairn({"goto", "5", "2.5", "--on-link-loss", "continue"}).exit_code, 0);
  ASSERT_TRUE(eventually(
      [&] {
        const json command = robot().value("command", json::object());
        return command.value("state", "") == "accepted";
      },
      20s))
      << robot().dump();
  server_.process().kill();
  ASSERT_TRUE(agent.wait_for_output("command 1: arrived", 60s)) << agent.output();
  // The last of its way is on disk a few seconds later.
  const auto arrived = std::chrono::steady_clock::now();
  ASSERT_TRUE(eventually([&] { return std::chrono::steady_clock::now() - arrived > 5s; }, 10s));
  agent.kill();
  const auto left = kept();
  ASSERT_FALSE(left.empty());  // The server held some of it when it died.

  restart_server();
  const json before = server_.status()["sites"][0];
  agent = start();
  ASSERT_TRUE(connected()) << agent.output();
  ASSERT_TRUE(eventually(
      [&] {
        return std::ranges::none_of(
            left, [now = kept()](const auto& submap) { return now.contains(submap.first); });
      },
      40s))
      << agent.output();
  const json after = server_.status()["sites"][0];
  EXPECT_GT(after["known_cells"].get<int>(), before["known_cells"].get<int>());
  EXPECT_GE(after["submaps_merged"].get<std::size_t>(), left.size());
  ASSERT_TRUE(eventually([&] { return spool_state().value("submaps", 99) <= 1; }, 20s))
      << robot().dump();

  agent.kill();
  server_.process().kill();
  auto store = server::SqliteStore::open(site_folder(folder_) / "lab.cairn");
  ASSERT_TRUE(store) << store.error().message;
  const auto rows = (*store)->submaps();
  ASSERT_TRUE(rows) << rows.error().message;
  for (const auto& [id, submap] : left) {
    const auto row = std::ranges::find(*rows, id, &server::SubmapRow::id);
    ASSERT_NE(row, rows->end());
    EXPECT_EQ(row->state, server::SubmapState::merged);
    std::map<BlockKey, std::uint32_t> held;
    const auto blocks = (*store)->blocks_of(id);
    ASSERT_TRUE(blocks) << blocks.error().message;
    for (const server::BlockRow& block : *blocks) held[block.key] = block.version;
    for (const auto& block : submap.blocks) EXPECT_GE(held[block.key], block.version);
  }
  store = Error{ErrorCode::unavailable, "closed"};
  const Finished audited = audit(folder_);
  EXPECT_EQ(audited.exit_code, 0) << audited.output;
}

TEST_F(SpoolTest, AnAgentWhoseSpoolCannotBeUsedMapsOnAndTheOperatorSeesIt) {
  std::ofstream(spool_) << "a file, not a folder";
  Process agent = start();
  ASSERT_TRUE(connected()) << agent.output();
  EXPECT_TRUE(eventually([&] { return spool_state().value("state", "") == "failed"; }, 20s));
  EXPECT_TRUE(agent.wait_for_output("evidence is kept in memory only", 5s)) << agent.output();
  EXPECT_TRUE(eventually(
      [&] { return server_.status()["sites"][0]["known_cells"].get<int>() > 500; }, 20s));
  const Finished link = server_.cairn({"link"});
  EXPECT_NE(link.output.find("DISK FAILED"), std::string::npos) << link.output;
}

TEST_F(SpoolTest, AnAgentThatEndsInGoodOrderLeavesWhatItHasToTheNext) {
  Process agent = start();
  ASSERT_TRUE(connected()) << agent.output();
  ASSERT_TRUE(eventually(
      [&] { return server_.status()["sites"][0]["known_cells"].get<int>() > 500; }, 20s));
  agent.signal(SIGTERM);
  ASSERT_EQ(agent.wait(10s), 0) << agent.output();
  EXPECT_EQ(kept().size(), 1U);  // The submap that was open.
  agent = start();
  ASSERT_TRUE(eventually(
      [&] { return server_.status()["sites"][0]["submaps_merged"].get<int>() == 1; }, 40s))
      << agent.output();
}

}  // namespace
}  // namespace cairn::test
