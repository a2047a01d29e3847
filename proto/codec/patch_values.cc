#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>

#include "proto/codec/patch_around.h"
#include "proto/codec/patch_cells.h"

// What became of changed cells, and their probabilities; which cells changed is in patch_cells.cc,
// their heights in patch_heights.cc.
namespace cairn::proto::patch {
namespace {

/// The least exact probability of a level among 16; 255 beyond the last.
int least_of(int level) {
  static const auto least = [] {
    std::array<std::uint8_t, kMaxLevels + 1> all{};
    all.fill(255);
    for (int p = 254; p > 0; --p) {
      all.at(z(level_of(static_cast<std::uint8_t>(p), kMaxLevels))) = static_cast<std::uint8_t>(p);
    }
    return all;
  }();
  return least.at(z(level));
}

}  // namespace

// ---- What became of them ------------------------------------------------------------------------

template <class Coder>
bool CellCoder<Coder>::code_cell(const Here& here, Cell& cell, std::int32_t datum_mm) {
  const WindowCell before = here.window->at(here.x, here.y);
  const bool was_known = before.known();
  if (clear(here, !cell.known())) {
    cell = {};
    here.window->tell(here.x, here.y, told_cell(before, cell, coarseness_));
    return true;
  }
  told_ = {};
  // How sure an exact cell is tells how many heights it is the mean of.
  const bool sure_first = !was_known && coarseness_ == kExact;
  if (sure_first) told_.probability = cell.probability = probability(here, 3, cell.probability);
  const std::int64_t height = cell.height_mm / coarseness_.quantum_mm;
  int how = 3;  // 0 the same height, 1 moved, 2 replaced by a higher one, 3 new.
  const std::int64_t coded =
      was_known ? changed_height(here, height, how) : new_height(here, height);
  const std::int64_t height_mm = coded * coarseness_.quantum_mm;
  if (std::abs(height_mm - datum_mm) > Tile::kHeightLimitMm) return false;
  cell.height_mm = static_cast<std::int32_t>(height_mm);
  if (!HeightMap::storable(cell.height_mm)) return false;
  if (!sure_first) cell.probability = probability(here, how, cell.probability);
  if (cell.probability == 0) return false;
  note_grid(here, cell.height_mm);
  WindowCell now = told_cell(before, cell, coarseness_);
  now.marks |= told_.marks | (how > 0 ? kMoved : 0);
  now.residual = told_.residual;
  here.window->tell(here.x, here.y, now);
  running_.last_height = now.height;
  return true;
}

/// Marks an exact height that shares a grid with one told beside it or before it.
template <class Coder>
void CellCoder<Coder>::note_grid(const Here& here, std::int32_t height_mm) {
  if (coarseness_ != kExact) return;
  const Around a(*here.window, here.x, here.y);
  bool shares = (height_mm - running_.grid_height) % kGridMm == 0 ||
                (height_mm - running_.last_height) % kGridMm == 0;
  for (const WindowCell* cell : {&a.w, &a.n, &a.nw, &a.ne}) {
    shares = shares || (changed(*cell) != 0 && (height_mm - cell->height) % kGridMm == 0);
  }
  if (!shares) return;
  told_.marks |= kOnGrid;
  running_.grid_height = height_mm;
}

template <class Coder>
bool CellCoder<Coder>::clear(const Here& here, bool cleared) {
  const Around a(*here.window, here.x, here.y);
  const int told = a.told();
  const int gone = marked(a.w, kCleared) + 2 * marked(a.n, kCleared) + 4 * marked(a.nw, kCleared) +
                   8 * marked(a.ne, kCleared);
  const auto& element = kElements.clear;
  mixer_.begin();
  mixer_.add(element.tables[0].at(z(a.self.level * 5 + told)));
  mixer_.add(element.tables[1].at(z(a.self.level * 8 + a.self.age)));
  mixer_.add(element.tables[2].at(z(gone * 8 + std::min(told, 3) * 2 + known(a.self))));
  mixer_.add(element.tables[3].at(z(a.self.updates * 8 + ones(gone))));
  return mixer_.code(coder_, cleared, element.first_set + z(told),
                     element.first_set + 5 + z(a.self.age));
}

// ---- Probability --------------------------------------------------------------------------------

template <class Coder>
std::uint8_t CellCoder<Coder>::probability(const Here& here, int how, std::uint8_t value) {
  if (rare(value == 255, 0)) return 255;
  if (coarseness_.levels == kExactProbability) return exact_probability(here, how, value);
  const int levels = coarseness_.levels;
  const int coded = level(here, how, value == 0 ? 0 : level_of(value, levels), levels);
  return coded < levels ? probability_of(coded, levels) : 0;
}

/// A tree over as many bits as the levels need, its nodes numbered from 1.
template <class Coder>
int CellCoder<Coder>::level(const Here& here, int how, int value, int levels) {
  const Around a(*here.window, here.x, here.y);
  const int bits = std::bit_width(static_cast<unsigned>(levels - 1));
  const auto told_level = [](const WindowCell& cell) {
    return changed(cell) != 0 ? cell.level : 0;
  };
  const int recent = ones(Bits(*here.window, here.x, here.y).eight(&Window::Row::recent));
  const std::size_t distance = view_ ? place_of(here.x, here.y).distance : 0;
  const bool few = bits < 4;
  const auto& element = few ? kElements.few : kElements.level;
  const std::size_t nodes = few ? kFewNodes : kLevelNodes;
  const auto& t = element.tables;
  int node = 1;
  for (int bit = bits - 1; bit >= 0; --bit) {
    const auto at = [&](int context) { return z(context) * nodes + z(node); };
    mixer_.begin();
    mixer_.add(t[0].at(at(a.self.level * 4 + how)));
    mixer_.add(t[1].at(at(told_level(a.w) * 4 + how)));
    mixer_.add(t[2].at(at(told_level(a.n) * 4 + how)));
    mixer_.add(t[3].at(at(a.self.level * 9 + told_level(a.w) / 2)));
    mixer_.add(
        t[4].at(at((a.told() * 8 + std::min(recent, 7)) * 8 + how * 2 + (a.self.updates > 1))));
    mixer_.add(t[5].at(at((a.self.age * 8 + a.self.updates) * 4 + how)));
    if (view_) mixer_.add(t[6].at((distance * 8 + z(how * 2 + (a.told() > 1))) * nodes + z(node)));
    const bool one = mixer_.code(coder_, ((value >> bit) & 1) != 0, element.first_set + z(node),
                                 element.first_set + nodes + z(how * 5 + std::min(a.told(), 4)));
    node = node * 2 + (one ? 1 : 0);
  }
  return node - (1 << bits);
}

/// The level among 16, whether the probability is the level's own, and if not which of its others.
template <class Coder>
std::uint8_t CellCoder<Coder>::exact_probability(const Here& here, int how, std::uint8_t value) {
  const int coded = level(here, how, value == 0 ? 0 : level_of(value, kMaxLevels), kMaxLevels);
  const std::uint8_t plain = probability_of(coded, kMaxLevels);
  if (plain_level(here, how, coded, value == plain)) return plain;
  const int least = least_of(coded);
  const int exact = least + rest(here, coded, value - least);
  return exact < 255 ? static_cast<std::uint8_t>(exact) : 0;
}

template <class Coder>
bool CellCoder<Coder>::plain_level(const Here& here, int how, int level, bool is) {
  const Around a(*here.window, here.x, here.y);
  const auto kind = [](const WindowCell& cell) {
    return changed(cell) == 0 ? 0 : is_level_value(cell.probability) ? 2 : 1;
  };
  const int beside = kind(a.w) * 3 + kind(a.n);
  const auto& element = kElements.plain_level;
  mixer_.begin();
  mixer_.add(element.tables[0].at(z(level * 9 + beside)));
  mixer_.add(element.tables[1].at(z(level * 4 + how)));
  mixer_.add(element.tables[2].at(z((beside * 3 + kind(a.nw)) * 3 + kind(a.ne))));
  return mixer_.code(coder_, is, element.first_set + z(level), element.first_set + 16 + z(beside));
}

template <class Coder>
int CellCoder<Coder>::rest(const Here& here, int level, int value) {
  const Around a(*here.window, here.x, here.y);
  const int least = least_of(level);
  const int bits = std::bit_width(static_cast<unsigned>(least_of(level + 1) - 1 - least));
  const bool alike = a.w.level == level + 1;
  const int beside = alike ? std::min(a.w.probability - least + 1, 63) : 0;
  const auto& element = kElements.rest;
  int node = 1;
  for (int bit = bits - 1; bit >= 0; --bit) {
    mixer_.begin();
    mixer_.add(element.tables[0].at(z(level) * kRestNodes + z(node)));
    mixer_.add(element.tables[1].at(z(beside) * kRestNodes + z(node)));
    const bool one = mixer_.code(coder_, ((value >> bit) & 1) != 0, element.first_set + z(bit),
                                 element.first_set + 8 + z(level));
    node = node * 2 + (one ? 1 : 0);
  }
  return node - (1 << bits);
}

template class CellCoder<RangeEncoder>;
template class CellCoder<RangeDecoder>;

}  // namespace cairn::proto::patch
