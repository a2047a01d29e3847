#include "client/cli/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

namespace cairn::cli {
namespace {

using testing::HasSubstr;

template <class T>
T command(std::vector<std::string> arguments) {
  const auto parsed = parse_arguments(std::move(arguments));
  if (const auto* end = std::get_if<Exit>(&parsed)) {
    ADD_FAILURE() << end->err;
    return {};
  }
  return std::get<T>(std::get<Invocation>(parsed).command);
}

Exit usage(std::vector<std::string> arguments) {
  const auto parsed = parse_arguments(std::move(arguments));
  return std::holds_alternative<Exit>(parsed) ? std::get<Exit>(parsed) : Exit{-1, "", ""};
}

TEST(Arguments, TakeNegativeCoordinatesAsNumbers) {
  const auto go = command<GotoCommand>({"goto", "-3", "2.5"});
  EXPECT_EQ(go.request.x_m, -3.0);
  EXPECT_EQ(go.request.y_m, 2.5);
  EXPECT_EQ(command<GotoCommand>({"goto", "1", "-.5", "--follow"}).request.y_m, -0.5);
  EXPECT_EQ(command<PlanCommand>({"plan", "--from=-3,2", "--to", "-1,-2"}).request.from.x_m, -3.0);
  EXPECT_EQ(command<PlanCommand>({"plan", "--from", "-3,2", "--to", "1,2"}).request.from.x_m, -3.0);
}

TEST(Arguments, TakeAHeadingWithEachPlace) {
  const auto go = command<GotoCommand>({"goto", "r2", "-1,2,90", "3,4", "5,-6,-180"}).request;
  EXPECT_NEAR(go.heading_rad.value(), 1.5707963, 1e-6);
  EXPECT_EQ(go.then[0].heading_rad, std::nullopt);
  EXPECT_NEAR(go.then[1].heading_rad.value(), -3.1415927, 1e-6);
  EXPECT_EQ(command<GotoCommand>({"goto", "1", "2"}).request.heading_rad, std::nullopt);
}

TEST(Arguments, SayWhatAHeadingMustBe) {
  for (const char* place : {"1,2,nan", "1,2,361", "1,2,inf", "1,2,", "1,2,3,4", "1,2,north"}) {
    EXPECT_THAT(usage({"goto", place}).err, HasSubstr("-360 to 360")) << place;
  }
}

TEST(Arguments, FillTheGoalsRequest) {
  const auto go =
      command<GotoCommand>({"goto", "1", "2", "--robot", "r2", "--unknown", "blocked",
                            "--on-link-loss", "continue", "--expires", "30", "--partial"});
  EXPECT_EQ(go.request.robot, "r2");
  EXPECT_EQ(go.request.unknown, "blocked");
  EXPECT_EQ(go.request.on_link_loss, "continue");
  EXPECT_EQ(go.request.expires_s, 30.0);
  EXPECT_TRUE(go.request.allow_partial);
  EXPECT_FALSE(go.follow);
}

TEST(Arguments, TakeGlobalOptionsBeforeAndAfterTheCommand) {
  for (const auto& arguments : {std::vector<std::string>{"--json", "--server", "base:99", "status"},
                                {"status", "--json", "--server", "base:99"}}) {
    const auto parsed = parse_arguments(arguments);
    ASSERT_TRUE(std::holds_alternative<Invocation>(parsed));
    EXPECT_TRUE(std::get<Invocation>(parsed).json);
    EXPECT_EQ(std::get<Invocation>(parsed).server.host, "base");
  }
}

TEST(Arguments, TakeTheServerFromTheEnvironment) {
  ::setenv("CAIRN_SERVER", "base.local:8700", 1);
  const auto parsed = parse_arguments({"status"});
  ::unsetenv("CAIRN_SERVER");
  EXPECT_EQ(to_string(std::get<Invocation>(parsed).server), "base.local:8700");
}

TEST(Arguments, TakeOptionsFromAFileAndRefuseUnknownKeys) {
  const std::string file = testing::TempDir() + "cairn_options_test.toml";
  std::ofstream(file) << "server = \"base:99\"\n[goto]\nrobot = \"r2\"\n";
  const auto parsed = parse_arguments({"--config", file, "goto", "1", "2"});
  ASSERT_TRUE(std::holds_alternative<Invocation>(parsed)) << std::get<Exit>(parsed).err;
  EXPECT_EQ(std::get<Invocation>(parsed).server.host, "base");
  EXPECT_EQ(std::get<GotoCommand>(std::get<Invocation>(parsed).command).request.robot, "r2");
  std::ofstream(file) << "sevrer = \"base:99\"\n";
  const auto refused = usage({"--config", file, "status"});
  EXPECT_EQ(refused.code, kExitUsage);
  EXPECT_THAT(refused.err, HasSubstr("sevrer"));
}

TEST(Arguments, TakePlacesInARow) {
  const auto go = command<GotoCommand>({"goto", "r2", "1,2", "-3,.5", "0,0", "--loop", "--queue"});
  EXPECT_EQ(go.request.robot, "r2");
  EXPECT_EQ(go.request.x_m, 1.0);
  ASSERT_EQ(go.request.then.size(), 2U);
  EXPECT_EQ(go.request.then[0].x_m, -3.0);
  EXPECT_TRUE(go.request.loop);
  EXPECT_TRUE(go.request.queue);
  EXPECT_EQ(command<GotoCommand>({"goto", "-3,2"}).request.y_m, 2.0);
  EXPECT_EQ(command<GotoCommand>({"goto", "5", "1,2"}).request.robot, "5");
  EXPECT_EQ(command<GotoCommand>({"goto", "5", "1"}).request.robot, std::nullopt);
}

TEST(Arguments, TakeTasks) {
  const auto explore = command<ExploreCommand>(
      {"explore", "r2", "--area", "-1,-2,3,4.5", "--on-link-loss", "stop", "--follow"});
  EXPECT_EQ(explore.request.robot, "r2");
  EXPECT_EQ(explore.request.area->south_m, -2.0);
  EXPECT_EQ(explore.request.on_link_loss, "stop");
  EXPECT_TRUE(explore.follow);
  EXPECT_EQ(command<ExploreCommand>({"explore"}).request.area, std::nullopt);
  EXPECT_EQ(command<ReturnCommand>({"return", "--robot", "r3"}).request.robot, "r3");
}

TEST(Arguments, AStoreMeansNoServer) {
  const auto plan = command<PlanOnStoreCommand>(
      {"plan", "yard.cairn", "--from", "-1,2", "--to", "3,4", "--radius", "0.3", "--climb", "0.2",
       "--descend", "0.15", "--unknown", "allowed", "--png", "p.png"});
  EXPECT_EQ(plan.store, "yard.cairn");
  EXPECT_EQ(plan.limits, (VehicleLimits{200, 150, 0.3}));
  EXPECT_EQ(plan.plan.request.from.x_m, -1.0);
  EXPECT_EQ(plan.plan.request.unknown, "allowed");
  EXPECT_EQ(command<PlanOnStoreCommand>({"plan", "s", "--from", "1,2", "--to", "3,4"}).limits,
            VehicleLimits{});
  EXPECT_EQ(command<DrawStoreCommand>({"map", "yard.cairn", "--png", "m.png"}).store, "yard.cairn");
  EXPECT_EQ(command<MapCommand>({"map", "--png", "m.png"}).png, "m.png");
}

TEST(Arguments, ScenariosArePlannedForAPoint) {
  const auto scenarios = command<ScenariosCommand>({"plan", "a.cairn", "--scen", "a.scen"});
  EXPECT_EQ(scenarios.limits.radius_m, 0.0);
  EXPECT_EQ(scenarios.unknown, "blocked");
}

TEST(Arguments, MapFilesComeAndGo) {
  const auto import =
      command<ImportCommand>({"map", "import", "h.csv", "--site", "h.cairn", "--cell-size", "0.5",
                              "--name", "hills", "--origin", "-3,.5,100"});
  EXPECT_EQ(import.request.map_file, "h.csv");
  EXPECT_EQ(import.request.store, "h.cairn");
  EXPECT_EQ(import.request.cell_m, 0.5);
  EXPECT_EQ(import.request.name, "hills");
  EXPECT_EQ(import.request.origin_m, (std::array{-3.0, 0.5, 100.0}));
  const auto out = command<ExportCommand>({"map", "export", "h.cairn", "h.tif"});
  EXPECT_EQ(out.store, "h.cairn");
  EXPECT_EQ(out.file, "h.tif");
  EXPECT_EQ(command<InfoCommand>({"map", "info", "h.cairn", "--json"}).store, "h.cairn");
}

TEST(Arguments, EndWithUsageWhenTheyAreWrong) {
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {},
           {"fly"},
           {"goto", "1"},
           {"goto", "x", "2"},
           {"goto", "nan", "2"},
           {"goto", "1e9", "2"},
           {"goto", "1", "2", "3"},
           {"goto", "1", "2", "--unknown", "maybe"},
           {"goto", "1", "2", "--expires", "0"},
           {"map"},
           {"map", "h.cairn"},
           {"map", "import", "a.map"},
           {"map", "import", "--site", "h.cairn"},
           {"map", "import", "a", "--site", "b", "--origin", "1"},
           {"map", "import", "a", "--site", "b", "--cell-size", "0"},
           {"map", "export", "h.cairn"},
           {"map", "export", "h.cairn", "a.tif", "b.tif"},
           {"map", "info"},
           {"map", "s", "--png", "p", "--site", "t"},
           {"plan", "h.cairn"},
           {"plan", "--scen", "a.scen"},
           {"plan", "s", "--scen", "a", "--from", "1,2"},
           {"plan", "--from", "1,2", "--to", "3,4", "--climb", "1"},
           {"plan", "s", "--from", "1,2", "--to", "3,4", "--climb", "3"},
           {"plan", "--from", "1", "--to", "2,3"},
           {"found", "a", "--cell-mm", "5"},
           {"--server", "base", "status"},
           {"status", "--nope"}}) {
    EXPECT_EQ(usage(arguments).code, kExitUsage) << testing::PrintToString(arguments);
  }
}

TEST(Arguments, HelpOfEachCommandTeachesByExample) {
  for (const char* name :
       {"status", "found", "goto", "explore", "return", "stop", "map", "watch", "plan", "link"}) {
    const auto help = usage({name, "--help"});
    EXPECT_EQ(help.code, kExitOk);
    EXPECT_THAT(help.out, HasSubstr(std::string("Examples:\n  cairn ")));
  }
}

TEST(ServerAddress, IsAHostAndAPort) {
  EXPECT_EQ(parse_server("[::1]:80")->host, "::1");
  EXPECT_EQ(to_string(*parse_server("[::1]:80")), "[::1]:80");
  for (const char* text : {"", "host", "host:", ":80", "host:0", "host:99999", "::1:80", "h:8a"}) {
    EXPECT_FALSE(parse_server(text)) << text;
  }
}

}  // namespace
}  // namespace cairn::cli
