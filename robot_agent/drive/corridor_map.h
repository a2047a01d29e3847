#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/planner/corridor.h"
#include "proto/codec/records.h"

namespace cairn::agent {

/// The path of an order. `points_m` ends at the exact goal, where the path leads there.
struct OrderedPath {
  CodedPath coded;
  std::vector<Eigen::Vector2d> points_m;
};
/// invalid_argument when the bytes are no path.
[[nodiscard]] Result<OrderedPath> read_path(const proto::Command& command,
                                            const std::vector<std::uint8_t>& bytes);

/// The corridors that came for an order, as one map of directions. Where they overlap the one of
/// the newest map counts.
class CorridorMap {
 public:
  /// [corridors] Beyond it the oldest are forgotten.
  static constexpr std::size_t kMaxParts = 16;

  CorridorMap() = default;
  CorridorMap(const proto::Command& command, OrderedPath path);

  /// conflict when it is not of this order, invalid_argument when it cannot be read.
  Status take(const proto::CorridorPart& corridor, int cell_size_mm);

  [[nodiscard]] bool empty() const { return parts_.empty(); }
  /// As Corridor::direction.
  [[nodiscard]] std::uint8_t direction(CellIndex cell) const;
  [[nodiscard]] const Eigen::Vector2d& goal_m() const { return goal_m_; }

  /// What follows on a corridor that ends short of the goal: the rest of its path.
  struct Rest {
    std::vector<Eigen::Vector2d> points_m;  ///< From the nearest on.
    bool to_goal = false;                   ///< They lead to the order's end.
  };
  /// From the last cell in a corridor on; nullopt where the directions lead out of its side: what
  /// lies there is not known.
  [[nodiscard]] std::optional<Rest> rest_from(CellIndex cell) const;

 private:
  struct Part {
    std::uint64_t map_version = 0;
    int half_width = 0;
    std::size_t last = 0;  ///< Point of the path that the corridor ends at.
    bool own_path = false;
    std::vector<Eigen::Vector2d> path_m;
    bool to_goal = false;
    Corridor corridor;
  };

  [[nodiscard]] const Part* part_at(CellIndex cell) const;

  std::uint64_t command_ = 0;
  std::uint32_t revision_ = 0;
  bool path_cut_ = false;
  OrderedPath path_;
  Eigen::Vector2d goal_m_ = Eigen::Vector2d::Zero();
  double cell_m_ = 0.125;
  std::deque<Part> parts_;  ///< Newest map first. [Limit: ≤ kMaxParts]
};

}  // namespace cairn::agent
