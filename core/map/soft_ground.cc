#include "core/map/soft_ground.h"

#include <algorithm>
#include <cmath>

namespace cairn {
namespace {

/// The last rows read, with unknown cells and what lies outside told apart, and a margin.
class RowWindow {
 public:
  RowWindow(const HeightGrid& grid, int reach)
      : grid_(grid), margin_(reach), rows_(static_cast<std::size_t>(2 * reach + 1)) {
    const auto length =
        static_cast<std::size_t>(grid.width) + 2 * static_cast<std::size_t>(margin_);
    for (auto& row : rows_) row.assign(length, SoftRow::kNoHeight);
    outside_.assign(length, SoftRow::kNoHeight);
  }

  void read(int y) {
    if (y >= grid_.height) return;
    const std::size_t from = static_cast<std::size_t>(y) * static_cast<std::size_t>(grid_.width);
    const std::int32_t* height = grid_.height_mm.data() + from;
    const std::uint8_t* probability = grid_.probability.data() + from;
    std::int32_t* row = rows_[slot(y)].data() + margin_;
    for (int x = 0; x < grid_.width; ++x) {
      row[x] = probability[x] != 0 ? height[x] : SoftRow::kNoHeight;
    }
  }
  [[nodiscard]] const std::int32_t* row(int y) const {
    const bool inside = y >= 0 && y < grid_.height;
    return (inside ? rows_[slot(y)].data() : outside_.data()) + margin_;
  }

 private:
  [[nodiscard]] std::size_t slot(int y) const { return static_cast<std::size_t>(y) % rows_.size(); }

  const HeightGrid& grid_;
  int margin_;
  std::vector<std::vector<std::int32_t>> rows_;
  std::vector<std::int32_t> outside_;
};

int half_wheel_base(const HeightGrid& grid, const SoftLimits& soft) {
  const double cells = soft.wheel_base_m * 500 / grid.cell_size_mm;
  return std::clamp(static_cast<int>(std::lround(cells)), 1, 64);
}

}  // namespace

void assess(const HeightGrid& grid, const VehicleLimits& limits, const SoftLimits& soft,
            SoftGround& ground, const SoftKernels& kernels) {
  const std::size_t cells = grid.height_mm.size();
  ground.obstacle.resize(cells);
  ground.roughness_mm.resize(cells);
  ground.slope_percent.resize(cells);
  const int reach = half_wheel_base(grid, soft);
  RowWindow window(grid, reach);
  for (int y = 0; y < reach; ++y) window.read(y);
  for (int y = 0; y < grid.height; ++y) {
    window.read(y + reach);
    const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.width);
    kernels.row(
        {window.row(y - 1), window.row(y), window.row(y + 1), window.row(y - reach),
         window.row(y + reach), grid.probability.data() + at, grid.width, reach,
         std::max({limits.climb_mm, limits.descend_mm, 0}), static_cast<float>(soft.sigma_mm),
         static_cast<std::int32_t>(std::lround(409600.0 / (2.0 * reach * grid.cell_size_mm))),
         ground.obstacle.data() + at, ground.roughness_mm.data() + at,
         ground.slope_percent.data() + at});
  }
}

}  // namespace cairn
