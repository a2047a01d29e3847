#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "client/cli/connection.h"
#include "client/cli/map_raster.h"
#include "core/common/result.h"
#include "proto/json/messages.h"

namespace cairn::cli {

struct PictureOptions {
  int scale = 0;                     ///< Pixels per cell; 0: so that the picture fits a screen.
  std::vector<api::PointJson> path;  ///< Drawn besides those of the robots' commands.
  std::optional<api::PointJson> goal;
};

/// How the site lies in the picture.
struct PictureLayout {
  CellWindow window;
  double cell_m = 0.125;
  int cells_per_pixel = 1;
  int pixels_per_cell = 1;  ///< One of the two is 1.
  cv::Rect panel;           ///< Where the map is; around it are scales and legend.
  cv::Size page;
  double unit = 1.0;  ///< Size of text and lines.

  /// Pixels of a place, relative to the panel.
  [[nodiscard]] cv::Point2d in_panel(double x_m, double y_m) const;
  [[nodiscard]] double pixel_m() const { return cell_m * cells_per_pixel / pixels_per_cell; }
};

/// [pixels] Larger pictures are drawn at a smaller scale.
inline constexpr std::int64_t kMaxPicturePixels = 64'000'000;

/// The window is the known ground with robots, path and goal, where these are not far off.
[[nodiscard]] PictureLayout lay_out(const SiteMap& map, const PictureOptions& options);

/// Draws a site: relief, obstacles, what is unknown, tracks, paths, goals, robots; with a
/// coordinate grid, scale bar, north arrow and legend.
[[nodiscard]] Result<cv::Mat3b> draw_map(const SiteMap& map, const PictureOptions& options);

[[nodiscard]] Status write_png(const cv::Mat3b& picture, const std::string& file);

}  // namespace cairn::cli
