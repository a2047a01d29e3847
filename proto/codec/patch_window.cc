#include "proto/codec/patch_window.h"

#include <algorithm>

namespace cairn::proto::patch {
namespace {

constexpr std::uint8_t kCertainLevel = 17;
constexpr WindowCell kNothing{.age = kUnknownAge};

std::int32_t quanta(std::int32_t height_mm, int quantum_mm) {
  const std::int32_t half = quantum_mm / 2;
  return (height_mm < 0 ? height_mm - half : height_mm + half) / quantum_mm;
}

}  // namespace

std::uint8_t age_class(std::uint8_t age) {
  if (age < 3) return age;
  if (age < 5) return 3;
  if (age < 9) return 4;
  return age < 21 ? 5 : 6;
}

std::uint8_t context_level(std::uint8_t probability) {
  if (probability == 0) return 0;
  if (probability == 255) return kCertainLevel;
  return static_cast<std::uint8_t>(1 + level_of(probability, kMaxLevels));
}

bool is_level_value(std::uint8_t probability) {
  return probability != 0 && representable({0, probability}, {1, kMaxLevels});
}

void Window::tell(int x, int y, const WindowCell& cell) {
  cells_[index(x, y)] = cell;
  mark(x, y);
}

void Window::mark(int x, int y) {
  const WindowCell& cell = at(x, y);
  Row& row = rows_[static_cast<std::size_t>(y + kMargin)];
  const std::uint32_t bit = 1U << static_cast<unsigned>(x + kMargin);
  const auto set = [bit](std::uint32_t& bits, bool is) { bits = is ? bits | bit : bits & ~bit; };
  set(row.known, cell.known());
  set(row.recent, cell.known() && cell.age == 1);
  set(row.told, (cell.marks & kChanged) != 0);
}

void Window::put(int dx, int dy, const BlockCells* cells) {
  const auto range = [](int d) {
    return std::pair{d < 0 ? -kMargin : d * kBlockSize,
                     d > 0 ? kBlockSize + kMargin : (d + 1) * kBlockSize};
  };
  const auto [x0, x1] = range(dx);
  const auto [y0, y1] = range(dy);
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      WindowCell& cell = cells_[index(x, y)];
      const int from = (y - dy * kBlockSize) * kBlockSize + x - dx * kBlockSize;
      cell = cells == nullptr ? kNothing : (*cells)[static_cast<std::size_t>(from)];
      mark(x, y);
    }
  }
}

Window::BlockCells Window::middle() const {
  BlockCells cells;
  for (int i = 0; i < kBlockCells; ++i) {
    cells[static_cast<std::size_t>(i)] = at(i % kBlockSize, i / kBlockSize);
  }
  return cells;
}

Window::BlockCells cells_of(const ContextImage::Block& block, std::uint8_t tick,
                            const Coarseness& coarseness) {
  Window::BlockCells cells;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const ContextImage::SeenCell& from = block.cells[i];
    WindowCell& cell = cells[i];
    cell.age = kUnknownAge;
    if (from.probability == 0) continue;
    cell.height = quanta(from.height_mm, coarseness.quantum_mm);
    cell.probability = from.probability;
    cell.level = context_level(from.probability);
    cell.age = age_class(static_cast<std::uint8_t>(tick - from.tick));
    cell.updates = std::min<std::uint8_t>(from.updates, 7);
  }
  return cells;
}

WindowCell told_cell(const WindowCell& before, const Cell& now, const Coarseness& coarseness) {
  WindowCell cell = before;
  cell.marks |= kChanged;
  cell.probability = now.probability;
  cell.level = context_level(now.probability);
  if (!now.known()) {
    cell.marks |= kCleared;
    return cell;
  }
  cell.height = quanta(now.height_mm, coarseness.quantum_mm);
  return cell;
}

}  // namespace cairn::proto::patch
