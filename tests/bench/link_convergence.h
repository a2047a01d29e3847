#pragma once

#include "tests/bench/report.h"

namespace cairn::bench {

/// Drives a robot round a room under one misfortune after the other and waits until both ends hold
/// the same map: bytes and seconds.
void measure_convergence(Report& report);

}  // namespace cairn::bench
