#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/map/height_map.h"

namespace cairn {

/// [units] In whole-site search no height is farther than this from the site's datum; a cell of
/// which nothing is known has its lowest height above its highest.
inline constexpr std::int16_t kFarthestHeight = 8000;
inline constexpr std::int16_t kNoHeight = 12000;

/// What a cell, or any one of a block of cells, may hold.
struct HeightSpan {
  std::int16_t lowest = kNoHeight;    ///< [units]
  std::int16_t highest = -kNoHeight;  ///< [units]
  std::int16_t most = 0;              ///< [units] A difference counts at most this much.
};

/// The heights at which a robot may stand in a cell, or anywhere in a block of cells.
struct FloorSpan {
  std::int16_t lowest = kNoHeight;    ///< [units]
  std::int16_t highest = -kNoHeight;  ///< [units]
  [[nodiscard]] bool any() const { return lowest <= highest; }
  friend bool operator==(const FloorSpan&, const FloorSpan&) = default;
};

/// A row-by-row rectangle of something.
template <class T>
struct SiteGrid {
  int width = 0;
  int height = 0;
  std::vector<T> cells;

  SiteGrid() = default;
  SiteGrid(int w, int h, T value = {})
      : width(w),
        height(h),
        cells(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value) {}

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] const T& at(int x, int y) const { return cells[index(x, y)]; }
  [[nodiscard]] T& at(int x, int y) { return cells[index(x, y)]; }
};

/// How the long-term map is read for whole-site search.
struct SiteGroundConfig {
  int truncate_mm = 500;  ///< [mm] A height difference counts at most this much.
  int unknown_mm = 50;    ///< [mm] A cell that the long-term map does not know counts this much.
  int face_mm = 300;      ///< [mm] What stands higher above its ground than this is a face.
  /// [mm] A laser meets a face at whatever height its beam comes in: so far above what is stored,
  int above_face_mm = 300;
  int below_lone_mm = 600;  ///< [mm] and below, where no ground was seen beside it.
  int floor_mm = 150;       ///< [mm] A robot stands on what is not higher above its ground.
  double ground_reach_m = 0.75;
  double floor_reach_m = 0.375;     ///< [m] The robot's foot lies within the heights so near,
  double far_floor_reach_m = 1.25;  ///< [m] or within those so near where these are unknown.
};

/// A long-term map as spans of heights, with `margin` unknown cells all around: heights in units
/// above a datum.
struct SiteGround {
  CellIndex lowest;  ///< The map's cell in column 0 of row 0.
  int margin = 0;    ///< [cells] No robot stands this near to the rectangle's edge.
  int unit_mm = 4;
  std::int32_t datum_mm = 0;
  std::int16_t truncate = 0;    ///< [units]
  std::int16_t above_face = 0;  ///< [units] A face's span ends so far above what is stored.
  SiteGrid<HeightSpan> heights;
  SiteGrid<FloorSpan> floor;
};

/// Part of a site.
struct SiteDisc {
  double x_m = 0.0;
  double y_m = 0.0;
  double radius_m = 0.0;
};

/// [cells] Largest side of what is searched at once.
inline constexpr int kMaxSiteCells = 2048;

/// Reads level 0 of a map. With `disc` only where a robot in it can stand and see. Empty, with the
/// reason in `why`, where there is nothing, or too much.
[[nodiscard]] std::optional<SiteGround> read_site_ground(const HeightMap& map, int margin,
                                                         const std::optional<SiteDisc>& disc,
                                                         const SiteGroundConfig& config,
                                                         std::string& why);

}  // namespace cairn
