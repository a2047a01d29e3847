#pragma once

#include <vector>

#include "core/planner/line_cost.h"

namespace cairn {

/// Pulls a path taut: replaces stretches of it by straight lines, and cuts its corners, wherever
/// that can be driven and costs less. Never longer in cost than what it was given.
[[nodiscard]] std::vector<Eigen::Vector2d> tighten(const LineCost& lines,
                                                   std::vector<Eigen::Vector2d> points_m);

/// [cost units, levelled] Of a whole path.
[[nodiscard]] double cost_along(const LineCost& lines,
                                const std::vector<Eigen::Vector2d>& points_m);

}  // namespace cairn
