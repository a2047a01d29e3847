#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "tests/support/cairn_programs.h"

namespace cairn::test {
namespace {

using namespace std::chrono_literals;

/// `cairn` on files in a folder of its own, without a server.
class MapTools : public ::testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_.path() / name).string();
  }
  [[nodiscard]] std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }
  [[nodiscard]] static std::string content(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static Finished cairn(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), cli_program());
    return run(arguments, 20s);
  }
  static nlohmann::json json(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const Finished finished = cairn(std::move(arguments));
    EXPECT_EQ(finished.exit_code, 0) << finished.output;
    return nlohmann::json::parse(finished.output, nullptr, false);
  }
  static void expect_refusal(const Finished& finished, int exit_code, const std::string& text) {
    EXPECT_EQ(finished.exit_code, exit_code) << finished.output;
    EXPECT_NE(finished.output.find(text), std::string::npos) << finished.output;
  }

  TempFolder folder_;
  const std::string map_ =
      "type octile\nheight 6\nwidth 8\nmap\n"
      "........\n"
      ".@@@@@..\n"
      ".@...@..\n"
      ".@...@..\n"
      ".@@@@@..\n"
      "........\n";
};

TEST_F(MapTools, ImportedGroundIsDescribedPlannedOnDrawnAndExported) {
  const std::string store = path("m.cairn");
  const auto imported = json({"map", "import", file("m.map", map_), "--site", store});
  EXPECT_EQ(imported["cells"], 48);
  const auto info = json({"map", "info", store});
  EXPECT_EQ(info["extent"]["columns"], 8);
  EXPECT_EQ(info["known_cells"], 48);
  EXPECT_EQ(info["submaps"], 1);

  const std::string png = path("p.png");
  const auto plan =
      json({"plan", store, "--from", "0.5,0.5", "--to", "0.5,5.5", "--radius", "0", "--png", png});
  EXPECT_EQ(plan["status"], "complete");
  EXPECT_EQ(plan["length_m"], 5.0);
  EXPECT_GT(std::filesystem::file_size(png), 1000U);
  expect_refusal(cairn({"plan", store, "--from", "0.5,0.5", "--to", "3.5,3.5", "--radius", "0"}), 1,
                 "no way");

  const std::string out = path("out.map");
  EXPECT_EQ(cairn({"map", "export", store, out}).exit_code, 0);
  EXPECT_EQ(content(out), map_);
}

TEST_F(MapTools, ScenariosAreCountedAndTheExitCodeTells) {
  const std::string store = path("m.cairn");
  ASSERT_EQ(cairn({"map", "import", file("m.map", map_), "--site", store}).exit_code, 0);
  const std::string head = "version 1\n0\tm.map\t8\t6\t";
  const auto good =
      json({"plan", store, "--scen",
            file("good.scen", head + "0\t0\t7\t5\t11.41421\n0 m.map 8 6 0 0 3 3 0\n")});
  EXPECT_EQ(good["scenarios"], 2);
  EXPECT_EQ(good["disagreements"], 0);
  const Finished bad =
      cairn({"plan", store, "--scen", file("bad.scen", head + "0\t0\t3\t3\t6\n"), "--json"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_EQ(nlohmann::json::parse(bad.output)["disagreements"], 1);
}

TEST_F(MapTools, AServerKeepsWhatWasImported) {
  std::filesystem::create_directories(site_folder(folder_));
  const std::string store = (site_folder(folder_) / "yard.cairn").string();
  ASSERT_EQ(cairn({"map", "import", file("m.map", map_), "--site", store}).exit_code, 0);
  EXPECT_EQ(audit(folder_).exit_code, 0);
  {
    ServerProcess server(folder_);
    ASSERT_TRUE(server.wait_until_ready()) << server.process().output();
    EXPECT_EQ(server.status()["sites"][0]["known_cells"], 48);
    const auto online = server.cairn(
        {"plan", "--from", "0.5,0.5", "--to", "7.5,5.5", "--unknown", "allowed", "--json"});
    EXPECT_EQ(online.exit_code, 0) << online.output;
    // It holds the store: the offline tools say so.
    expect_refusal(cairn({"map", "info", store}), 1, "cairn-server");
    expect_refusal(cairn({"map", "import", path("m.map"), "--site", store}), 1, "cairn-server");
  }
  EXPECT_EQ(json({"map", "info", store})["known_cells"], 48);
}

TEST_F(MapTools, BadFilesAreOneClearLineAndMakeNoStore) {
  const std::string store = path("s.cairn");
  const auto import = [&](const std::string& name, const std::string& text) {
    return cairn({"map", "import", file(name, text), "--site", store, "--json"});
  };
  expect_refusal(import("a.map", map_.substr(0, 60)), 1, "line ");
  expect_refusal(import("a.asc",
                        "ncols 100000\nnrows 100000\nxllcorner 0\nyllcorner 0\n"
                        "cellsize 1\n0\n"),
                 1, "67108864");
  expect_refusal(import("a.yaml", "image: a.pgm\n"), 1, "resolution is missing");
  expect_refusal(import("a.csv", "1 2\n3 nothing\n"), 1, "\"nothing\"");
  expect_refusal(import("a.tif", "II*"), 1, "no TIFF");
  expect_refusal(import("a.png", "x"), 1, "must end in");
  EXPECT_FALSE(std::filesystem::exists(store));
  expect_refusal(cairn({"map", "info", store}), 1, "there is no file");
  expect_refusal(cairn({"map", "info", file("x.cairn", std::string(5000, 'x'))}), 1, "no Cairn");
  expect_refusal(cairn({"plan", path("gone.cairn"), "--from", "0,0", "--to", "1,1"}), 1, "no file");
}

}  // namespace
}  // namespace cairn::test
