#include <gmock/gmock.h>

#include "client/map_files/esri_ascii.h"
#include "client/map_files/height_tiff.h"
#include "client/map_files/map_file.h"
#include "client/map_files/movingai_map.h"
#include "client/map_files/passable.h"
#include "client/map_files/ros_map.h"
#include "tests/unit/client/map_files/temp_file.h"

namespace cairn::map_files {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr auto kUnknown = HeightRaster::kUnknown;
constexpr auto kFree = CellClass::free;
constexpr auto kWall = CellClass::obstacle;

class Readers : public test::FilesTest {
 protected:
  /// What is wrong with a file of this ending and content.
  std::string fault(const std::string& name, const std::string& text) {
    const auto read = read_map_file(file(name, text));
    EXPECT_FALSE(read) << text;
    return read ? "" : read.error().message;
  }
};

const std::string kHead = "type octile\nheight 2\nwidth 3\nmap\n";

TEST_F(Readers, MovingAiRowsComeFromTheNorth) {
  const auto map = read_movingai_map(file("a.map", kHead + "@.G\nSTW\n"));
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_THAT(map->classes, ElementsAre(kFree, kWall, kWall, kWall, kFree, kFree));
  EXPECT_EQ(map->frame.cell_m, 0.0);
}

TEST_F(Readers, MovingAiMapsComeOutAsTheyWentIn) {
  const std::string text = kHead + "@..\n.@@\n";
  const auto map = read_movingai_map(file("a.map", text));
  ASSERT_TRUE(write_movingai_map(path("b.map"), *map));
  EXPECT_EQ(content(path("b.map")), text);
}

TEST_F(Readers, MovingAiFaultsAreNamedByTheirLine) {
  EXPECT_THAT(fault("a.map", kHead + "...\n"), HasSubstr("has 0 cells, expected 3"));
  EXPECT_THAT(fault("a.map", kHead + "...\n..\n"), HasSubstr("line 6: has 2 cells"));
  EXPECT_THAT(fault("a.map", kHead + "...\n.x.\n"), HasSubstr("'x' is none of"));
  EXPECT_THAT(fault("a.map", kHead + "...\n...\n...\n"), HasSubstr("more rows"));
  EXPECT_THAT(fault("a.map", "type hex\n"), HasSubstr("not octile"));
  EXPECT_THAT(fault("a.map", "width 3\nmap\n...\n"), HasSubstr("must come before map"));
  EXPECT_THAT(fault("a.map", "PNG"), HasSubstr("no Moving AI map"));
  EXPECT_THAT(fault("a.map", ""), HasSubstr("ends in its head"));
  EXPECT_THAT(fault("a.map", "type octile\nheight 100000\nwidth 100000\nmap\n"),
              HasSubstr("67108864"));
  EXPECT_THAT(fault("a.map", "type octile\nheight -3\nwidth 5\nmap\n"), HasSubstr("at least one"));
  EXPECT_THAT(fault("a.map", kHead + "@@@\n@@@\n"), HasSubstr("no free cell"));
}

const std::string kYaml =
    "image: m.pgm  # beside it\nresolution: 0.05\norigin: [-1.5, 2, 0.0]\nnegate: 0\n"
    "occupied_thresh: 0.65\nfree_thresh: 0.196\n";

std::string pgm(const std::string& pixels) { return "P5\n# map_saver\n3 2\n255\n" + pixels; }

TEST_F(Readers, RosMapsKnowFreeOccupiedAndUnknown) {
  (void)file("m.pgm", pgm(std::string("\xFE\x00\xCD\xFE\xFE\x00", 6)));
  const auto map = read_ros_map(file("m.yaml", kYaml));
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_THAT(map->classes, ElementsAre(kFree, kFree, kWall, kFree, kWall, CellClass::unknown));
  EXPECT_EQ(map->frame.cell_m, 0.05);
  EXPECT_EQ(map->frame.south_west->x_m, -1.5);
}

TEST_F(Readers, RosMapsComeOutAsTheyWentIn) {
  const std::string picture = "P5\n3 2\n255\n" + std::string("\xFE\x00\xCD\xFE\xFE\x00", 6);
  (void)file("m.pgm", picture);
  const auto map = read_ros_map(file("m.yaml", kYaml));
  ASSERT_TRUE(write_ros_map(path("n.yaml"), *map));
  EXPECT_EQ(content(path("n.pgm")), picture);
  const auto again = read_ros_map(path("n.yaml"));
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->classes, map->classes);
  EXPECT_EQ(*again->frame.south_west, *map->frame.south_west);
}

TEST_F(Readers, RosMapsMayBeTextNegatedSixteenBitsDeepAndListTheirOrigin) {
  (void)file("m.pgm", "P2 3 2 65535\n0 65535 0\n0 0 65535\n");
  const std::string yaml =
      "image: \"m.pgm\"\nmode: trinary\nresolution: 0.05\norigin:\n  - 1\n  - -2\n  - 0.5\n"
      "negate: 1\noccupied_thresh: 0.65\nfree_thresh: 0.25\n";
  const auto map = read_ros_map(file("m.yaml", yaml));
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_THAT(map->classes, ElementsAre(kFree, kFree, kWall, kFree, kWall, kFree));
  EXPECT_EQ(map->frame.yaw_rad, 0.5);
}

TEST_F(Readers, RosFaultsAreNamed) {
  (void)file("m.pgm", pgm("\xFE\xFE"));
  EXPECT_THAT(fault("m.yaml", kYaml), HasSubstr("ends before its last pixel"));
  (void)file("m.pgm", "P6\n3 2\n255\nxxxxxx");
  EXPECT_THAT(fault("m.yaml", kYaml), HasSubstr("no PGM"));
  (void)file("m.pgm", "GIF89a");
  EXPECT_THAT(fault("m.yaml", kYaml), HasSubstr("neither PGM nor PNG"));
  (void)file("m.pgm", "P5\n99999 99999\n255\n");
  EXPECT_THAT(fault("m.yaml", kYaml), HasSubstr("67108864"));
  for (const char* key : {"image", "resolution", "origin", "negate", "occupied", "free"}) {
    std::string yaml = kYaml;
    yaml.replace(yaml.find(key), 1, "x");
    EXPECT_THAT(fault("m.yaml", yaml), HasSubstr(std::string("the key ") + key));
  }
  const auto with = [](const std::string& from, const std::string& to) {
    std::string yaml = kYaml;
    return yaml.replace(yaml.find(from), from.size(), to);
  };
  EXPECT_THAT(fault("m.yaml", with("0.05", "nan")), HasSubstr("resolution"));
  EXPECT_THAT(fault("m.yaml", with("0.05", "-1")), HasSubstr("above 0"));
  EXPECT_THAT(fault("m.yaml", with(", 0.0]", "]")), HasSubstr("origin must have 3 values"));
  EXPECT_THAT(fault("m.yaml", with("0.196", "0.9")), HasSubstr("free_thresh"));
  EXPECT_THAT(fault("m.yaml", with("m.pgm", "gone.pgm")), HasSubstr("gone.pgm"));
}

const std::string kEsri = "NCOLS 3\nnrows 2\nxllcorner 10\nyllcorner -2.5\ncellsize 0.5\n";

TEST_F(Readers, EsriGridsHoldHeightsFromTheNorth) {
  const auto grid =
      read_esri_ascii(file("e.asc", kEsri + "nodata_value -1\n1 2.5 -1 nan -0.001 6\n"));
  ASSERT_TRUE(grid) << grid.error().message;
  EXPECT_THAT(grid->height_mm, ElementsAre(kUnknown, -1, 6000, 1000, 2500, kUnknown));
  EXPECT_EQ(grid->frame.south_west->y_m, -2.5);
}

TEST_F(Readers, EsriCentresAreHalfACellFromTheCorner) {
  const auto grid =
      read_esri_ascii(file("e.asc", "ncols 1\nnrows 1\nxllcenter 0\nyllcenter 0\ncellsize 1\n7\n"));
  ASSERT_TRUE(grid) << grid.error().message;
  EXPECT_EQ(grid->frame.south_west->x_m, -0.5);
}

TEST_F(Readers, EsriFaultsAreNamed) {
  EXPECT_THAT(fault("e.asc", kEsri + "1 2 3\n4 5\n"), HasSubstr("before its last height"));
  EXPECT_THAT(fault("e.asc", kEsri + "1 2 3\n4 5 6 7\n"), HasSubstr("more heights"));
  EXPECT_THAT(fault("e.asc", kEsri + "1 2 3\n4 five 6\n"), HasSubstr("line 7: \"five\""));
  EXPECT_THAT(fault("e.asc", kEsri + "1 2 3\n4 1e9 6\n"), HasSubstr("out of range"));
  EXPECT_THAT(fault("e.asc", kEsri + "1 2 3\n4 inf 6\n"), HasSubstr("out of range"));
  EXPECT_THAT(fault("e.asc", "ncols 3\n1 2 3\n"), HasSubstr("no nrows"));
  EXPECT_THAT(fault("e.asc", "ncols nan\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1\n"),
              HasSubstr("out of range"));
  EXPECT_THAT(fault("e.asc", "ncols 1e5\nnrows 1e5\nxllcorner 0\nyllcorner 0\ncellsize 1\n1\n"),
              HasSubstr("67108864"));
  EXPECT_THAT(fault("e.asc", std::string(300, '7')), HasSubstr("too long"));
  EXPECT_THAT(fault("e.asc", std::string("ncols \x01", 7)), HasSubstr("no text"));
}

TEST_F(Readers, CsvTakesBlanksCommasAndGaps) {
  const auto grid = read_csv_heights(file("h.csv", "1, 2,,4\n\n5;6;-9999;nan\r\n7 8 9 10\n"));
  ASSERT_TRUE(grid) << grid.error().message;
  EXPECT_EQ(grid->frame.columns, 4);
  EXPECT_THAT(grid->height_mm, ElementsAre(7000, 8000, 9000, 10000, 5000, 6000, kUnknown, kUnknown,
                                           1000, 2000, kUnknown, 4000));
  EXPECT_THAT(fault("h.csv", "1,2\n3\n4,5\n"), HasSubstr("as many heights as the first"));
  EXPECT_THAT(fault("h.csv", "\n \n"), HasSubstr("no heights"));
}

TEST_F(Readers, HeightsComeOutOfEveryKindAsTheyWentIn) {
  HeightRaster raster;
  raster.frame = {3, 2, 0.25, RasterFrame::Corner{378922.125, -40.5}, 0.0};
  raster.height_mm = {-1, 0, 12345, kUnknown, 1347030, -32768};
  const auto same_heights = [&](const Result<HeightRaster>& read) {
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->height_mm, raster.height_mm);
    EXPECT_EQ(read->frame.columns, 3);
  };
  ASSERT_TRUE(write_esri_ascii(path("r.asc"), raster));
  same_heights(read_esri_ascii(path("r.asc")));
  EXPECT_EQ(*read_esri_ascii(path("r.asc"))->frame.south_west, *raster.frame.south_west);
  ASSERT_TRUE(write_csv_heights(path("r.csv"), raster));
  same_heights(read_csv_heights(path("r.csv")));
  ASSERT_TRUE(write_height_tiff(path("r.tif"), raster));
  const auto tiff = read_height_tiff(path("r.tif"));
  same_heights(tiff);
  EXPECT_EQ(*tiff->frame.south_west, *raster.frame.south_west);
  EXPECT_EQ(tiff->frame.cell_m, 0.25);
}

TEST_F(Readers, TiffFaultsAreNamed) {
  HeightRaster raster;
  raster.frame = {40, 40, 1.0, RasterFrame::Corner{}, 0.0};
  raster.height_mm.assign(1600, 5);
  ASSERT_TRUE(write_height_tiff(path("r.tif"), raster));
  const std::string whole = content(path("r.tif"));
  EXPECT_THAT(fault("t.tif", whole.substr(0, 100)), HasSubstr("t.tif"));
  EXPECT_THAT(fault("t.tif", whole.substr(0, 3000)), HasSubstr("is it whole?"));
  EXPECT_THAT(fault("t.tif", "II*"), HasSubstr("no TIFF"));
  EXPECT_THAT(fault("t.tif", "Hello"), HasSubstr("no TIFF"));
  std::string huge = whole;
  huge[20] = '\x7F';  // The high byte of the width.
  huge[21] = '\x7F';
  EXPECT_THAT(fault("t.tif", huge), HasSubstr("cells"));
}

TEST_F(Readers, EveryCutOfATiffIsRefusedOrRead) {
  HeightRaster raster;
  raster.frame = {4, 3, 1.0, RasterFrame::Corner{}, 0.0};
  raster.height_mm.assign(12, 5);
  ASSERT_TRUE(write_height_tiff(path("r.tif"), raster));
  const std::string whole = content(path("r.tif"));
  for (std::size_t size = 1; size < whole.size(); size += 3) {
    EXPECT_FALSE(read_height_tiff(file("t.tif", whole.substr(0, size)))) << size;
  }
}

TEST(Relief, EveryObstacleStandsAboveANeighbour) {
  ClassRaster map;
  map.frame = {40, 30, 1.0, {}, 0.0};
  map.classes.assign(1200, kWall);
  map.classes[0] = kFree;
  const auto relief = relief_of(map);
  ASSERT_TRUE(relief);
  HeightGrid grid = empty_grid({0, 0}, {39, 29}, 1000).value();
  grid.height_mm = relief->raster.height_mm;
  grid.probability.assign(1200, 230);
  EXPECT_EQ(classify(grid, {100, 100, 0.0}), map.classes);
  EXPECT_EQ(relief->lone_obstacles, 0);
}

TEST(Relief, ObstaclesWithoutFreeGroundBesideThemStayUnknown) {
  ClassRaster map;
  map.frame = {5, 1, 1.0, {}, 0.0};
  map.classes = {kFree, kWall, CellClass::unknown, kWall, kWall};
  const auto relief = relief_of(map);
  ASSERT_TRUE(relief);
  EXPECT_THAT(relief->raster.height_mm, ElementsAre(0, kObstacleMm, kUnknown, kUnknown, kUnknown));
  EXPECT_EQ(relief->lone_obstacles, 2);
}

TEST(Kinds, AreToldByTheEnding) {
  EXPECT_EQ(*kind_of("a/b.PGM"), MapFileKind::ros);
  EXPECT_EQ(*kind_of("x.tiff"), MapFileKind::tiff);
  EXPECT_THAT(kind_of("x.jpg").error().message, HasSubstr(".asc"));
  EXPECT_FALSE(read_map_file("/nowhere/x.map"));
  EXPECT_FALSE(read_map_file("x.ply"));
}

}  // namespace
}  // namespace cairn::map_files
