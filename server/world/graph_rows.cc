#include "server/world/graph_rows.h"

namespace cairn::server {

LoopRow to_row(const SubmapEdge& loop) {
  const LevelPose& T = loop.T_from_to;
  LoopRow row{.from = loop.from,
              .to = loop.to,
              .status = static_cast<std::uint8_t>(loop.status),
              .T_from_to = {T.x_m, T.y_m, T.z_m, T.yaw_rad}};
  std::size_t i = 0;
  for (int r = 0; r < 4; ++r) {
    for (int c = r; c < 4; ++c) row.information[i++] = loop.information(r, c);
  }
  return row;
}

SubmapEdge to_edge(const LoopRow& row) {
  SubmapEdge loop{
      .kind = EdgeKind::loop,
      .status = static_cast<EdgeStatus>(row.status),
      .from = row.from,
      .to = row.to,
      .T_from_to = {row.T_from_to[0], row.T_from_to[1], row.T_from_to[2], row.T_from_to[3]}};
  std::size_t i = 0;
  for (int r = 0; r < 4; ++r) {
    for (int c = r; c < 4; ++c)
      loop.information(r, c) = loop.information(c, r) = row.information[i++];
  }
  return loop;
}

TriedRow to_row(const TriedPair& pair) { return {pair.a, pair.b, pair.tries, pair.sigma_m}; }

TriedPair to_pair(const TriedRow& row) { return {row.a, row.b, row.tries, row.sigma_m}; }

}  // namespace cairn::server
