#include "core/map/split_steps.h"

#include <algorithm>
#include <array>
#include <optional>

namespace cairn {
namespace {

constexpr int kApart = 2;
/// Whole stretches of a row without a candidate are passed over.
constexpr int kStretch = 64;
/// [mm] Stands for "nothing known here", above whatever is known, and far enough from the ends of
/// the integers for a difference.
constexpr std::int32_t kNone = 1 << 30;
constexpr std::int32_t kHighest = 1 << 29;

struct Way {
  int x, y;
};
constexpr std::array<Way, 8> kWays{
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

/// The rows around one, with kApart cells more on either side.
class Rows {
 public:
  explicit Rows(const HeightGrid& grid) : grid_(grid) {
    for (auto& row : rows_) row.assign(static_cast<std::size_t>(grid.width) + 2 * kApart, kNone);
  }

  void read(int y) {
    std::int32_t* row = rows_[slot(y)].data() + kApart;
    if (y >= grid_.height) {
      std::fill(row, row + grid_.width, kNone);
      return;
    }
    const std::size_t from = static_cast<std::size_t>(y) * static_cast<std::size_t>(grid_.width);
    const std::int32_t* height = grid_.height_mm.data() + from;
    const std::uint8_t* probability = grid_.probability.data() + from;
    for (int x = 0; x < grid_.width; ++x) {
      row[x] = probability[x] != 0 ? std::clamp(height[x], -kHighest, kHighest) : kNone;
    }
  }
  /// Requires: at most kApart rows from the last that was read, as yet not read over.
  [[nodiscard]] const std::int32_t* row(int y) const { return rows_[slot(y)].data() + kApart; }

 private:
  static constexpr int kRows = 2 * kApart + 1;
  [[nodiscard]] static std::size_t slot(int y) {
    return static_cast<std::size_t>((y + kRows) % kRows);
  }

  const HeightGrid& grid_;
  std::array<std::vector<std::int32_t>, kRows> rows_;
};

/// Whether some cell of a stretch falls by more than the limit over two cells.
bool any_candidate(const std::int32_t* below, const std::int32_t* own, const std::int32_t* above,
                   int from, int to, std::int32_t limit_mm) {
  int found = 0;
  for (int x = from; x < to; ++x) {
    const auto lowest = [&](const std::int32_t* row) {
      return std::min({row[x - kApart], row[x], row[x + kApart]});
    };
    const std::int32_t drop_mm = own[x] - std::min({lowest(below), lowest(own), lowest(above)});
    found |= static_cast<int>(drop_mm > limit_mm) & static_cast<int>(own[x] != kNone);
  }
  return found != 0;
}

class SplitSteps {
 public:
  SplitSteps(const HeightGrid& grid, std::int32_t limit_mm, std::vector<CellClass>& classes)
      : grid_(grid), limit_mm_(limit_mm), classes_(classes) {}

  void mark_from(int x, int y) {
    const auto top = height(x, y);
    if (!top) return;
    for (const Way way : kWays) {
      const auto bottom = height(x + kApart * way.x, y + kApart * way.y);
      const auto between = height(x + way.x, y + way.y);
      if (!bottom || !between || *top - *bottom <= limit_mm_) continue;
      // A half beyond the limit is a step of its own.
      if (*top - *between > limit_mm_ || *between - *bottom > limit_mm_) continue;
      const std::int64_t level = (*top - *bottom) / 4;
      const auto before = height(x - way.x, y - way.y);
      const auto beyond = height(x + (kApart + 1) * way.x, y + (kApart + 1) * way.y);
      if (before && *before - *top >= level) continue;
      if (beyond && *bottom - *beyond >= level) continue;
      classes_[at(x, y)] = CellClass::obstacle;
      if (*between - *bottom > level) {
        classes_[at(x + way.x, y + way.y)] = CellClass::obstacle;
      }
    }
  }

 private:
  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(grid_.width) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] std::optional<std::int64_t> height(int x, int y) const {
    if (x < 0 || y < 0 || x >= grid_.width || y >= grid_.height) return std::nullopt;
    if (grid_.probability[at(x, y)] == 0) return std::nullopt;
    return grid_.height_mm[at(x, y)];
  }

  const HeightGrid& grid_;
  std::int64_t limit_mm_;
  std::vector<CellClass>& classes_;
};

}  // namespace

void mark_split_steps(const HeightGrid& grid, std::int32_t limit_mm,
                      std::vector<CellClass>& classes) {
  SplitSteps steps(grid, limit_mm, classes);
  Rows rows(grid);
  for (int y = 0; y < kApart; ++y) rows.read(y);
  for (int y = 0; y < grid.height; ++y) {
    rows.read(y + kApart);
    for (int from = 0; from < grid.width; from += kStretch) {
      const int to = std::min(from + kStretch, grid.width);
      if (!any_candidate(rows.row(y - kApart), rows.row(y), rows.row(y + kApart), from, to,
                         std::min(limit_mm, kHighest))) {
        continue;
      }
      for (int x = from; x < to; ++x) steps.mark_from(x, y);
    }
  }
}

}  // namespace cairn
