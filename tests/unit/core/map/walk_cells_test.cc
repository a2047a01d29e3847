#include "core/map/walk_cells.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <utility>
#include <vector>

namespace cairn {
namespace {

struct Segment {
  double x0, y0, x1, y1;
};

struct Visit {
  CellIndex cell;
  double t;
};

std::vector<Visit> walk(const Segment& s, double cell_m = 1.0) {
  std::vector<Visit> visits;
  walk_cells(s.x0, s.y0, s.x1, s.y1, cell_m, [&](CellIndex cell, double t) {
    visits.push_back({cell, t});
  });
  return visits;
}

std::vector<CellIndex> cells(const std::vector<Visit>& visits) {
  std::vector<CellIndex> result;
  for (const Visit& visit : visits) result.push_back(visit.cell);
  return result;
}

using Stay = std::pair<double, double>;

/// When the segment is inside a cell, by clipping it against the cell's four sides.
Stay clip(const Segment& s, CellIndex cell, double cell_m) {
  Stay stay{0.0, 1.0};
  const auto side = [&](double from, double to, double low, double high) {
    if (from == to) {
      if (from < low || from >= high) stay = {1.0, 0.0};
      return;
    }
    const double a = (low - from) / (to - from);
    const double b = (high - from) / (to - from);
    stay.first = std::max(stay.first, std::min(a, b));
    stay.second = std::min(stay.second, std::max(a, b));
  };
  side(s.x0, s.x1, cell.x * cell_m, (cell.x + 1) * cell_m);
  side(s.y0, s.y1, cell.y * cell_m, (cell.y + 1) * cell_m);
  return stay;
}

TEST(WalkCells, VisitsTheOneCellOfAPoint) {
  EXPECT_EQ(cells(walk({0.5, 0.5, 0.5, 0.5})), (std::vector<CellIndex>{{0, 0}}));
}

TEST(WalkCells, GoesStraightAlongARow) {
  const std::vector<Visit> visits = walk({0.5, 0.5, 3.5, 0.5});
  EXPECT_EQ(cells(visits), (std::vector<CellIndex>{{0, 0}, {1, 0}, {2, 0}, {3, 0}}));
  EXPECT_NEAR(visits[0].t, 0.5 * (0.5 / 3), 1e-12);
  EXPECT_NEAR(visits[1].t, 1.0 / 3, 1e-12);
}

TEST(WalkCells, GoesBackwardDownAColumnAcrossTheOrigin) {
  EXPECT_EQ(cells(walk({0.5, 1.5, 0.5, -1.5})),
            (std::vector<CellIndex>{{0, 1}, {0, 0}, {0, -1}, {0, -2}}));
}

TEST(WalkCells, EndsWhereTheSegmentEndsEvenOnABoundary) {
  EXPECT_EQ(cells(walk({0.5, 0.5, 2.0, 0.5})).back(), (CellIndex{2, 0}));
  EXPECT_EQ(cells(walk({2.5, 0.5, 1.0, 0.5})).back(), (CellIndex{1, 0}));
}

TEST(WalkCells, SurvivesSegmentsOfAlmostNoLength) {
  const double tiny = 5e-324;
  EXPECT_EQ(cells(walk({0.0, 0.5, -tiny, 0.5})), (std::vector<CellIndex>{{0, 0}, {-1, 0}}));
  EXPECT_EQ(cells(walk({-tiny, 0.5, 0.0, 0.5})), (std::vector<CellIndex>{{-1, 0}, {0, 0}}));
}

TEST(WalkCells, NoWalkIsLongerThanTheBound) {
  EXPECT_EQ(walk({0.5, 0.5, 50'000.5, 0.5}).size(), std::size_t{kMaxBeamCells});
}

/// Each visited cell is crossed when it says, each crossed cell is visited.
void expect_as_clipped(const Segment& s, double cell_m) {
  const std::vector<Visit> visits = walk(s, cell_m);
  std::map<std::pair<int, int>, int> seen;
  double stayed = 0.0;
  for (std::size_t i = 0; i < visits.size(); ++i) {
    const auto& [cell, t] = visits[i];
    ++seen[{cell.x, cell.y}];
    const Stay stay = clip(s, cell, cell_m);
    EXPECT_NEAR(t, 0.5 * (stay.first + stay.second), 1e-9);
    stayed += stay.second - stay.first;
    if (i == 0) continue;
    const CellIndex last = visits[i - 1].cell;
    EXPECT_EQ(std::abs(cell.x - last.x) + std::abs(cell.y - last.y), 1) << "cells share a side";
    EXPECT_GE(t, visits[i - 1].t);
  }
  EXPECT_NEAR(stayed, 1.0, 1e-9) << "no crossed cell is missing";
  for (const auto& [cell, times] : seen) EXPECT_EQ(times, 1);
}

TEST(WalkCells, AgreesWithClippingOnRandomSegments) {
  const unsigned seed = std::random_device{}();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> metres(-20.0, 20.0);
  for (int i = 0; i < 2000; ++i) {
    const Segment s{metres(random), metres(random), metres(random), metres(random)};
    expect_as_clipped(s, i % 2 == 0 ? 0.125 : 0.3);
    ASSERT_FALSE(HasFailure()) << "seed " << seed << " case " << i << ": " << s.x0 << ' ' << s.y0
                               << " to " << s.x1 << ' ' << s.y1;
  }
}

TEST(WalkCells, AgreesWithClippingOnSegmentsBetweenCornersAndSides) {
  constexpr unsigned kSeed = 11;
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<int> half_cells(-12, 12);
  for (int i = 0; i < 2000; ++i) {
    const Segment s{0.5 * half_cells(random), 0.5 * half_cells(random), 0.5 * half_cells(random),
                    0.5 * half_cells(random)};
    const std::vector<Visit> visits = walk(s);
    double last = 0.0;
    for (const auto& [cell, t] : visits) {
      EXPECT_GE(t, last);
      last = t;
      const Stay stay = clip(s, cell, 1.0);
      const bool touches = s.x0 == s.x1 || s.y0 == s.y1 || stay.second - stay.first > -1e-9;
      EXPECT_TRUE(touches) << "seed " << kSeed << " case " << i;
    }
    EXPECT_LE(last, 1.0);
    ASSERT_FALSE(HasFailure()) << "seed " << kSeed << " case " << i;
  }
}

}  // namespace
}  // namespace cairn
