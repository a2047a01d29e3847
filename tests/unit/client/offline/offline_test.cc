#include <gmock/gmock.h>

#include "client/map_files/height_tiff.h"
#include "client/offline/export.h"
#include "client/offline/import.h"
#include "client/offline/scenarios.h"
#include "server/store/sqlite_store.h"
#include "server/world/audit.h"
#include "tests/support/data_folder.h"
#include "tests/unit/client/map_files/temp_file.h"

namespace cairn::offline {
namespace {

using map_files::HeightRaster;
using map_files::RasterFrame;
using testing::HasSubstr;

class Offline : public test::FilesTest {
 protected:
  ImportReport import(const ImportRequest& request) {
    const auto report = import_map(request);
    EXPECT_TRUE(report) << report.error().message;
    return report ? *report : ImportReport{};
  }
  std::string import_fault(const ImportRequest& request) {
    const auto report = import_map(request);
    EXPECT_FALSE(report);
    return report ? "" : report.error().message;
  }
  ImportRequest request(const std::string& map_file, const std::string& store = "site.cairn") {
    ImportRequest made;
    made.map_file = map_file;
    made.store = path(store);
    return made;
  }
  void export_to(const std::string& name, const std::string& store = "site.cairn") {
    const auto site = open_site(path(store));
    ASSERT_TRUE(site) << site.error().message;
    const auto report = export_map(*site, path(name), VehicleLimits{});
    ASSERT_TRUE(report) << report.error().message;
  }
  void expect_sound(const std::string& store = "site.cairn") {
    const auto opened = server::SqliteStore::open(path(store));
    ASSERT_TRUE(opened) << opened.error().message;
    const auto audit = server::audit(**opened, SensorModel{});
    ASSERT_TRUE(audit);
    EXPECT_TRUE(audit->sound()) << testing::PrintToString(audit->faults);
    EXPECT_GT(audit->merged_submaps, 0U);
  }
  /// A hill with a hole in the map and unknown borders, larger than one submap.
  static HeightRaster hill(int columns, int rows) {
    HeightRaster raster;
    raster.frame = {columns, rows, 0.25, RasterFrame::Corner{-12.5, 3.75}, 0.0};
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const bool hole = row == 0 || column == columns - 1 || (row == 7 && column % 3 == 0);
        raster.height_mm.push_back(hole ? HeightRaster::kUnknown
                                        : 300'000 + 10 * row - 7 * column + (row * column) % 5);
      }
    }
    return raster;
  }
};

const std::string kMaze =
    "type octile\nheight 5\nwidth 6\nmap\n......\n.@@@@.\n.@..@.\n.@@@@.\n......\n";

TEST_F(Offline, AMovingAiMapComesOutAsItWentIn) {
  const auto report = import(request(file("m.map", kMaze)));
  EXPECT_TRUE(report.founded);
  EXPECT_EQ(report.site.known_cells, 30U);
  export_to("out.map");
  EXPECT_EQ(content(path("out.map")), kMaze);
  expect_sound();
}

TEST_F(Offline, HeightsComeOutAsTheyWentInThroughEveryKind) {
  const HeightRaster raster = hill(300, 270);
  ASSERT_TRUE(map_files::write_height_tiff(path("in.tif"), raster));
  const auto report = import(request(path("in.tif")));
  EXPECT_EQ(report.submaps, 4);
  EXPECT_EQ(report.too_steep, 0);
  export_to("out.tif");
  EXPECT_EQ(content(path("out.tif")), content(path("in.tif")));
  export_to("out.asc");
  import(request(path("out.asc"), "second.cairn"));
  export_to("again.asc", "second.cairn");
  EXPECT_EQ(content(path("again.asc")), content(path("out.asc")));
  expect_sound();
  expect_sound("second.cairn");
}

TEST_F(Offline, ARosMapComesOutAsItWentIn) {
  const std::string picture =
      "P5\n4 3\n255\n" + std::string("\xFE\xFE\xFE\xCD\xFE\x00\xFE\xCD\xCD\xCD\xCD\xCD", 12);
  (void)file("in.pgm", picture);
  import(request(file("in.yaml",
                      "image: in.pgm\nresolution: 0.05\norigin: [-1, -2.5, 0]\nnegate: 0\n"
                      "occupied_thresh: 0.65\nfree_thresh: 0.196\n")));
  export_to("out.yaml");
  EXPECT_EQ(content(path("out.pgm")), picture);
  EXPECT_THAT(content(path("out.yaml")), HasSubstr("origin: [-1.000, -2.500, 0.0]"));
}

TEST_F(Offline, CoordinatesOfANationalGridAreRememberedAndComeBack) {
  HeightRaster raster = hill(40, 30);
  raster.frame.south_west = RasterFrame::Corner{561000.0, 4304000.125};
  ASSERT_TRUE(map_files::write_height_tiff(path("in.tif"), raster));
  const auto report = import(request(path("in.tif")));
  EXPECT_EQ(report.west_m, 0.0);
  EXPECT_EQ(report.site.offset.y_m, 4304000.125);
  export_to("out.tif");
  EXPECT_EQ(content(path("out.tif")), content(path("in.tif")));
  // The next file of the same grid lands beside the first.
  raster.frame.south_west->x_m += 10.0;
  ASSERT_TRUE(map_files::write_height_tiff(path("east.tif"), raster));
  EXPECT_EQ(import(request(path("east.tif"))).west_m, 10.0);
  expect_sound();
}

TEST_F(Offline, TheOriginMayBeGivenWithAHeight) {
  ImportRequest wanted = request(file("h.csv", "1 2\n3 4\n"));
  wanted.cell_m = 0.5;
  wanted.origin_m = {-5.0, 2.0, 100.0};
  import(wanted);
  const auto site = open_site(path("site.cairn"));
  ASSERT_TRUE(site);
  const SiteFacts facts = facts_of(*site);
  EXPECT_EQ(facts.extent->lowest, (CellIndex{-10, 4}));
  EXPECT_EQ(facts.lowest_mm, 101'000);
  EXPECT_EQ(facts.levels.size(), 1U);
  EXPECT_GT(facts.bytes_on_disk, 4096U);
}

TEST_F(Offline, WhatCannotBeLaidIntoASiteIsRefusedAndMakesNone) {
  const std::string csv = file("h.csv", "1 2\n3 4\n");
  EXPECT_THAT(import_fault(request(csv)), HasSubstr("--cell-size"));
  ImportRequest wanted = request(csv);
  wanted.cell_m = 30.0;
  EXPECT_THAT(import_fault(wanted), HasSubstr("0.01 to 2 m"));
  wanted.cell_m = 0.3048;
  EXPECT_THAT(import_fault(wanted), HasSubstr("whole millimetres"));
  wanted.cell_m = 0.5;
  wanted.origin_m = {99'999.9, 0.0, 0.0};
  EXPECT_THAT(import_fault(wanted), HasSubstr("100 km"));
  wanted.origin_m.reset();
  wanted.name = "No Name";
  EXPECT_THAT(import_fault(wanted), HasSubstr("--name"));
  EXPECT_FALSE(std::filesystem::exists(wanted.store));
  wanted.name.reset();
  import(wanted);
  wanted.cell_m = 0.25;
  EXPECT_THAT(import_fault(wanted), HasSubstr("500"));
}

TEST_F(Offline, AStoreThatIsNoneOrHeldByAServerIsRefused) {
  EXPECT_EQ(open_site(path("gone.cairn")).error().code, ErrorCode::not_found);
  EXPECT_EQ(open_site(file("x.cairn", std::string(5000, 'x'))).error().code, ErrorCode::corrupt);
  EXPECT_FALSE(open_site(file("empty.cairn", "")));
  import(request(file("m.map", kMaze)));
  const auto held = server::SqliteStore::open(path("site.cairn"));
  EXPECT_EQ(open_site(path("site.cairn")).error().code, ErrorCode::conflict);
}

TEST_F(Offline, GroundFarApartIsRefusedAsARasterButNotAsPoints) {
  const std::string csv = file("h.csv", "1 2\n3 4\n");
  for (const double place_m : {-49'000.0, 49'000.0}) {
    ImportRequest wanted = request(csv);
    wanted.cell_m = 0.5;
    wanted.origin_m = {place_m, place_m, 0.0};
    import(wanted);
  }
  const auto site = open_site(path("site.cairn"));
  ASSERT_TRUE(site);
  const auto refused = export_map(*site, path("far.asc"), VehicleLimits{});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::exhausted);
  EXPECT_FALSE(run_scenarios(*site, {}, PlannerConfig{}));
  ASSERT_TRUE(export_map(*site, path("far.ply"), VehicleLimits{}));
  EXPECT_THAT(content(path("far.ply")), HasSubstr("element vertex 8\n"));
}

TEST_F(Offline, HeightsBeyondATilesReachAreCounted) {
  ImportRequest wanted = request(file("h.csv", "0 0 0\n0 80 0\n0 0 0\n"));
  wanted.cell_m = 1.0;
  EXPECT_EQ(import(wanted).too_steep, 1);
  expect_sound();
}

TEST_F(Offline, ARobotsPlannerCanUseWhatWasImportedTwice) {
  import(request(file("m.map", kMaze)));
  import(request(path("m.map")));
  export_to("out.map");
  EXPECT_EQ(content(path("out.map")), kMaze);
  expect_sound();
}

// ---- Scenarios ----------------------------------------------------------------------------------

std::string scen(const std::string& fields) {
  return "version 1\n0\tmaps/m.map\t6\t5\t" + fields + "\n";
}

class Scenarios : public Offline {
 protected:
  ScenarioReport run(const std::string& text) {
    import(request(file("m.map", kMaze), "maze.cairn"));
    const auto scenarios = read_scenarios(file("m.scen", text));
    EXPECT_TRUE(scenarios) << scenarios.error().message;
    PlannerConfig point;
    point.limits.radius_m = 0.0;
    const auto report = run_scenarios(open_site(path("maze.cairn")).value(), *scenarios, point);
    EXPECT_TRUE(report) << report.error().message;
    std::filesystem::remove(path("maze.cairn"));
    return *report;
  }
  std::string scen_fault(const std::string& text) {
    const auto scenarios = read_scenarios(file("m.scen", text));
    EXPECT_FALSE(scenarios) << text;
    return scenarios ? "" : scenarios.error().message;
  }
};

TEST_F(Scenarios, AgreeOnAWayAroundAndOnNone) {
  const auto report = run(scen("0\t0\t5\t4\t9") + "1 m.map 6 5 0 0 2 2 0\n1 m.map 6 5 2 2 3 2 1\n" +
                          "2 m.map 6 5 1 1 2 1 0\n3 m.map 6 5 4 0 4 0 0\n");
  EXPECT_EQ(report.scenarios, 5U);
  EXPECT_EQ(report.disagreements, 0U) << testing::PrintToString(report.examples);
  EXPECT_EQ(report.reached, 3U);
  EXPECT_EQ(report.unreachable, 2U);
  EXPECT_TRUE(report.good());
}

TEST_F(Scenarios, DisagreementsAreCounted) {
  const auto report = run(scen("0\t0\t5\t4\t0") + "1 m.map 6 5 0 0 2 2 7\n");
  EXPECT_EQ(report.disagreements, 2U);
  EXPECT_FALSE(report.good());
  EXPECT_EQ(report.examples.size(), 2U);
}

TEST_F(Scenarios, LongerPathsAreCounted) {
  EXPECT_EQ(run(scen("0\t0\t0\t4\t3.9")).longer, 1U);
  EXPECT_EQ(run(scen("0\t0\t0\t4\t4")).longer, 0U);
}

TEST_F(Scenarios, AWayInAnyDirectionPassesBesideACornerAndIsShorterThanTheListedOne) {
  const auto report = run(scen("1\t0\t0\t1\t2"));  // Around the obstacle at (1, 1).
  EXPECT_EQ(report.invalid, 0U);
  EXPECT_GT(report.worst_ratio, 0.7071068);
  EXPECT_LT(report.worst_ratio, 1.0);
}

TEST_F(Scenarios, FaultsOfTheFileAreNamed) {
  EXPECT_THAT(scen_fault("1 2 3\n"), HasSubstr("no scenario file"));
  EXPECT_THAT(scen_fault("version 2\n"), HasSubstr("version 1"));
  EXPECT_THAT(scen_fault(scen("0\t0\t5\t4")), HasSubstr("line 2: has 8 fields"));
  EXPECT_THAT(scen_fault(scen("0\t0\t6\t4\t9")), HasSubstr("outside the map"));
  EXPECT_THAT(scen_fault(scen("0\t0\t5\t-1\t9")), HasSubstr("is no cell"));
  EXPECT_THAT(scen_fault(scen("0\t0\t5\t4\tnan")), HasSubstr("is no length"));
}

TEST_F(Scenarios, OfAnotherMapAreRefused) {
  import(request(file("m.map", kMaze)));
  const auto other = read_scenarios(file("m.scen", "version 1.0\n0 m 7 5 0 0 1 1 1\n"));
  ASSERT_TRUE(other);
  const auto report = run_scenarios(open_site(path("site.cairn")).value(), *other, PlannerConfig{});
  EXPECT_THAT(report.error().message, HasSubstr("7 x 5"));
}

TEST_F(Scenarios, OfARealMapAllAgree) {
  const auto data = test::data_folder();
  if (data.empty()) GTEST_SKIP() << "skipped: no data folder";
  const std::string map = data / "movingai/dao/den312d.map";
  import(request(map));
  const auto scenarios = read_scenarios(map + ".scen");
  ASSERT_TRUE(scenarios);
  PlannerConfig point;
  point.limits.radius_m = 0.0;
  const auto report = run_scenarios(open_site(path("site.cairn")).value(), *scenarios, point);
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->good()) << testing::PrintToString(report->examples);
}

TEST_F(Offline, RealTerrainComesOutAsItWentIn) {
  const auto data = test::data_folder();
  if (data.empty()) GTEST_SKIP() << "skipped: no data folder";
  const auto before = map_files::read_height_tiff(data / "terrain/viewshed_dsm_1m.tif");
  ASSERT_TRUE(before);
  import(request(data / "terrain/viewshed_dsm_1m.tif"));
  export_to("out.tif");
  const auto after = map_files::read_height_tiff(path("out.tif"));
  ASSERT_TRUE(after);
  EXPECT_EQ(before->height_mm, after->height_mm);
}

}  // namespace
}  // namespace cairn::offline
