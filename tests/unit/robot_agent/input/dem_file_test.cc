#include "robot_agent/input/dem_file.h"

#include <opencv2/imgcodecs.hpp>

#include "robot_agent/input/world.h"
#include "tests/support/data_folder.h"
#include "tests/unit/robot_agent/input/scratch_folder.h"

namespace cairn::agent {
namespace {

class DemFile : public ScratchFolder {
 protected:
  static std::string message(const std::string& name) {
    const auto dem = read_dem(name);
    return dem ? "was accepted" : dem.error().message;
  }
};

TEST_F(DemFile, HasItsFirstRowInTheNorth) {
  const auto dem = read_dem(write("a.csv", "1 2 3\n4,5,6\r\n") + "@0.5");
  ASSERT_TRUE(dem) << dem.error().message;
  EXPECT_EQ(dem->columns(), 3);
  EXPECT_EQ(dem->rows(), 2);
  EXPECT_EQ(dem->at(0, 1), 1.0F);
  EXPECT_EQ(dem->at(2, 0), 6.0F);
  EXPECT_DOUBLE_EQ(dem->west_m(), -0.5);
  EXPECT_DOUBLE_EQ(dem->north_m(), 0.25);
}

TEST_F(DemFile, TakesTheCellSizeFromItsName) {
  EXPECT_DOUBLE_EQ(read_dem(write("Rocks_4cmDEM.csv", "1 2\n3 4\n"))->cell_m(), 0.04);
  EXPECT_DOUBLE_EQ(read_dem(write("Area_1mDEM.csv", "1 2\n3 4\n"))->cell_m(), 1.0);
  EXPECT_DOUBLE_EQ(read_dem(write("x_0.5m.csv", "1 2\n3 4\n"))->cell_m(), 0.5);
  EXPECT_DOUBLE_EQ(read_dem(write("y_10cm.csv", "1 2\n3 4\n") + "@2")->cell_m(), 2.0);
}

TEST_F(DemFile, AsksForTheCellSizeItCannotKnow) {
  EXPECT_NE(message(write("delft_025_ground.csv", "1 2\n3 4\n")).find("@0.25"), std::string::npos);
  EXPECT_NE(message(write("a.csv", "1 2\n3 4\n") + "@-3").find("cell size"), std::string::npos);
}

TEST_F(DemFile, FillsHolesFromTheirNeighbours) {
  const auto dem =
      read_dem(write("a.csv", "1 1 1 1\n1 nan -9999 1\n1 -inf 1e9 1\n1 1 1 1\n") + "@1");
  ASSERT_TRUE(dem) << dem.error().message;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      EXPECT_EQ(dem->at(column, row), 1.0F);
    }
  }
}

TEST_F(DemFile, ReadsTiffsOfFloats) {
  cv::Mat heights = (cv::Mat_<float>(2, 2) << 1.0F, -9999.0F, 3.0F, 4.0F);
  ASSERT_TRUE(cv::imwrite(path("a.tif"), heights));
  const auto dem = read_dem(path("a.tif") + "@0.25");
  ASSERT_TRUE(dem) << dem.error().message;
  EXPECT_EQ(dem->at(0, 1), 1.0F);
  EXPECT_NEAR(dem->at(1, 1), 8.0 / 3.0, 1e-6);
}

TEST_F(DemFile, SaysWhatIsWrongWithABadOne) {
  EXPECT_NE(message(path("none.csv")).find("there is no"), std::string::npos);
  EXPECT_NE(message(write("empty_1m.csv", "")).find("is empty"), std::string::npos);
  EXPECT_NE(message(write("blank_1m.csv", "\n\n")).find("fewer than 2"), std::string::npos);
  EXPECT_NE(message(write("ragged_1m.csv", "1 2\n1 2 3\n")).find("line 2: 3 heights"),
            std::string::npos);
  EXPECT_NE(message(write("word_1m.csv", "1 2\n1 x\n")).find("line 2: \"x\""), std::string::npos);
  EXPECT_NE(message(write("nan_1m.csv", "nan nan\nnan nan\n")).find("no height"),
            std::string::npos);
  EXPECT_NE(message(write("text_1m.tif", "no tiff")).find("not a readable TIFF"),
            std::string::npos);
  ASSERT_TRUE(cv::imwrite(path("bytes_1m.tif"), cv::Mat(3, 3, CV_8UC1, cv::Scalar(1))));
  EXPECT_NE(message(path("bytes_1m.tif")).find("32-bit float"), std::string::npos);
}

TEST_F(DemFile, MakesAWorldThatStartsOnTheFlatAtHeightZero) {
  std::string rows;
  for (int row = 0; row < 60; ++row) {
    for (int column = 0; column < 60; ++column) {
      // Steep in the west, level in the east.
      rows += std::to_string(100.0 + (column < 30 ? 0.3 * (30 - column) : 0.0)) + " ";
    }
    rows += "\n";
  }
  const auto world = make_world("dem:" + write("slope_50cm.csv", rows), 1);
  ASSERT_TRUE(world) << world.error().message;
  EXPECT_GT(world->start.x_m, 0.0);
  EXPECT_NEAR(world->surface.height_m(world->start.x_m, world->start.y_m), 0.0, 1e-4);
}

TEST_F(DemFile, ReadsRealTerrain) {
  const std::string data = test::data_folder().string();
  if (data.empty()) {
    GTEST_SKIP() << "skipped: no folder of real data (set CAIRN_DATA)";
  }
  for (const char* file :
       {"ahn3_delft1_025_ground.tif@0.25", "greenriver.tif@1", "ade_10cm/RH1_Zone1_10cmDEM.csv",
        "ade_10cm/RgDem.p_heightData_m.csv@0.1"}) {
    const auto world = make_world("dem:" + data + "/terrain/" + file, 1);
    ASSERT_TRUE(world) << world.error().message;
  }
}

}  // namespace
}  // namespace cairn::agent
