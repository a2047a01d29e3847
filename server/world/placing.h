#pragma once

#include "core/graph/level_pose.h"
#include "core/map/submap.h"

namespace cairn::server {

/// Integers as on disk and wire ↔ metres and radians.
[[nodiscard]] LevelPose to_level(const SubmapPose& pose);
/// Coordinates are cut at the bound of the wire.
[[nodiscard]] SubmapPose to_submap_pose(const LevelPose& pose);

}  // namespace cairn::server
