#include <algorithm>
#include <bit>
#include <cstdlib>

#include "proto/codec/patch_around.h"
#include "proto/codec/patch_cells.h"

// The new values of changed cells; which cells changed is in patch_cells.cc.
namespace cairn::proto::patch {
namespace {

/// Numbers of 29 bits and more break a bound whatever they are.
constexpr int kMostClass = 28;
/// [mm] A height this far above the old one replaces it (SensorModel::tolerance_mm, by default).
constexpr int kReplaceMm = 50;

/// The height of a neighbour told in alt mode, else the packet's last, else nothing.
std::optional<std::int32_t> alt_of(const Around& around, const Running& running) {
  for (const WindowCell* cell : {&around.w, &around.n, &around.ne, &around.nw}) {
    if (marked(*cell, kAltMode) != 0) return cell->height;
  }
  return running.alt_height;
}

}  // namespace

/// Zero or not, sign, then how many bits the magnitude has (one by one), then those below its
/// first. `contexts(node, rare)` adds the contexts of a node.
template <class Coder>
template <class Contexts>
std::int64_t CellCoder<Coder>::signed_number(std::int64_t value, std::size_t first_set,
                                             std::size_t second_set, const Contexts& contexts) {
  const auto bit = [&](bool is, std::size_t node, std::size_t rare_node) {
    mixer_.begin();
    contexts(node, rare_node);
    return mixer_.code(coder_, is, first_set + std::min(node, kNodes),
                       second_set + (node < 2        ? node
                                     : node < kNodes ? 2
                                                     : 3));
  };
  if (bit(value == 0, 0, 0)) return 0;
  const bool negative = bit(value < 0, 1, 1);
  const std::size_t side = negative ? 1 : 0;
  const std::uint64_t magnitude = static_cast<std::uint64_t>(std::abs(value));
  int extra = 0;  // Bits below the first.
  const int true_extra = static_cast<int>(std::bit_width(magnitude)) - 1;
  for (; extra < kMostClass; ++extra) {
    const bool rare = extra >= 3;
    const std::size_t node = rare ? kNodes : 2 + 2 * z(extra) + side;
    if (!bit(true_extra > extra, node, 2 + 2 * z(extra) + side)) break;
  }
  std::uint64_t coded = 1;
  for (int i = extra - 1; i >= 0; --i) {
    const bool often = extra <= 2 && i == extra - 1;
    const std::size_t node = often ? 6 + 2 * z(extra) + side : kNodes;
    const std::size_t rare_node = i < 8 ? 64 + 10 * z(extra) + z(i) : 63;
    coded = coded * 2 + (bit(((magnitude >> i) & 1U) != 0, node, rare_node) ? 1 : 0);
  }
  return negative ? -static_cast<std::int64_t>(coded) : static_cast<std::int64_t>(coded);
}

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
  const std::int64_t height = cell.height_mm / coarseness_.quantum_mm;
  int how = 3;  // 0 the same height, 1 moved, 2 replaced by a higher one, 3 new.
  const std::int64_t coded =
      was_known ? changed_height(here, height, how) : new_height(here, height);
  const std::int64_t height_mm = coded * coarseness_.quantum_mm;
  if (std::abs(height_mm - datum_mm) > Tile::kHeightLimitMm) return false;
  cell.height_mm = static_cast<std::int32_t>(height_mm);
  if (!HeightMap::storable(cell.height_mm)) return false;
  cell.probability = probability(here, how, cell.probability);
  if (cell.probability == 0) return false;
  WindowCell now = told_cell(before, cell, coarseness_);
  now.marks |= told_.marks | (how > 0 ? kMoved : 0);
  now.residual = told_.residual;
  here.window->tell(here.x, here.y, now);
  running_.last_height = now.height;
  return true;
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

template <class Coder>
std::int64_t CellCoder<Coder>::new_height(const Here& here, std::int64_t height) {
  const Around a(*here.window, here.x, here.y);
  Prediction p = predict(*here.window, here.x, here.y);
  if (p.count == 0) {
    p.nearest = p.least = p.most = running_.last_height;
    p.plane16 = p.mean16 = 16 * running_.last_height;
  }
  const std::int32_t off = (p.plane16 + 8) >> 4;
  const auto alt = alt_of(a, running_);
  const int clear_of = std::max(4, 60 / coarseness_.quantum_mm);  // [quanta]
  const bool alt_apart = !alt || std::abs(std::int64_t{*alt} - off) > clear_of;
  const bool far_off = std::abs(height - off) > clear_of;
  if (alt_apart && alt_mode(here, p, alt.value_or(off),
                            alt ? std::abs(height - *alt) < std::abs(height - off) : far_off)) {
    told_.marks |= kAltMode;
    const std::int64_t coded = alt_height(here, alt.value_or(off), height);
    running_.alt_height =
        static_cast<std::int32_t>(std::clamp<std::int64_t>(coded, -100'000'000, 100'000'000));
    return coded;
  }
  const int spread = log2_class(std::int64_t{p.most} - p.least, 9);
  const int crowd = p.count == 0 ? 0 : 1 + log2_class(p.count, 5) - 1;
  const int error = log2_class(running_.error16 / 2, 7);
  const auto beside = [&](const WindowCell& cell) {
    return cell.known() ? 1 + held(std::int64_t{cell.height} - off, 7) : 0;
  };
  const std::size_t fraction = static_cast<std::size_t>((p.plane16 + 8) & 15) / 4;
  const std::size_t misses =
      static_cast<std::size_t>(log2_class(a.w.residual, 3) * 16 + log2_class(a.n.residual, 3) * 4) +
      static_cast<std::size_t>(log2_class(a.ne.residual, 3));
  const auto& t = kElements.fresh.tables;
  const auto contexts = [&](std::size_t node, std::size_t rare_node) {
    if (node >= kNodes) return mixer_.add(t[7].at(rare_node));
    mixer_.add(t[0].at(z(spread * 6 + crowd) * kNodes + node));
    mixer_.add(t[1].at((beside(a.w) * 16 + beside(a.n)) * kNodes + node));
    mixer_.add(t[2].at(
        (held((16 * std::int64_t{p.nearest} - p.plane16) / 8, 15) * 6 + z(crowd)) * kNodes + node));
    mixer_.add(t[3].at((fraction * 8 + z(error)) * kNodes + node));
    mixer_.add(t[4].at(misses * kNodes + node));
    mixer_.add(t[5].at(
        (held(std::int64_t{p.most} - off, 7) * 16 + held(std::int64_t{p.least} - off, 7)) * kNodes +
        node));
    mixer_.add(t[6].at((held((p.mean16 - p.plane16) / 8, 15) * 8 + z(error)) * kNodes + node));
  };
  const std::size_t first = kElements.fresh.first_set;
  const std::int64_t missed =
      signed_number(height - off, first, first + kNodes + 1 + 4 * z(crowd), contexts);
  const auto miss = static_cast<std::int32_t>(std::min<std::int64_t>(std::abs(missed), 16));
  running_.error16 += (16 * miss - running_.error16) / 8;
  told_.residual = static_cast<std::uint8_t>(miss);
  return off + missed;
}

template <class Coder>
bool CellCoder<Coder>::alt_mode(const Here& here, const Prediction& p, std::int32_t alt,
                                bool is_alt) {
  const Around a(*here.window, here.x, here.y);
  const int near = marked(a.w, kAltMode) + 2 * marked(a.n, kAltMode) + 4 * marked(a.ne, kAltMode) +
                   8 * marked(a.nw, kAltMode);
  const int told = changed(a.w) + 2 * changed(a.n);
  const std::int64_t above = std::int64_t{alt} - p.most;
  const int apart = log2_class(std::abs(above), 7) + (above < 0 ? 8 : 0);
  const int crowd = std::min(p.count, 7);
  const int spread = log2_class(std::int64_t{p.most} - p.least, 7);
  const auto& element = kElements.alt;
  mixer_.begin();
  mixer_.add(element.tables[0].at(z(near * 4 + told)));
  mixer_.add(element.tables[1].at(z(apart * 8 + crowd)));
  mixer_.add(element.tables[2].at(z(near * 8 + crowd)));
  mixer_.add(element.tables[3].at(
      z((spread * 8 + crowd) * 4 + (near != 0) * 2 + (running_.alt_height.has_value() ? 1 : 0))));
  return mixer_.code(coder_, is_alt, element.first_set + z((near != 0) + 2 * (told != 0)),
                     element.first_set + 4 + z(std::min(crowd, 5)));
}

template <class Coder>
std::int64_t CellCoder<Coder>::alt_height(const Here& here, std::int32_t alt, std::int64_t height) {
  const Around a(*here.window, here.x, here.y);
  const auto beside = [&](const WindowCell& cell) {
    return marked(cell, kAltMode) != 0 ? 1 + held(std::int64_t{cell.height} - alt, 7) : 0;
  };
  const int near = marked(a.w, kAltMode) + 2 * marked(a.n, kAltMode) + 4 * marked(a.ne, kAltMode) +
                   8 * marked(a.nw, kAltMode);
  const int error = log2_class(running_.error16 / 2, 7);
  const auto& t = kElements.alt_height.tables;
  const auto contexts = [&](std::size_t node, std::size_t rare_node) {
    if (node >= kNodes) return mixer_.add(t[4].at(rare_node));
    mixer_.add(t[0].at(z(near) * kNodes + node));
    mixer_.add(t[1].at((beside(a.n) * 16 + beside(a.ne)) * kNodes + node));
    mixer_.add(t[2].at((z(near != 0) * 8 + z(error)) * kNodes + node));
    mixer_.add(t[3].at((beside(a.nw) * 2 + z(marked(a.w, kAltMode))) * kNodes + node));
  };
  const std::size_t first = kElements.alt_height.first_set;
  return alt + signed_number(height - alt, first, first + kNodes + 1, contexts);
}

template <class Coder>
std::int64_t CellCoder<Coder>::changed_height(const Here& here, std::int64_t height, int& how) {
  const Around a(*here.window, here.x, here.y);
  const std::int64_t old = a.self.height;
  const Prediction p = predict(*here.window, here.x, here.y);
  const std::int64_t plane = p.count == 0 ? old : (p.plane16 + 8) >> 4;
  const std::int64_t most = p.count == 0 ? old : p.most;
  const int spread = p.count == 0 ? 0 : log2_class(std::int64_t{p.most} - p.least, 7);
  const int moved_near =
      marked(a.w, kMoved) + 2 * marked(a.n, kMoved) + 4 * changed(a.w) + 8 * changed(a.n);
  const auto& moved = kElements.moved;
  mixer_.begin();
  mixer_.add(moved.tables[0].at(z(a.self.level * 8 + a.self.age)));
  mixer_.add(moved.tables[1].at(z(moved_near * 8 + spread)));
  mixer_.add(moved.tables[2].at(held(plane - old, 7) * 18 + a.self.level));
  mixer_.add(moved.tables[3].at(z(a.self.updates * 18 + a.self.level)));
  mixer_.add(moved.tables[4].at(held((most - old) / 2, 7) * 16 + z(moved_near)));
  if (!mixer_.code(coder_, height != old, moved.first_set + z(a.self.updates),
                   moved.first_set + 9 + z(a.self.age))) {
    how = 0;
    return old;
  }
  const auto& t = kElements.change.tables;
  const auto contexts = [&](std::size_t node, std::size_t rare_node) {
    if (node >= kNodes) return mixer_.add(t[5].at(rare_node));
    mixer_.add(t[0].at(z(a.self.updates * 18 + a.self.level) * kNodes + node));
    mixer_.add(t[1].at(held(plane - old, 7) * kNodes + node));
    mixer_.add(t[2].at(held((most - old) / 2, 7) * kNodes + node));
    mixer_.add(t[3].at(z(spread * 8 + a.self.age) * kNodes + node));
    mixer_.add(t[4].at(z(moved_near * 8 + spread) * kNodes + node));
  };
  const std::size_t first = kElements.change.first_set;
  const std::int64_t by = signed_number(height - old, first, first + kNodes + 1, contexts);
  how = by * coarseness_.quantum_mm > kReplaceMm ? 2 : 1;
  return old + by;
}

// ---- Probability --------------------------------------------------------------------------------

template <class Coder>
std::uint8_t CellCoder<Coder>::probability(const Here& here, int how, std::uint8_t value) {
  if (coarseness_.levels == kExactProbability) return exact_probability(here, how, value);
  if (rare(value == 255, 0)) return 255;
  const int levels = coarseness_.levels;
  const int coded = level(here, how, value == 0 ? 0 : level_of(value, levels));
  return coded < levels ? probability_of(coded, levels) : 0;
}

/// A tree over as many bits as the levels need, its nodes numbered from 1.
template <class Coder>
int CellCoder<Coder>::level(const Here& here, int how, int value) {
  const Around a(*here.window, here.x, here.y);
  const int bits = std::bit_width(static_cast<unsigned>(coarseness_.levels - 1));
  const auto told_level = [](const WindowCell& cell) {
    return changed(cell) != 0 ? cell.level : 0;
  };
  const int recent = ones(Bits(*here.window, here.x, here.y).eight(&Window::Row::recent));
  const auto& t = kElements.level.tables;
  int node = 1;
  for (int bit = bits - 1; bit >= 0; --bit) {
    const auto at = [&](int context) { return z(context) * kLevelNodes + z(node); };
    mixer_.begin();
    mixer_.add(t[0].at(at(a.self.level * 4 + how)));
    mixer_.add(t[1].at(at(told_level(a.w) * 4 + how)));
    mixer_.add(t[2].at(at(told_level(a.n) * 4 + how)));
    mixer_.add(t[3].at(at(a.self.level * 9 + told_level(a.w) / 2)));
    mixer_.add(
        t[4].at(at((a.told() * 8 + std::min(recent, 7)) * 8 + how * 2 + (a.self.updates > 1))));
    mixer_.add(t[5].at(at((a.self.age * 8 + a.self.updates) * 4 + how)));
    const std::size_t first = kElements.level.first_set;
    const bool one = mixer_.code(coder_, ((value >> bit) & 1) != 0, first + z(node),
                                 first + 16 + z(how * 5 + std::min(a.told(), 4)));
    node = node * 2 + (one ? 1 : 0);
  }
  return node - (1 << bits);
}

template <class Coder>
std::uint8_t CellCoder<Coder>::exact_probability(const Here& here, int how, std::uint8_t value) {
  const Around a(*here.window, here.x, here.y);
  const auto& t = kElements.exact.tables;
  const std::size_t first = kElements.exact.first_set;
  const auto beside = [](const WindowCell& cell) { return z((cell.level + 5) / 6); };
  std::size_t node = 1;
  for (int bit = 7; bit >= 0; --bit) {
    mixer_.begin();
    mixer_.add(t[0].at(node * 4 + z(how)));
    mixer_.add(t[1].at(node * 4 + beside(a.w)));
    mixer_.add(t[2].at(node * 4 + beside(a.self.known() ? a.self : a.n)));
    const bool one =
        mixer_.code(coder_, ((value >> bit) & 1) != 0, first + z(7 - bit), first + 16 + z(how));
    node = node * 2 + (one ? 1 : 0);
  }
  return static_cast<std::uint8_t>(node - 256);
}

template class CellCoder<RangeEncoder>;
template class CellCoder<RangeDecoder>;

}  // namespace cairn::proto::patch
