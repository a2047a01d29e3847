#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "proto/codec/records.h"

namespace cairn::proto {

/// A command that is new or has a new revision, with its whole path (all parts arrived).
struct Order {
  Command command;
  std::vector<std::uint8_t> path;  ///< Coded; nobody has looked at it yet.
};

/// The robot's desk for commands: puts the parts of a path together in whatever order they come and
/// hands each (command, revision) out once. Only the newest is kept; older ones are superseded.
/// Corridors that come before their order wait for it.
class OrderDesk {
 public:
  /// [records] Of corridor that wait; more are dropped, the robot asks when it needs them.
  static constexpr std::size_t kMaxCorridors = 8;

  using Key = std::pair<std::uint64_t, std::uint32_t>;  ///< Command, revision.
  struct Outcome {
    std::optional<Order> order;     ///< Now complete.
    std::optional<Key> superseded;  ///< A newer command came before it.
    /// Handed out before: the server has not heard what became of it.
    std::optional<Key> asked_again;
  };
  Outcome on_command(const Command& command);
  Outcome on_part(const PathPart& part);
  void on_corridor(const CorridorPart& corridor);
  /// What came of the corridor of the order that was handed out.
  [[nodiscard]] std::vector<CorridorPart> take_corridors();
  /// Another store counts its commands anew.
  void forget();

 private:
  void begin_if_newer(const Key& key);
  Outcome hand_out_if_complete();
  /// The path's bytes, once they are all there.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> whole_path() const;

  Key newest_{};
  std::optional<Command> command_;
  std::array<std::vector<std::uint8_t>, kMaxPathParts> parts_;  ///< Empty: has not come.
  std::vector<CorridorPart> corridors_;                         ///< [Limit: ≤ kMaxCorridors]
  bool handed_out_ = false;
};

}  // namespace cairn::proto
