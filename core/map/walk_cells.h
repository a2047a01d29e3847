#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "core/map/cell.h"

namespace cairn {

/// No beam crosses more cells than this; longer walks end there.
inline constexpr int kMaxBeamCells = 8192;

/// One axis of a walk: where along the segment it crosses into the next column (or row) of cells.
class CellAxis {
 public:
  CellAxis(double from_m, double to_m, double cell_m)
      : from_m_(from_m),
        per_m_(1.0 / (to_m - from_m)),
        cell_m_(cell_m),
        index_(static_cast<std::int32_t>(std::floor(from_m / cell_m))),
        left_(static_cast<std::int32_t>(std::floor(to_m / cell_m)) - index_),
        step_(left_ < 0 ? -1 : 1) {
    left_ = std::abs(left_);
    find_crossing();
  }

  [[nodiscard]] std::int32_t index() const { return index_; }
  [[nodiscard]] std::int32_t left() const { return left_; }  ///< Crossings still to come.
  /// The next crossing as a share of the segment; beyond 1 when none is left.
  [[nodiscard]] double crossing() const { return crossing_; }

  void advance() {
    index_ += step_;
    --left_;
    find_crossing();
  }

 private:
  static constexpr double kNever = 2.0;

  /// From the boundary itself, not by adding up steps, so that long walks do not drift.
  void find_crossing() {
    const double boundary_m = (step_ > 0 ? index_ + 1 : index_) * cell_m_;
    const double share = (boundary_m - from_m_) * per_m_;
    // In this order a share that is no number (0 · ∞ on a segment of almost no length) becomes 0.
    crossing_ = left_ > 0 ? std::min(1.0, std::max(0.0, share)) : kNever;
  }

  double from_m_;
  double per_m_;
  double cell_m_;
  std::int32_t index_;
  std::int32_t left_;
  std::int32_t step_;
  double crossing_ = kNever;
};

/// Walks the cells that the segment (x0, y0)-(x1, y1) [m] crosses, in order from its start, and
/// calls visit(CellIndex, t) with t in [0, 1], the middle of the segment's stay in that cell
/// (Amanatides & Woo 1987). Successive cells share a side: a segment through a corner also
/// visits one of the two cells beside it, for a stay of no length.
/// Requires: finite coordinates within HeightMap::kMaxExtentM, cell_m > 0.
template <class Visit>
void walk_cells(double x0_m, double y0_m, double x1_m, double y1_m, double cell_m, Visit&& visit) {
  CellAxis x(x0_m, x1_m, cell_m);
  CellAxis y(y0_m, y1_m, cell_m);
  const std::int32_t crossings = std::min(x.left() + y.left(), kMaxBeamCells - 1);
  double entered = 0.0;
  for (std::int32_t i = 0; i < crossings; ++i) {
    const double left = std::min(x.crossing(), y.crossing());
    visit(CellIndex{x.index(), y.index()}, 0.5 * (entered + left));
    entered = left;
    // Two branches, as a reference to one of the two would keep both out of the registers.
    if (x.crossing() <= y.crossing()) {
      x.advance();
    } else {
      y.advance();
    }
  }
  visit(CellIndex{x.index(), y.index()}, 0.5 * (entered + 1.0));
}

}  // namespace cairn
