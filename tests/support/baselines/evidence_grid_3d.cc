#include "tests/support/baselines/evidence_grid_3d.h"

#include "core/map/walk_cells.h"

namespace cairn::baselines {

EvidenceGrid3d::EvidenceGrid3d(const GridExtent& extent, int floor_layer)
    : extent_(extent),
      floor_layer_(floor_layer),
      beliefs_(extent.cells() * kLayers, Bayes::kUnknown) {}

void EvidenceGrid3d::integrate(const std::vector<Beam>& beams) {
  for (const Beam& beam : beams) trace(beam);
}

void EvidenceGrid3d::trace(const Beam& beam) {
  CellAxis x(beam.origin_m.x(), beam.end_m.x(), extent_.cell_m);
  CellAxis y(beam.origin_m.y(), beam.end_m.y(), extent_.cell_m);
  CellAxis z(beam.origin_m.z(), beam.end_m.z(), kLayerM);
  while (x.left() + y.left() + z.left() > 0) {
    const CellIndex cell{x.index(), y.index()};
    if (contains(cell, z.index())) {
      Bayes::Belief& belief = beliefs_[at(cell, z.index())];
      belief = Bayes::after_pass(belief);
    }
    CellAxis& flat = x.crossing() <= y.crossing() ? x : y;
    (flat.crossing() <= z.crossing() ? flat : z).advance();
  }
  const CellIndex last{x.index(), y.index()};
  if (!beam.hit || !contains(last, z.index())) return;
  Bayes::Belief& belief = beliefs_[at(last, z.index())];
  belief = Bayes::after_hit(belief);
}

}  // namespace cairn::baselines
