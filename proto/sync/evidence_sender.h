#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "core/common/time.h"
#include "core/delta/block.h"
#include "proto/codec/frame.h"

namespace cairn::proto {

/// The robot's half of evidence synchronisation: owns the submaps that the server does not yet
/// durably hold in full, and knows for each block the newest version, the acknowledged version and
/// what is under way. State, not a log: what is sent is always the newest value of what the peer
/// lacks (design §5.2).
class EvidenceSender {
 public:
  /// [submaps] Hard bound; at it the oldest closed submap is dropped and counted.
  static constexpr std::size_t kMaxSubmaps = 512;

  /// Begins a new submap (sequence one above the last); it becomes the open one. The open one
  /// before it must have been closed. Returns its reference, valid until it is closed.
  Submap& begin(std::uint64_t boot, SubmapPose T_site_submap, int cell_size_mm);
  /// The open submap's cells changed (its surface or seen_through was written by the caller).
  void touch(EvidenceLayer layer, const std::vector<CellIndex>& cells);
  /// The robot will add nothing more to the open submap.
  void close();
  [[nodiscard]] Submap* open_submap();

  /// Adds what the peer lacks most to a frame numbered `number`, oldest submap first; blocks with a
  /// delta already under way at their newest version are not repeated. Returns how many records
  /// were added.
  int fill(FrameWriter& frame, std::uint32_t number);
  void on_acked(std::uint32_t number);
  /// What frame `number` carried must be sent again (in its then newest form).
  void on_lost(std::uint32_t number);
  void on_refused(const Refusal& refusal);
  /// A new session or store epoch: nothing is under way any more; with `forget_acked` nothing
  /// counts as held either.
  void on_session(bool forget_acked);

  [[nodiscard]] bool has_news() const;              ///< `fill` would add something.
  [[nodiscard]] bool synchronised() const;          ///< The peer holds everything.
  [[nodiscard]] std::size_t backlog_blocks() const;  ///< Blocks not acknowledged at their newest.
  [[nodiscard]] std::size_t submaps() const;
  [[nodiscard]] std::uint64_t dropped_submaps() const;

 private:
  struct Outgoing;
  // Filled in by the implementation.
};

}  // namespace cairn::proto
