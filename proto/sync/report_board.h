#pragma once

#include <cstdint>
#include <vector>

#include "proto/codec/frame.h"
#include "proto/codec/records.h"
#include "proto/sync/transit.h"

namespace cairn::proto {

/// The robot's reports on commands: the newest state of each (command, revision), sent until
/// acknowledged and kept to be repeated should the server ask again.
class ReportBoard {
 public:
  /// [reports] At it the oldest acknowledged one is forgotten, or else the oldest.
  static constexpr std::size_t kMaxReports = 16;

  void post(const CommandReport& report);
  /// The server asked for this revision (again): what was said of it is said again.
  /// False when nothing was ever said of it.
  bool ask(std::uint64_t command, std::uint32_t revision);

  [[nodiscard]] bool has_news() const;
  /// Returns how many records were added.
  int fill(FrameWriter& frame, std::uint32_t number);
  void on_acked(std::uint32_t number);
  void on_lost(std::uint32_t number);
  /// A new session: nothing is under way.
  void on_session();

 private:
  struct Entry {
    CommandReport report;
    Transit transit = {};
  };

  Entry* find(std::uint64_t command, std::uint32_t revision);
  void make_room();

  std::vector<Entry> entries_;
};

}  // namespace cairn::proto
