#include "client/cli/map_picture.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "client/cli/map_relief.h"
#include "core/map/height_map.h"

namespace cairn::cli {
namespace {

/// A square of level ground around the origin with a wall of 1 m at x = 2 m and a hole at (-2, -2).
SiteMap square(double side_m, int cell_size_mm = 125) {
  HeightMap map(cell_size_mm);
  const auto half = static_cast<std::int32_t>(side_m * 500.0 / cell_size_mm);
  const auto wall = map.cell_at(2.0, 0.0).x;
  for (std::int32_t y = -half; y < half; ++y) {
    for (std::int32_t x = -half; x < half; ++x) {
      const bool hole =
          std::abs(map.centre_m(x) + 2.0) < 0.6 && std::abs(map.centre_m(y) + 2.0) < 0.6;
      if (!hole) map.set({x, y}, {x == wall ? 1000 : 0, 200});
    }
  }
  SiteMap site;
  site.head.site = "square";
  site.head.cell_size_mm = cell_size_mm;
  site.head.climb_mm = site.head.descend_mm = 100;
  for (const auto& [key, tile] : map.tiles()) site.tiles.emplace_back(key, *tile);
  return site;
}

cv::Vec3b pixel(const SiteMap& map, const cv::Mat3b& picture, double x_m, double y_m) {
  const auto layout = lay_out(map, {});
  const auto at = layout.in_panel(x_m, y_m);
  return picture(layout.panel.y + static_cast<int>(at.y), layout.panel.x + static_cast<int>(at.x));
}

bool is_unknown(const cv::Vec3b& colour) {
  return colour == kUnknownColour || colour == kUnknownHatch;
}

TEST(MapPicture, ShowsObstaclesGroundAndUnknownWhereTheyAre) {
  const auto map = square(13.0);
  const auto picture = draw_map(map, {});
  ASSERT_TRUE(picture);
  EXPECT_EQ(pixel(map, *picture, 2.06, 1.3), kObstacleColour);
  EXPECT_TRUE(is_unknown(pixel(map, *picture, -2.2, -2.2)));
  const auto ground = pixel(map, *picture, -1.2, 1.3);
  EXPECT_FALSE(is_unknown(ground) || ground == kObstacleColour);
}

TEST(MapPicture, FitsAScreenForRoomsAndForLargeSites) {
  for (const double side_m : {1.0, 13.0, 300.0}) {
    const auto layout = lay_out(square(side_m), {});
    EXPECT_GE(layout.page.width, 800) << side_m;
    EXPECT_LE(layout.page.width, 2000) << side_m;
    EXPECT_LE(layout.page.height, 2000) << side_m;
  }
}

TEST(MapPicture, KeepsAnObstacleWhenManyCellsShareAPixel) {
  const auto map = square(300.0);
  ASSERT_GT(lay_out(map, {}).cells_per_pixel, 1);
  const auto picture = draw_map(map, {});
  ASSERT_TRUE(picture);
  EXPECT_EQ(pixel(map, *picture, 2.06, 31.0), kObstacleColour);
}

TEST(MapPicture, StaysWithinItsPixelsWhateverTheScale) {
  const auto layout = lay_out(square(100.0), {.scale = 64, .path = {}, .goal = {}});
  EXPECT_LE(std::int64_t{layout.page.width} * layout.page.height, kMaxPicturePixels);
}

TEST(MapPicture, IsDrawnForASiteWithoutAMap) {
  SiteMap map;
  map.head.site = "new";
  map.head.cell_size_mm = 125;
  const auto picture = draw_map(map, {});
  ASSERT_TRUE(picture);
  EXPECT_GE(picture->cols, 800);
}

TEST(MapPicture, IsNotShrunkByATileAtTheEndOfTheWorldOrARobotThere) {
  auto map = square(13.0);
  api::RobotJson robot;
  robot.id = "far";
  robot.x_m = 99'000.0;
  map.head.robots.push_back(robot);
  EXPECT_LT(lay_out(map, {}).pixel_m(), 0.1);
}

TEST(MapPicture, SaysWhenTheFileCannotBeWritten) {
  const auto written = write_png(cv::Mat3b(4, 4), "/no/such/folder/map.png");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::io);
}

}  // namespace
}  // namespace cairn::cli
