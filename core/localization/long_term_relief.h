#pragma once

#include <cstdint>
#include <vector>

#include "core/localization/match_raster.h"

namespace cairn {

/// How faces that were only seen from the side are told from tops.
struct FaceSearch {
  int near_cells = 6;  ///< The lowest known height so near is the ground,
  int far_cells = 16;  ///< unless there is one within this that is lower by
  int rise_mm = 350;   ///< more than ground rises on the way: then that one.
  int face_mm = 350;   ///< What stands half of this above the ground may be a face.
};

/// The long-term map around the robot with what refinement asks of it.
///
/// A laser meets a wall from the side: the map holds a thin line of cells as high as beams happened
/// to come in, and nothing behind. How far up a face was seen tells nothing of where it is, and
/// what is unknown does not speak against a match, so such a face would slide into the unknown.
/// Near these faces the ground goes on behind them (the line becomes a ridge), and heights are only
/// compared up to `limit_mm`. Tops that were seen stay as they are.
struct LongTermRelief {
  MatchRaster heights;
  std::vector<char> face;            ///< Not 0: here or beside is a face seen from the side.
  std::vector<std::int16_t> ground;  ///< [mm] Under each cell, as `heights`.
  std::vector<std::int16_t> top;     ///< [mm] As from highest_around.
  int face_mm = 0;
  double cell_m = 0.0;

  /// [mm] Up to where heights are compared at a face of which the other map saw `other_top_mm`.
  [[nodiscard]] double limit_mm(int x, int y, double other_top_mm) const;
};

[[nodiscard]] LongTermRelief make_relief(MatchRaster heights, const FaceSearch& search,
                                         double cell_m);

/// The highest known height within two cells of each cell (a square): how far up a face that
/// stands there was seen. Unknown where nothing is.
[[nodiscard]] std::vector<std::int16_t> highest_around(const MatchRaster& raster);

}  // namespace cairn
