#include "tests/support/baselines/evidence_grid_2d.h"

#include <cmath>

#include "core/map/walk_cells.h"

namespace cairn::baselines {

template <class Update>
void EvidenceGrid2d<Update>::integrate(const std::vector<Beam>& beams) {
  for (const Beam& beam : beams) {
    const CellIndex last{static_cast<std::int32_t>(std::floor(beam.end_m.x() / extent_.cell_m)),
                         static_cast<std::int32_t>(std::floor(beam.end_m.y() / extent_.cell_m))};
    walk_cells(beam.origin_m.x(), beam.origin_m.y(), beam.end_m.x(), beam.end_m.y(), extent_.cell_m,
               [&](CellIndex cell, double) {
                 if (cell == last || !extent_.contains(cell)) return;
                 Belief& belief = beliefs_[extent_.at(cell)];
                 belief = Update::after_pass(belief);
               });
    if (!beam.hit || !extent_.contains(last)) continue;
    Belief& belief = beliefs_[extent_.at(last)];
    belief = Update::after_hit(belief);
  }
}

template class EvidenceGrid2d<Bayes>;
template class EvidenceGrid2d<Himm>;
template class EvidenceGrid2d<DempsterShafer>;

}  // namespace cairn::baselines
