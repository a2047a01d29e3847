#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/common/result.h"
#include "core/delta/coarseness.h"
#include "proto/sync/evidence_sender.h"

/// The bytes of one spooled submap (FORMAT.md).
namespace cairn::agent {

/// Whose evidence a spool holds. A file of another owner is not delivered.
struct SpoolOwner {
  std::string robot;
  std::string site;
  int cell_size_mm = 125;
};

/// Requires: names (text.h), a cell size of 10 … 2000 mm, blocks as of EvidenceSender::copy_of.
/// Costs about as much as sending the submap would: 1–3 µs per cell.
[[nodiscard]] std::vector<std::uint8_t> write_kept(const proto::KeptSubmap& kept,
                                                   const SpoolOwner& owner,
                                                   const Coarseness& coarseness);

/// corrupt: damaged; unsupported_version: of the format; conflict: of another owner. The message
/// says what to do.
[[nodiscard]] Result<proto::KeptSubmap> read_kept(std::span<const std::uint8_t> bytes,
                                                  const SpoolOwner& owner);

/// Without its layer seen through. Returns whether there was one.
bool thin(proto::KeptSubmap& kept);

}  // namespace cairn::agent
