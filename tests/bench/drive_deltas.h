#pragma once

#include <vector>

#include "core/common/result.h"
#include "core/map/height_map.h"
#include "proto/codec/patch_view.h"
#include "proto/codec/records.h"
#include "tests/bench/drive_about.h"

namespace cairn::bench {

/// What changed in the map within one cadence, ready to be told.
using Delta = std::vector<proto::BlockUpdate>;

struct Drive {
  std::vector<Delta> deltas;            ///< Those that hold something …
  std::vector<proto::Viewpoint> views;  ///< … and where each was told.
  HeightMap exact{125};                 ///< The map as its rules made it …
  HeightMap told{125};                  ///< … and as it was told.
  double way_m = 0.0;
};

/// Drives a simulated robot with two lasers about at 1 m/s and maps from its true poses.
[[nodiscard]] Result<Drive> drive_deltas(const DriveSetting& setting);

}  // namespace cairn::bench
