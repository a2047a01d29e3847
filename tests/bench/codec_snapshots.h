#pragma once

#include "tests/bench/report.h"

namespace cairn::bench {

/// Whole tiles of long-term maps, as links carry them, against zstd. False when a drive fails.
[[nodiscard]] bool measure_snapshots(Report& to);

}  // namespace cairn::bench
