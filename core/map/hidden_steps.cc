#include "core/map/hidden_steps.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <utility>

namespace cairn {
namespace {

class HiddenSteps {
 public:
  HiddenSteps(const HeightGrid& grid, const VehicleLimits& limits, std::vector<CellClass>& classes)
      : grid_(grid),
        step_mm_(std::min(limits.climb_mm, limits.descend_mm)),
        width_(static_cast<std::size_t>(grid.width)),
        classes_(classes),
        above_(width_, kNone) {}

  void mark() {
    const auto height = static_cast<std::size_t>(grid_.height);
    for (std::size_t y = 0; y < height; ++y) mark_row(y, height);
  }

 private:
  static constexpr std::size_t kNone = ~std::size_t{0};

  /// The row, and every column down to it.
  void mark_row(std::size_t y, std::size_t height) {
    const std::size_t row = y * width_;
    std::size_t left = kNone;
    for (std::size_t at = row; at < row + width_; ++at) {
      if (grid_.probability[at] == 0) continue;
      const std::size_t x = at - row;
      if (left != at - 1) mark_between(left, at, 1, {left - row, width_ - 1 - x});
      left = at;
      const std::size_t above = std::exchange(above_[x], at);
      if (above != at - width_) mark_between(above, at, width_, {above / width_, height - 1 - y});
    }
  }

  /// `room`: cells before `from` and after `to` along the line.
  struct Room {
    std::size_t before = 0;
    std::size_t after = 0;
  };
  void mark_between(std::size_t from, std::size_t to, std::size_t stride, const Room& room) {
    if (from == kNone || to - from > (kHiddenStepCells + 1) * stride) return;
    if (std::abs(rise_mm(from, to)) <= step_mm_) return;
    const bool down = rise_mm(from, to) < 0;
    if (down ? room.before == 0 : room.after == 0) return;
    const std::size_t edge = down ? from : to;
    const std::size_t behind = down ? from - stride : to + stride;
    if (grid_.probability[behind] == 0 || std::abs(rise_mm(edge, behind)) > step_mm_) return;
    for (std::size_t at = from + stride; at < to; at += stride) classes_[at] = CellClass::obstacle;
  }
  [[nodiscard]] std::int64_t rise_mm(std::size_t from, std::size_t to) const {
    return std::int64_t{grid_.height_mm[to]} - grid_.height_mm[from];
  }

  const HeightGrid& grid_;
  std::int32_t step_mm_;
  std::size_t width_;
  std::vector<CellClass>& classes_;
  std::vector<std::size_t> above_;  ///< The last known cell of each column.
};

}  // namespace

void mark_hidden_steps(const HeightGrid& grid, const VehicleLimits& limits,
                       std::vector<CellClass>& classes) {
  assert(classes.size() == grid.probability.size());
  HiddenSteps(grid, limits, classes).mark();
}

}  // namespace cairn
