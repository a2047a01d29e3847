#pragma once

#include <cstddef>

#include "core/common/result.h"
#include "core/graph/submap_graph.h"
#include "core/map/submap.h"

namespace cairn::bench {

/// The submaps as the server hands them to the pose graph, one after the other as they are closed;
/// then where it has them.
class Closure {
 public:
  /// Looks for loops until none is left to try.
  Status add(const Submap& submap);

  [[nodiscard]] bool holds(SubmapId id) const { return graph_.place(id).has_value(); }
  /// Requires: it holds it.
  [[nodiscard]] SubmapPose place(SubmapId id) const;
  /// [pairs]
  [[nodiscard]] int compared() const { return compared_; }
  /// Those that take part.
  [[nodiscard]] std::size_t loops() const;

 private:
  Status search();

  SubmapGraph graph_;
  int compared_ = 0;
};

}  // namespace cairn::bench
