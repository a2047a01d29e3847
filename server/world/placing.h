#pragma once

#include "core/graph/level_pose.h"
#include "core/map/submap.h"

namespace cairn::server {

/// Integers as on disk and wire ↔ metres and radians.
[[nodiscard]] LevelPose to_level(const SubmapPose& pose);
/// Coordinates are cut at the bound of the wire.
[[nodiscard]] SubmapPose to_submap_pose(const LevelPose& pose);

/// Submaps move only when one of them would by this much, about a quarter of a cell: each move
/// folds tiles anew and travels to robots.
constexpr double kWorthMovingM = 0.03;
constexpr double kWorthMovingRad = 0.003;
[[nodiscard]] bool worth_moving(const SubmapPose& from, const SubmapPose& to);

}  // namespace cairn::server
