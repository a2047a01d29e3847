#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/map/height_map.h"

namespace cairn {

/// What two heights may differ by and still be told apart from "one of them is unknown" in 16 bits
/// without a branch: known heights lie within ±kMatchLimitMm of the datum, an unknown cell of a
/// short-term map far below, one of a long-term map far above.
inline constexpr int kMatchLimitMm = 5460;
inline constexpr std::int16_t kUnknownInShort = -16383;
inline constexpr std::int16_t kUnknownInLong = 16383;
/// Differences above this involve an unknown cell.
inline constexpr int kOverlapLimitMm = 2 * kMatchLimitMm;

/// A dense rectangle of a map's heights, ready to be matched.
struct MatchRaster {
  CellIndex lowest;  ///< The map's cell in column 0 of row 0.
  int width = 0;
  int height = 0;
  std::int32_t datum_mm = 0;
  std::int16_t unknown = kUnknownInLong;
  std::vector<std::int16_t> height_mm;  ///< Above the datum, row by row.

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] std::int16_t at(int x, int y) const { return height_mm[index(x, y)]; }
  [[nodiscard]] bool known(int x, int y) const { return at(x, y) != unknown; }
};

/// Corners of the smallest rectangle that holds all known cells of level 0; empty without any.
struct MapBox {
  CellIndex lowest;
  CellIndex highest;
};
[[nodiscard]] std::optional<MapBox> known_box(const HeightMap& map);

/// The cells of a map from `lowest` on. Heights farther than kMatchLimitMm from the datum count as
/// unknown. Requires: width, height > 0.
[[nodiscard]] MatchRaster make_raster(const HeightMap& map, CellIndex lowest, int width, int height,
                                      std::int32_t datum_mm, std::int16_t unknown);

}  // namespace cairn
