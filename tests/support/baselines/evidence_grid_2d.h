#pragma once

#include <cstddef>
#include <vector>

#include "core/map/cell.h"
#include "core/sensor/laser.h"
#include "tests/support/baselines/evidence_update.h"

namespace cairn::baselines {

/// A rectangle of cells; the first one is at the south-west.
struct GridExtent {
  CellIndex origin{};
  int width = 128;
  int height = 128;
  double cell_m = 0.125;

  [[nodiscard]] bool contains(CellIndex c) const {
    return c.x >= origin.x && c.y >= origin.y && c.x - origin.x < width && c.y - origin.y < height;
  }
  /// Requires: contains(c).
  [[nodiscard]] std::size_t at(CellIndex c) const {
    return static_cast<std::size_t>(c.y - origin.y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(c.x - origin.x);
  }
  [[nodiscard]] std::size_t cells() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
};

/// The one-layered evidence grid of T4.1 under one of the ways to update it.
template <class Update>
class EvidenceGrid2d {
 public:
  using Belief = typename Update::Belief;

  explicit EvidenceGrid2d(const GridExtent& extent)
      : extent_(extent), beliefs_(extent.cells(), Update::kUnknown) {}

  /// Every cell before a beam's last one is passed, the last one hit (if there was a return). Cells
  /// outside the grid are left out. Only beams of a level laser make sense here.
  void integrate(const std::vector<Beam>& beams);

  /// Requires: the grid contains the cell.
  [[nodiscard]] double occupied(CellIndex cell) const {
    return Update::occupied(beliefs_[extent_.at(cell)]);
  }
  [[nodiscard]] std::size_t bytes() const { return beliefs_.size() * sizeof(Belief); }

 private:
  GridExtent extent_;
  std::vector<Belief> beliefs_;
};

extern template class EvidenceGrid2d<Bayes>;
extern template class EvidenceGrid2d<Himm>;
extern template class EvidenceGrid2d<DempsterShafer>;

}  // namespace cairn::baselines
