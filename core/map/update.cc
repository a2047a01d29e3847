#include "core/map/update.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <tuple>

#include "core/map/walk_cells.h"

namespace cairn {
namespace {

// Working memory of more tiles than this (a scan of 250 m range) is given back after the scan.
constexpr std::size_t kPooledTiles = 1024;

/// Within ±kMaxExtentM, so it fits; truncation above a large offset is a fast floor.
std::int32_t to_mm(double metres) {
  constexpr std::int32_t kOffset = 1 << 30;
  return static_cast<std::int32_t>(metres * 1000.0 + (kOffset + 0.5)) - kOffset;
}

bool within_extent(const Eigen::Vector3d& p) {
  return p.allFinite() && p.cwiseAbs().maxCoeff() < HeightMap::kMaxExtentM;
}

bool acceptable(const Beam& beam) {
  return within_extent(beam.origin_m) && within_extent(beam.end_m);
}

/// The mean of `hits` hits at `mean_mm` and one more at `height_mm`, to the nearest millimetre but
/// moving at least one: rounded to nearest it would stand still as soon as it is half as many
/// millimetres off as it remembers hits.
std::int32_t next_mean_mm(std::int32_t mean_mm, std::int32_t hits, std::int32_t height_mm) {
  const std::int32_t off = height_mm - mean_mm;
  if (off == 0) return mean_mm;
  const std::int32_t count = hits + 1;
  const std::int32_t step = std::max((2 * std::abs(off) + count) / (2 * count), 1);
  return off < 0 ? mean_mm - step : mean_mm + step;
}

template <class Bits>
bool test_bit(const Bits& bits, int i) {
  const auto bit = static_cast<std::size_t>(i);
  return ((bits[bit / 64] >> (bit % 64)) & 1U) != 0;
}

template <class Bits>
void set_bit(Bits& bits, int i) {
  const auto bit = static_cast<std::size_t>(i);
  bits[bit / 64] |= std::uint64_t{1} << (bit % 64);
}

/// Keeps the strongest of each cell, and of those the lowest.
void keep_lowest(std::vector<Contradiction>& all) {
  const auto key = [](const Contradiction& c) {
    return std::tuple(c.cell.y, c.cell.x, c.grazing, c.height_mm);
  };
  std::sort(all.begin(), all.end(),
            [&](const Contradiction& a, const Contradiction& b) { return key(a) < key(b); });
  const auto same_cell = [](const Contradiction& a, const Contradiction& b) {
    return a.cell == b.cell;
  };
  all.erase(std::unique(all.begin(), all.end(), same_cell), all.end());
}

}  // namespace

CellRules::CellRules(const SensorModel& model) : model_(model) {
  assert(faults(model).empty());
  for (std::uint8_t p = 1; p < 255; ++p) {
    // Rounding must not make a weak model deaf: evidence always counts at least one step.
    const int up = std::max<int>(combine(p, model.hit_probability), p + 1);
    const auto after = [&](std::uint8_t evidence) {
      const int down = std::min<int>(combine(p, evidence), p - 1);
      return static_cast<std::uint8_t>(down < model.min_probability ? 0 : down);
    };
    probability_after_hit_[p] = static_cast<std::uint8_t>(std::min<int>(up, model.max_probability));
    probability_after_pass_[p] = after(model.miss_probability);
    probability_after_graze_[p] = after(model.graze_probability);
    hits_behind_[p] = static_cast<std::uint8_t>(hits_behind(p, model));
  }
  // No cell should be certain, but one that came from elsewhere must obey the rules as well.
  probability_after_hit_[255] = model.max_probability;
  probability_after_pass_[255] = probability_after_pass_[254];
  probability_after_graze_[255] = probability_after_graze_[254];
  hits_behind_[255] = hits_behind_[254];
}

Cell CellRules::after_hit(const Cell& cell, std::int32_t height_mm) const {
  const std::int64_t above_mm = std::int64_t{height_mm} - cell.height_mm;
  if (!cell.known() || above_mm > model_.tolerance_mm) return {height_mm, model_.hit_probability};
  if (above_mm < -model_.tolerance_mm) return cell;
  return {next_mean_mm(cell.height_mm, hits_behind_[cell.probability], height_mm),
          probability_after_hit_[cell.probability]};
}

Cell CellRules::after_pass(const Cell& cell, Pass pass) const {
  if (pass == Pass::above) return cell;
  const auto& after = pass == Pass::below ? probability_after_pass_ : probability_after_graze_;
  return {cell.height_mm, after[cell.probability]};
}

struct ScanIntegrator::Scene {
  HeightMap& map;
  const HeightMap* reference;
  std::optional<std::int32_t> ground_height_mm;
  ScanEffect effect;
  TileWork* last = nullptr;  ///< Beams stay in one tile for many cells.
};

inline ScanIntegrator::TileWork& ScanIntegrator::work_at(Scene& scene, CellIndex cell) {
  const TileKey key = HeightMap::tile_of(cell);
  if (scene.last == nullptr || key.tx != scene.last->key.tx || key.ty != scene.last->key.ty) {
    scene.last = &open_work(scene, key);
  }
  return *scene.last;
}

ScanEffect ScanIntegrator::integrate(HeightMap& map, const std::vector<Beam>& beams,
                                     std::optional<std::int32_t> ground_height_mm,
                                     const HeightMap* reference) {
  assert(reference == nullptr || reference->cell_size_mm() == map.cell_size_mm());
  assert(reference != &map);
  Scene scene{map, reference, ground_height_mm, {}};
  mark_hits(scene, beams);
  for (const Beam& beam : beams) {
    if (acceptable(beam)) integrate_free_part(scene, beam);
  }
  for (const Beam& beam : beams) {
    if (!acceptable(beam)) continue;
    ++scene.effect.beams;
    if (!beam.hit) continue;
    const CellIndex cell = map.cell_at(beam.end_m.x(), beam.end_m.y());
    hit(scene, work_at(scene, cell), HeightMap::index_in_tile(cell), to_mm(beam.end_m.z()));
  }
  collect(scene);
  return std::move(scene.effect);
}

ScanIntegrator::TileWork& ScanIntegrator::open_work(Scene& scene, const TileKey& key) {
  const auto [it, is_new] = open_.try_emplace(key, nullptr);
  if (!is_new) return *it->second;
  if (pool_.size() < open_.size()) pool_.push_back(std::make_unique<TileWork>());
  TileWork& work = *pool_[open_.size() - 1];
  work = TileWork{};
  work.key = key;
  work.tile = scene.map.find(key);
  if (scene.reference != nullptr) work.reference = scene.reference->find(key);
  it->second = &work;
  return work;
}

void ScanIntegrator::mark_hits(Scene& scene, const std::vector<Beam>& beams) {
  for (const Beam& beam : beams) {
    if (!beam.hit || !acceptable(beam)) continue;
    const CellIndex cell = scene.map.cell_at(beam.end_m.x(), beam.end_m.y());
    set_bit(work_at(scene, cell).hit, HeightMap::index_in_tile(cell));
  }
}

// Inline, as this and work_at are all that is done for most cells.
inline bool ScanIntegrator::concerns(const Scene& scene, const TileWork& work,
                                     const Stay& stay) const {
  const auto spoken_against = [&](const Tile* tile) {
    return tile != nullptr && rules_.pass_of(tile->cell(stay.index), stay.beam_height_mm,
                                             stay.went_on) != CellRules::Pass::above;
  };
  return spoken_against(work.tile) || spoken_against(work.reference) ||
         scene.ground_height_mm.has_value();
}

void ScanIntegrator::integrate_free_part(Scene& scene, const Beam& beam) {
  const CellIndex last = scene.map.cell_at(beam.end_m.x(), beam.end_m.y());
  const double z_m = beam.origin_m.z();
  const double rise_m = beam.end_m.z() - z_m;
  const double length_m = (beam.end_m - beam.origin_m).head<2>().norm();
  // Beyond this share of its way the beam no longer counts as going on.
  const double goes_on_until = 1.0 - rules_.model().graze_beyond_m / length_m;
  walk_cells(beam.origin_m.x(), beam.origin_m.y(), beam.end_m.x(), beam.end_m.y(),
             scene.map.cell_size_m(), [&](CellIndex cell, double t) {
               if (cell == last) return;
               TileWork& work = work_at(scene, cell);
               const Stay stay{cell, HeightMap::index_in_tile(cell), to_mm(z_m + t * rise_m),
                               t <= goes_on_until};
               // Nearly every cell of nearly every beam ends here.
               if (!concerns(scene, work, stay) || test_bit(work.hit, stay.index)) return;
               pass(scene, work, stay);
             });
}

void ScanIntegrator::pass(Scene& scene, TileWork& work, const Stay& stay) {
  if (work.tile != nullptr) {
    const Cell before = work.tile->cell(stay.index);
    const auto pass = rules_.pass_of(before, stay.beam_height_mm, stay.went_on);
    const Cell after = rules_.after_pass(before, pass);
    if (after != before) store(work, stay.index, before, after);
  }
  if (work.reference != nullptr) contradict(scene, work, stay);
  if (scene.ground_height_mm) hit(scene, work, stay.index, *scene.ground_height_mm);
}

void ScanIntegrator::contradict(Scene& scene, const TileWork& work, const Stay& stay) {
  const Cell believed = work.reference->cell(stay.index);
  const auto pass = rules_.pass_of(believed, stay.beam_height_mm, stay.went_on);
  if (pass == CellRules::Pass::above) return;
  const bool grazing = pass == CellRules::Pass::grazing;
  const std::int32_t below_mm = grazing ? rules_.model().tolerance_mm + 1 : 0;
  scene.effect.contradictions.push_back({stay.cell, stay.beam_height_mm - below_mm, grazing});
}

void ScanIntegrator::hit(Scene& scene, TileWork& work, int index, std::int32_t height_mm) {
  if (work.tile == nullptr) work.tile = &scene.map.make(work.key, height_mm);
  if (!work.tile->representable(height_mm)) {
    ++scene.effect.unrepresentable;
    return;
  }
  const Cell before = work.tile->cell(index);
  const Cell after = rules_.after_hit(before, height_mm);
  if (after != before) store(work, index, before, after);
}

void ScanIntegrator::store(TileWork& work, int index, const Cell& before, const Cell& after) {
  if (!test_bit(work.touched, index)) {
    set_bit(work.touched, index);
    before_.push_back({&work, index, before});
  }
  work.tile->set(index, after);
}

void ScanIntegrator::collect(Scene& scene) {
  keep_lowest(scene.effect.contradictions);
  for (const auto& [work, index, cell] : before_) {
    if (work->tile->cell(index) == cell) continue;
    scene.effect.changed.push_back({work->key.tx * Tile::kSize + index % Tile::kSize,
                                    work->key.ty * Tile::kSize + index / Tile::kSize});
  }
  before_.clear();
  open_.clear();
  if (pool_.size() > kPooledTiles) pool_.resize(kPooledTiles);
}

}  // namespace cairn
