#pragma once

#include "client/cli/canvas.h"
#include "client/cli/map_picture.h"

namespace cairn::cli {

// Blue, green, red.
inline const cv::Scalar kTrackColour{122, 96, 20};
inline const cv::Scalar kPathColour{226, 92, 24};
inline const cv::Scalar kGoalColour{226, 92, 24};
inline const cv::Scalar kRobotColour{20, 176, 252};
inline const cv::Scalar kWhite{255, 255, 255};
inline const cv::Scalar kInk{48, 42, 38};

/// Tracks, planned paths, goals and robots. `panel` is the map alone.
void draw_motion(Canvas& panel, const PictureLayout& layout, const SiteMap& map,
                 const PictureOptions& options);

// The symbols, also for the legend.
void draw_track(Canvas& canvas, std::span<const cv::Point2d> points);
void draw_path(Canvas& canvas, std::span<const cv::Point2d> points);
void draw_goal(Canvas& canvas, cv::Point2d at);
/// An arrow towards `yaw_rad` (0 = east, counter-clockwise).
void draw_robot(Canvas& canvas, cv::Point2d at, double yaw_rad);

}  // namespace cairn::cli
