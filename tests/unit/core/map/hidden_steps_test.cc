#include "core/map/hidden_steps.h"

#include <gtest/gtest.h>

#include <string>

namespace cairn {
namespace {

/// Digits are heights in 100 mm, '?' is unknown.
HeightGrid grid_of(const std::vector<std::string>& rows) {
  const auto width = static_cast<std::int32_t>(rows.front().size());
  const auto height = static_cast<std::int32_t>(rows.size());
  HeightGrid grid = empty_grid({0, 0}, {width - 1, height - 1}, 125).value();
  std::size_t at = 0;
  for (const std::string& row : rows) {
    for (const char c : row) {
      if (c != '?') {
        grid.height_mm[at] = (c - '0') * 100;
        grid.probability[at] = 250;
      }
      ++at;
    }
  }
  return grid;
}

/// 'X' where a hidden step was marked.
std::string marked(const std::vector<std::string>& rows) {
  const HeightGrid grid = grid_of(rows);
  std::vector<CellClass> classes(grid.height_mm.size(), CellClass::unknown);
  mark_hidden_steps(grid, {}, classes);
  std::string text;
  for (const CellClass each : classes) text += each == CellClass::obstacle ? 'X' : '.';
  return text;
}

TEST(HiddenSteps, LieBehindTheEdgeOfAKerbSeenFromAbove) {
  EXPECT_EQ(marked({"222???00"}), "...XXX..");
  EXPECT_EQ(marked({"00???222"}), "..XXX...");
  EXPECT_EQ(marked({"2", "2", "?", "?", "0"}), "..XX.");
}

TEST(HiddenSteps, AreNoneBetweenGroundOfOneHeight) {
  EXPECT_EQ(marked({"000???000"}), ".........");
  EXPECT_EQ(marked({"000???111"}), ".........") << "the vehicle climbs 100 mm";
}

TEST(HiddenSteps, AreNoneBeforeAThinWallThatStandsOnUnseenGround) {
  EXPECT_EQ(marked({"00??7???"}), "........");
  EXPECT_EQ(marked({"00??7"}), ".....");
}

TEST(HiddenSteps, LongerUnseenStretchesTellNothing) {
  EXPECT_EQ(marked({"22?????00"}), "..XXXXX..");
  EXPECT_EQ(marked({"22??????00"}), "..........");
}

TEST(HiddenSteps, AGridsRimIsNoGroundBehindAnEdge) {
  EXPECT_EQ(marked({"2??0", "0000"}), "........");
  EXPECT_EQ(marked({"0000", "0??2"}), "........");
}

}  // namespace
}  // namespace cairn
