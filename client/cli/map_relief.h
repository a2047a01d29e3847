#pragma once

#include <opencv2/core.hpp>

#include "client/cli/map_raster.h"

namespace cairn::cli {

/// Colours as OpenCV has them: blue, green, red.
inline const cv::Vec3b kObstacleColour{48, 38, 158};
inline const cv::Vec3b kUnknownColour{222, 220, 218};
inline const cv::Vec3b kUnknownHatch{212, 209, 207};

/// The heights that the tint's ends stand for.
struct HeightRange {
  float low_m = 0.0F;
  float high_m = 0.0F;
};

/// From the 2nd to the 98th percentile of the drivable ground, at least kMinTintSpanM wide so that
/// a flat floor stays of one colour.
[[nodiscard]] HeightRange tint_range(const MapRaster& raster);
inline constexpr float kMinTintSpanM = 2.0F;

/// Tint of a height: sage (low), cream, tan, grey brown (high).
[[nodiscard]] cv::Vec3b tint(float height_m, const HeightRange& range);

/// The raster as shaded relief, lit from the north-west, `scale` × `scale` pixels for each of its
/// own.
[[nodiscard]] cv::Mat3b draw_relief(const MapRaster& raster, const HeightRange& range, int scale);

}  // namespace cairn::cli
