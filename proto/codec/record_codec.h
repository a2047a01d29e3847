#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/common/result.h"
#include "proto/codec/frame.h"
#include "proto/codec/records.h"

namespace cairn::proto {

/// [bytes] Type and length before each record's body.
inline constexpr std::size_t kRecordHeaderBytes = 3;

/// Appends type, length and body. Requires: every field within its bounds.
void append_record(std::vector<std::uint8_t>& out, const Record& record);

/// Reads one record's body, all of it; says which field broke which rule.
[[nodiscard]] Result<Record> read_record(std::uint8_t type, std::span<const std::uint8_t> body,
                                         Direction direction);

}  // namespace cairn::proto
