#pragma once

#include <cstdint>

#include "proto/codec/patch_window.h"

namespace cairn::proto::patch {

/// What the known cells around say about the height of a cell. Heights in quanta.
struct Prediction {
  int count = 0;  ///< Known cells within three cells.
  std::int32_t plane16 =
      0;                    ///< [1/16 quanta] Plane laid through them, the near ones weighing most.
  std::int32_t mean16 = 0;  ///< [1/16 quanta] Their weighted mean …
  std::int32_t even16 = 0;  ///< [1/16 quanta] … and that of them all alike.
  std::int32_t nearest = 0;
  std::int32_t least = 0;  ///< Of those within two cells (the nearest where there is none).
  std::int32_t most = 0;
};

/// Requires: 0 ≤ x, y < kBlockSize. The cell's own value is not looked at.
[[nodiscard]] Prediction predict(const Window& window, int x, int y);

}  // namespace cairn::proto::patch
