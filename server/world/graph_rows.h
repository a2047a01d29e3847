#pragma once

#include "core/graph/submap_graph.h"
#include "server/store/store.h"

namespace cairn::server {

/// What the pose graph found ↔ rows of the store.
[[nodiscard]] LoopRow to_row(const SubmapEdge& loop);
[[nodiscard]] SubmapEdge to_edge(const LoopRow& row);
[[nodiscard]] TriedRow to_row(const TriedPair& pair);
[[nodiscard]] TriedPair to_pair(const TriedRow& row);

}  // namespace cairn::server
