#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>

#include "proto/codec/patch_around.h"
#include "proto/codec/patch_cells.h"

// The new heights of changed cells.
namespace cairn::proto::patch {
namespace {

/// Numbers of 29 bits and more break a bound whatever they are.
constexpr int kMostClass = 28;
/// [mm] A height this far above the old one replaces it (SensorModel::tolerance_mm, by default).
constexpr int kReplaceMm = 50;

std::int64_t floor_div(std::int64_t a, std::int64_t b) { return a / b - (a % b < 0 ? 1 : 0); }
bool on_one_grid(std::int64_t a, std::int64_t b) { return (a - b) % kGridMm == 0; }

/// The height of a neighbour told in alt mode, else the packet's last, else nothing.
std::optional<std::int32_t> alt_of(const Around& around, const Running& running) {
  for (const WindowCell* cell : {&around.w, &around.n, &around.ne, &around.nw}) {
    if (marked(*cell, kAltMode) != 0) return cell->height;
  }
  return running.alt_height;
}

}  // namespace

std::int32_t Steps::nearest(std::int64_t height16) const {
  const std::int64_t above16 = height16 - std::int64_t{16} * phase;
  return static_cast<std::int32_t>(phase + size * floor_div(above16 + 8 * size, 16 * size));
}

std::int64_t Steps::of(std::int64_t difference) const {
  return floor_div(difference + size / 2, size);
}

// ---- Numbers ------------------------------------------------------------------------------------

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

// ---- Heights of cells that were unknown
// ----------------------------------------------------------

/// Exact heights: whether this one is on the grid of those told before around it.
template <class Coder>
Steps CellCoder<Coder>::steps(const Here& here, const Prediction& p, std::int64_t height) {
  if (coarseness_ != kExact) return {};
  const Around a(*here.window, here.x, here.y);
  std::int32_t phase = running_.grid_height;
  for (const WindowCell* cell : {&a.nw, &a.ne, &a.n, &a.w}) {
    if (marked(*cell, kOnGrid) != 0) phase = cell->height;
  }
  const auto grid_of = [](const WindowCell& cell) { return changed(cell) + marked(cell, kOnGrid); };
  const int beside = grid_of(a.w) * 3 + grid_of(a.n);
  const bool plain = is_level_value(told_.probability);
  const int level = context_level(told_.probability) * 2 + (plain ? 1 : 0);
  const int same = (a.w.probability == told_.probability ? 1 : 0) +
                   (a.n.probability == told_.probability ? 2 : 0);
  const std::int32_t nearest = Steps{kGridMm, phase, false}.nearest(p.plane16);
  const int away = std::min(std::abs(p.plane16 - 16 * nearest) / 16, 5);
  const int spread = log2_class(std::int64_t{p.most} - p.least, 7);
  const auto& element = kElements.grid;
  mixer_.begin();
  mixer_.add(element.tables[0].at(z((beside * 3 + grid_of(a.nw)) * 3 + grid_of(a.ne))));
  mixer_.add(element.tables[1].at(z(level * 3 + grid_of(a.w))));
  mixer_.add(element.tables[2].at(z(running_.grid_history * 9 + beside)));
  mixer_.add(element.tables[3].at(z(level * 4 + same)));
  mixer_.add(element.tables[4].at(z(((away * 8 + spread) * 2 + (plain ? 1 : 0)) * 9 + beside)));
  const bool on = mixer_.code(coder_, on_one_grid(height, phase), element.first_set + z(beside),
                              element.first_set + 9 + z(level));
  running_.grid_history = (running_.grid_history * 2 + (on ? 1 : 0)) & 7;
  return on ? Steps{kGridMm, phase, false} : Steps{1, phase, true};
}

template <class Coder>
std::int64_t CellCoder<Coder>::new_height(const Here& here, std::int64_t height) {
  Prediction p = predict(*here.window, here.x, here.y);
  if (p.count == 0) {
    p.nearest = p.least = p.most = running_.last_height;
    p.plane16 = p.mean16 = p.even16 = 16 * running_.last_height;
  }
  const Steps in = steps(here, p, height);
  const std::int32_t off = (p.plane16 + 8) >> 4;
  const auto alt = alt_of(Around(*here.window, here.x, here.y), running_);
  const int clear_of = std::max(4, 60 / coarseness_.quantum_mm);  // [quanta]
  const bool alt_apart = !alt || std::abs(std::int64_t{*alt} - off) > clear_of;
  const bool far_off = std::abs(height - off) > clear_of;
  if (alt_apart && alt_mode(here, p, alt.value_or(off),
                            alt ? std::abs(height - *alt) < std::abs(height - off) : far_off)) {
    told_.marks |= kAltMode;
    const std::int64_t coded = alt_height(here, alt.value_or(off), in, height);
    running_.alt_height =
        static_cast<std::int32_t>(std::clamp<std::int64_t>(coded, -100'000'000, 100'000'000));
    return coded;
  }
  return new_height(here, p, in, height);
}

template <class Coder>
std::int64_t CellCoder<Coder>::new_height(const Here& here, const Prediction& p, const Steps& in,
                                          std::int64_t height) {
  const Around a(*here.window, here.x, here.y);
  const std::int32_t off = in.nearest(p.plane16);
  std::int32_t& error16 = running_.error16[in.fine ? 1 : 0];
  const int spread = log2_class(in.of(std::int64_t{p.most} - p.least), 9);
  const int crowd = p.count == 0 ? 0 : 1 + log2_class(p.count, 5) - 1;
  const int error = log2_class(error16 / 2, 7);
  const auto beside = [&](const WindowCell& cell) {
    return cell.known() ? 1 + held(in.of(std::int64_t{cell.height} - off), 7) : 0;
  };
  const std::int64_t beyond16 = p.plane16 - std::int64_t{16} * off + 8 * in.size;
  const auto fraction = static_cast<std::size_t>(beyond16 / (4 * in.size));
  const std::size_t misses =
      static_cast<std::size_t>(log2_class(a.w.residual, 3) * 16 + log2_class(a.n.residual, 3) * 4) +
      static_cast<std::size_t>(log2_class(a.ne.residual, 3));
  const auto eighths = [&](std::int64_t difference16) {
    return held(difference16 / (8 * in.size), 15);
  };
  const std::size_t distance = view_ ? place_of(here.x, here.y).distance : 0;
  const int sure = context_level(told_.probability);
  const auto off_grid =
      static_cast<std::size_t>(off - Steps{kGridMm, in.phase}.nearest(std::int64_t{16} * off) + 5);
  const auto& element = in.fine ? kElements.fine : kElements.fresh;
  const auto& t = element.tables;
  const auto contexts = [&](std::size_t node, std::size_t rare_node) {
    if (node >= kNodes) return mixer_.add(t[12].at(rare_node));
    mixer_.add(t[0].at(z(spread * 6 + crowd) * kNodes + node));
    mixer_.add(t[1].at((beside(a.w) * 16 + beside(a.n)) * kNodes + node));
    mixer_.add(t[2].at((eighths(16 * std::int64_t{p.nearest} - p.plane16) * 6 + z(crowd)) * kNodes +
                       node));
    mixer_.add(t[3].at((fraction * 8 + z(error)) * kNodes + node));
    mixer_.add(t[4].at(misses * kNodes + node));
    mixer_.add(t[5].at((held(in.of(std::int64_t{p.most} - off), 7) * 16 +
                        held(in.of(std::int64_t{p.least} - off), 7)) *
                           kNodes +
                       node));
    mixer_.add(
        t[6].at((eighths(std::int64_t{p.mean16} - p.plane16) * 8 + z(error)) * kNodes + node));
    mixer_.add(t[7].at((beside(a.nw) * 16 + beside(a.ne)) * kNodes + node));
    mixer_.add(
        t[8].at((eighths(std::int64_t{p.even16} - p.plane16) * 8 + z(error)) * kNodes + node));
    if (view_) mixer_.add(t[11].at(distance * kNodes + node));
    if (sure == 0) return;
    mixer_.add(t[9].at(z(sure * 10 + spread) * kNodes + node));
    if (in.fine) mixer_.add(t[10].at((off_grid * 8 + z(error)) * kNodes + node));
  };
  const std::size_t first = element.first_set;
  const std::int64_t missed =
      signed_number((height - off) / in.size, first, first + kNodes + 1 + 4 * z(crowd), contexts);
  const auto miss = static_cast<std::int32_t>(std::min<std::int64_t>(std::abs(missed), 16));
  error16 += (16 * miss - error16) / 8;
  told_.residual = static_cast<std::uint8_t>(miss);
  return off + missed * in.size;
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
std::int64_t CellCoder<Coder>::alt_height(const Here& here, std::int32_t other, const Steps& in,
                                          std::int64_t height) {
  const std::int32_t alt = in.nearest(std::int64_t{16} * other);
  const Around a(*here.window, here.x, here.y);
  const auto beside = [&](const WindowCell& cell) {
    return marked(cell, kAltMode) != 0 ? 1 + held(in.of(std::int64_t{cell.height} - alt), 7) : 0;
  };
  const int near = marked(a.w, kAltMode) + 2 * marked(a.n, kAltMode) + 4 * marked(a.ne, kAltMode) +
                   8 * marked(a.nw, kAltMode);
  const int error = log2_class(running_.error16[in.fine ? 1 : 0] / 2, 7);
  const auto& element = in.fine ? kElements.fine_alt : kElements.alt_height;
  const auto& t = element.tables;
  const auto contexts = [&](std::size_t node, std::size_t rare_node) {
    if (node >= kNodes) return mixer_.add(t[4].at(rare_node));
    mixer_.add(t[0].at(z(near) * kNodes + node));
    mixer_.add(t[1].at((beside(a.n) * 16 + beside(a.ne)) * kNodes + node));
    mixer_.add(t[2].at((z(near != 0) * 8 + z(error)) * kNodes + node));
    mixer_.add(t[3].at((beside(a.nw) * 2 + z(marked(a.w, kAltMode))) * kNodes + node));
  };
  const std::size_t first = element.first_set;
  return alt +
         in.size * signed_number((height - alt) / in.size, first, first + kNodes + 1, contexts);
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
  if (view_) {
    mixer_.add(moved.tables[5].at(place_of(here.x, here.y).distance * 8 + z(a.self.age)));
  }
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

template class CellCoder<RangeEncoder>;
template class CellCoder<RangeDecoder>;

}  // namespace cairn::proto::patch
