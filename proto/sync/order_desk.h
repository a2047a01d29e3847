#pragma once

#include <bitset>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "proto/codec/records.h"

namespace cairn::proto {

/// A command that is new or has a new revision, with its whole path (all parts arrived).
struct Order {
  Command command;
  std::vector<PathPart::Point> path;
};

/// The robot's desk for commands: puts the parts of a path together in whatever order they come and
/// hands each (command, revision) out once. Only the newest is kept; older ones are superseded.
class OrderDesk {
 public:
  using Key = std::pair<std::uint64_t, std::uint32_t>;  ///< Command, revision.
  struct Outcome {
    std::optional<Order> order;     ///< Now complete.
    std::optional<Key> superseded;  ///< A newer command came before it.
    /// Handed out before: the server has not heard what became of it.
    std::optional<Key> asked_again;
  };
  Outcome on_command(const Command& command);
  Outcome on_part(const PathPart& part);
  /// Another store counts its commands anew.
  void forget();

 private:
  void begin_if_newer(const Key& key);
  Outcome hand_out_if_complete();
  [[nodiscard]] bool complete() const;

  Key newest_{};
  std::optional<Command> command_;
  std::vector<PathPart::Point> points_;  ///< [Limit: ≤ kMaxPathPoints]
  std::bitset<kMaxPathPoints> have_;
  bool handed_out_ = false;
};

}  // namespace cairn::proto
