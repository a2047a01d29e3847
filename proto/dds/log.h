#pragma once

#include <string>

namespace cairn::proto {

/// From now on Cyclone DDS says nothing on stderr in this process; its last complaint is kept for
/// our own message. Calling it again changes nothing. Thread-safe.
void quiet_dds_log();

/// The last complaint on one line, without Cyclone's prefix; empty when there was none.
[[nodiscard]] std::string last_dds_complaint();

}  // namespace cairn::proto
