#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "client/cli/connection.h"
#include "core/map/traversability.h"

namespace cairn::cli {

/// Cells from `lowest` to `highest`, both included; empty when nothing was added.
struct CellWindow {
  CellIndex lowest{std::numeric_limits<std::int32_t>::max(),
                   std::numeric_limits<std::int32_t>::max()};
  CellIndex highest{std::numeric_limits<std::int32_t>::min(),
                    std::numeric_limits<std::int32_t>::min()};

  [[nodiscard]] bool empty() const { return highest.x < lowest.x; }
  [[nodiscard]] std::int64_t width() const { return std::int64_t{highest.x} - lowest.x + 1; }
  [[nodiscard]] std::int64_t height() const { return std::int64_t{highest.y} - lowest.y + 1; }
  void add(CellIndex cell);
};

/// The smallest window with all known cells of the ground level.
[[nodiscard]] CellWindow known_window(const SiteMap& map);

/// The ground level of a map, `cells_per_pixel`² cells to a pixel, row by row from the north-west.
/// A pixel is an obstacle when one of its cells is, else known when one of them is; its height is
/// the mean of its known cells.
struct MapRaster {
  int width = 0;
  int height = 0;
  int cells_per_pixel = 1;
  std::vector<CellClass> classes;
  std::vector<float> height_m;  ///< 0 where unknown.

  [[nodiscard]] std::size_t at(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(column);
  }
  [[nodiscard]] bool known(int column, int row) const {
    return column >= 0 && row >= 0 && column < width && row < height &&
           classes[at(column, row)] != CellClass::unknown;
  }
};

/// Requires: a window that is not empty, cells_per_pixel ≥ 1. Works tile by tile, so that memory
/// goes with the picture and not with the site.
[[nodiscard]] MapRaster rasterize(const SiteMap& map, const CellWindow& window,
                                  int cells_per_pixel);

}  // namespace cairn::cli
