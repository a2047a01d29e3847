#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/planner/corridor.h"
#include "proto/codec/records.h"
#include "server/mission/kept_fields.h"

namespace cairn::server {

/// A path as orders carry it.
struct WirePath {
  CodedPath path;
  std::vector<std::uint8_t> bytes;
  bool cut = false;  ///< It was too long: what is here is its beginning.
};

/// Coded within `most_bytes`; legs are split so that stretches of it can have corridors.
/// Requires: points within api::kMaxCoordinateM. Without points there are no bytes.
[[nodiscard]] WirePath to_wire(const std::vector<Eigen::Vector2d>& points_m, int cell_size_mm,
                               std::size_t most_bytes = proto::kMaxPathBytes);

/// What a corridor is to cover.
struct CorridorNeed {
  std::uint64_t command = 0;
  std::uint32_t revision = 0;
  std::uint64_t map_version = 0;  ///< That the field is of.
  int half_width = 12;            ///< [cells]
  int stretches = 1;              ///< Of kStretchM each, or shorter where they would not fit.
};

/// [cells] Of the corridor that comes with an order: 1.5 m to each side, where cells have 125 mm.
inline constexpr int kOrderHalfWidth = 12;
/// [m] Of way that a record of corridor covers, and how many come with an order.
inline constexpr double kStretchM = 50.0;
inline constexpr int kOrderStretches = 3;

/// The field around a path, from its point `first` on. Fewer stretches, or none, where the path
/// ends or the field does not reach it.
[[nodiscard]] std::vector<proto::CorridorPart> corridor_along(const CodedPath& path,
                                                              std::size_t first,
                                                              const KeptField& field,
                                                              const CorridorNeed& need);

/// For a robot that asks from `target.request.start_m`: further along `path`, when it is beside it,
/// or else around the way down the field from there. Empty when there is none. Requires:
/// field.follow(target) succeeded.
[[nodiscard]] std::vector<proto::CorridorPart> corridor_from(const CodedPath& path,
                                                             const PlanTarget& target,
                                                             const KeptField& field,
                                                             const CorridorNeed& need);

}  // namespace cairn::server
