#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/sensor/laser.h"
#include "tests/support/baselines/evidence_grid_2d.h"

namespace cairn::baselines {

/// The 3-D evidence grid of T4.2 with Bayes' rule: layers of half the height that the robot climbs,
/// over one metre. What is above or below is lost, as T4.2 says.
class EvidenceGrid3d {
 public:
  static constexpr double kLayerM = 0.05;
  static constexpr int kLayers = 20;

  /// `floor_layer` is the index of the lowest layer; layer 0 begins at height 0.
  EvidenceGrid3d(const GridExtent& extent, int floor_layer);

  /// Every voxel that a beam crosses before its last one is passed, the last one hit (if there was
  /// a return). Voxels outside the grid are left out.
  void integrate(const std::vector<Beam>& beams);

  /// Requires: the grid contains the voxel.
  [[nodiscard]] double occupied(CellIndex cell, int layer) const {
    return Bayes::occupied(beliefs_[at(cell, layer)]);
  }
  [[nodiscard]] std::size_t bytes() const { return beliefs_.size() * sizeof(Bayes::Belief); }

 private:
  void trace(const Beam& beam);
  [[nodiscard]] bool contains(CellIndex cell, int layer) const {
    return extent_.contains(cell) && layer >= floor_layer_ && layer - floor_layer_ < kLayers;
  }
  [[nodiscard]] std::size_t at(CellIndex cell, int layer) const {
    return static_cast<std::size_t>(layer - floor_layer_) * extent_.cells() + extent_.at(cell);
  }

  GridExtent extent_;
  int floor_layer_;
  std::vector<Bayes::Belief> beliefs_;
};

}  // namespace cairn::baselines
