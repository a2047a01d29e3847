#pragma once

#include <string>

#include "core/common/result.h"
#include "proto/codec/records.h"

namespace cairn::proto {

/// Why the server does not take this robot, and what people can do about it.
[[nodiscard]] Error explain(const Reject& reject, const std::string& robot, const std::string& site,
                            int cell_size_mm);

}  // namespace cairn::proto
