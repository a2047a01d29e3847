#include "proto/codec/patch_cells.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "proto/codec/patch_around.h"

// Which cells of a block changed; their values are in patch_values.cc.
namespace cairn::proto::patch {
namespace {

constexpr int kHalf = kBlockSize / 2;

}  // namespace

// ---- Numbers ------------------------------------------------------------------------------------

template <class Coder>
bool CellCoder<Coder>::rare(bool bit, std::size_t context) {
  mixer_.begin();
  mixer_.add(kElements.rare.tables[0].at(context));
  return mixer_.code(coder_, bit, kElements.rare.first_set, kElements.rare.first_set);
}

template <class Coder>
std::uint32_t CellCoder<Coder>::raw(std::uint32_t value, int bits) {
  std::uint32_t coded = 0;
  for (int bit = bits - 1; bit >= 0; --bit) {
    coded = coded * 2 + (coder_.code(((value >> bit) & 1U) != 0, 32768) ? 1 : 0);
  }
  return coded;
}

// ---- Which cells --------------------------------------------------------------------------------

template <class Coder>
bool CellCoder<Coder>::code_block(Window& window, BlockDelta& delta) {
  std::array<bool, 4> quarters{};
  for (int q = 0; q < 4; ++q) {
    bool any = false;
    for (int i = 0; i < kBlockCells; ++i) {
      const int of = (i % kBlockSize) / kHalf + 2 * (i / kBlockSize / kHalf);
      any = any || (of == q && delta.changed[z(i)]);
    }
    quarters[z(q)] = quarter(window, q, quarters.data(), any);
  }
  int in_block = 0;
  for (int i = 0; i < kBlockCells; ++i) {
    const Here here{&window, i % kBlockSize, i / kBlockSize};
    if (!quarters[z(here.x / kHalf + 2 * (here.y / kHalf))]) continue;
    const bool is = mask(here, delta.changed[z(i)], in_block);
    delta.changed[z(i)] = is;
    if (!is) continue;
    ++in_block;
    if (!code_cell(here, delta.cells[z(i)], delta.datum_mm)) return false;
  }
  return true;
}

template <class Coder>
bool CellCoder<Coder>::code_plain_block(BlockDelta& delta) {
  constexpr int kHeightBits = 17;
  constexpr std::int32_t kOffset = 1 << 16;
  for (std::size_t i = 0; i < kBlockCells; ++i) {
    delta.changed[i] = raw(delta.changed[i] ? 1 : 0, 1) != 0;
    if (!delta.changed[i]) continue;
    Cell& cell = delta.cells[i];
    cell.probability = static_cast<std::uint8_t>(raw(cell.probability, 8));
    if (cell.probability == 0) {
      cell = {};
      continue;
    }
    const auto above = static_cast<std::uint32_t>(cell.height_mm - delta.datum_mm + kOffset);
    const auto coded = static_cast<std::int32_t>(raw(above % (2 * kOffset), kHeightBits)) - kOffset;
    if (std::abs(coded) > Tile::kHeightLimitMm) return false;
    cell.height_mm = delta.datum_mm + coded;
    if (!HeightMap::storable(cell.height_mm)) return false;
  }
  return true;
}

template <class Coder>
bool CellCoder<Coder>::quarter(const Window& window, int q, const bool* coded, bool is) {
  const int x0 = (q % 2) * kHalf;
  const int y0 = (q / 2) * kHalf;
  int recent = 0;
  int seen = 0;
  for (int y = y0; y < y0 + kHalf; ++y) {
    for (int x = x0; x < x0 + kHalf; ++x) {
      recent += fresh(window.at(x, y));
      seen += known(window.at(x, y));
    }
  }
  int edge = 0;  // Changes just above and to the left.
  for (int i = 0; i < kHalf; ++i) {
    edge += changed(window.at(x0 + i, y0 - 1)) + changed(window.at(x0 - 1, y0 + i));
  }
  const int before =
      (q > 0 ? coded[0] : 0) + (q > 1 ? 2 * coded[1] : 0) + (q > 2 ? 4 * coded[2] : 0);
  const int recent_class = log2_class(recent, 7);
  const int seen_class = log2_class(seen, 7);
  const int edge_class = log2_class(edge, 3);
  const auto& element = kElements.quarter;
  mixer_.begin();
  mixer_.add(element.tables[0].at(z(recent_class * 8 + before)));
  mixer_.add(element.tables[1].at(z((edge_class * 4 + q) * 8 + before)));
  mixer_.add(element.tables[2].at(z((recent_class * 8 + seen_class) * 4 + edge_class)));
  mixer_.add(element.tables[3].at(z(seen_class * 8 + before)));
  if (view_) {
    const Place place = place_of(x0 + kHalf / 2, y0 + kHalf / 2);
    mixer_.add(
        element.tables[4].at((place.polar() * 2 + (recent > 0 ? 1 : 0)) * 4 + z(edge_class)));
    mixer_.add(element.tables[5].at(place.square() * 2 + (seen > 0 ? 1 : 0)));
  }
  return mixer_.code(coder_, is, element.first_set + z(q), element.first_set + 4 + z(recent_class));
}

template <class Coder>
bool CellCoder<Coder>::mask(const Here& here, bool is, int in_block) {
  const Window& window = *here.window;
  const Around a(window, here.x, here.y);
  const Bits bits(window, here.x, here.y);
  const int self = known(a.self);
  const int told = a.told();
  const int near = (bits.told_row(0) >> 2 & 1) | (bits.told_row(-1) >> 3 & 1) << 1 |
                   (bits.told_row(-1) >> 2 & 1) << 2 | (bits.told_row(-1) >> 4 & 1) << 3;
  const int far = (bits.told_row(0) >> 1 & 1) | (bits.told_row(-2) >> 3 & 1) << 1 |
                  (bits.told_row(-1) >> 5 & 1) << 2 | (bits.told_row(-1) >> 1 & 1) << 3;
  const int west = bits.told_row(0) & 7;  // The three before it in the row.
  const int recent8 = bits.eight(&Window::Row::recent);
  const int known8 = bits.eight(&Window::Row::known);
  const int recent = ones(recent8) + fresh(a.self);
  const int wide_recent = bits.wide(&Window::Row::recent);
  const int wide_known = bits.wide(&Window::Row::known);
  const int age = a.self.age;
  const int done = log2_class(in_block, 7);
  const auto& t = kElements.mask.tables;
  mixer_.begin();
  mixer_.add(t[0].at(z((far * 16 + near) * 2 + self)));
  mixer_.add(t[1].at(z((a.self.level * 8 + age) * 5 + told)));
  mixer_.add(t[2].at(z((known8 * 2 + self) * 5 + told)));
  mixer_.add(t[3].at(z(((recent * 5 + told) * 2 + self) * 8 + age)));
  mixer_.add(t[4].at(z((bits.told_row(-1) * 4 + (west >> 1)) * 2 + self)));
  mixer_.add(t[5].at(z(((a.self.level * 10 + recent) * 3 + std::min(told, 2)) * 2 + (near & 1))));
  mixer_.add(t[6].at(z(((done * 8 + west) * 4 + here.y / 4) * 2 + self)));
  mixer_.add(t[7].at(
      z(((std::min(wide_recent / 2, 7) * 8 + std::min((wide_known + 1) / 3, 7)) * 5 + told) * 5 +
        std::min(age, 4))));
  mixer_.add(t[8].at(z((recent8 * 2 + (told > 0)) * 2 + (age <= 1))));
  mixer_.add(t[9].at(z(((near * 8 + age) * 8 + a.self.updates) * 2 + (recent > 2))));
  if (view_) {
    const Place place = place_of(here.x, here.y);
    mixer_.add(t[10].at((place.square() * 2 + z(self)) * 3 + z(std::min(told, 2))));
    mixer_.add(t[11].at((place.polar() * 2 + z(self)) * 2 + (recent > 0 ? 1 : 0)));
    mixer_.add(t[12].at((place.distance * 5 + z(told)) * 8 + z(age)));
  }
  const std::size_t first = kElements.mask.first_set;
  return mixer_.code(coder_, is, first + z(self * 5 + told),
                     first + 10 + z(age * 4 + std::min(recent, 3)));
}

template class CellCoder<RangeEncoder>;
template class CellCoder<RangeDecoder>;

}  // namespace cairn::proto::patch
