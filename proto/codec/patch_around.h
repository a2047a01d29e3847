#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "proto/codec/patch_window.h"

/// What contexts are made of.
namespace cairn::proto::patch {

constexpr std::size_t z(int value) { return static_cast<std::size_t>(value); }

/// Number of bits of a magnitude, at most `most`.
inline int log2_class(std::int64_t magnitude, int most) {
  return std::min(static_cast<int>(std::bit_width(static_cast<std::uint64_t>(magnitude))), most);
}

/// A difference held to ±most, counted from 0.
inline std::size_t held(std::int64_t difference, int most) {
  return static_cast<std::size_t>(std::clamp<std::int64_t>(difference, -most, most) + most);
}

inline int changed(const WindowCell& cell) { return cell.marks & kChanged; }
inline int marked(const WindowCell& cell, std::uint8_t mark) {
  return (cell.marks & mark) != 0 ? 1 : 0;
}
inline int fresh(const WindowCell& cell) { return cell.known() && cell.age == 1 ? 1 : 0; }

/// What lies around a cell, as far as several elements ask for it.
struct Around {
  Around(const Window& window, int x, int y)
      : self(window.at(x, y)),
        w(window.at(x - 1, y)),
        n(window.at(x, y - 1)),
        nw(window.at(x - 1, y - 1)),
        ne(window.at(x + 1, y - 1)) {}

  [[nodiscard]] int told() const { return changed(w) + changed(n) + changed(nw) + changed(ne); }

  const WindowCell& self;
  const WindowCell& w;
  const WindowCell& n;
  const WindowCell& nw;
  const WindowCell& ne;
};

/// Of at most eight bits. (A call into the compiler's library, without.)
inline constexpr auto kOnes = [] {
  std::array<std::int8_t, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = static_cast<std::int8_t>(std::popcount(i));
  }
  return table;
}();
inline int ones(int bits) { return kOnes[static_cast<std::size_t>(bits)]; }

/// The rows around a cell, bit 3 of each being its column.
class Bits {
 public:
  Bits(const Window& window, int x, int y) : window_(window), x_(x), y_(y) {}

  [[nodiscard]] int told_row(int dy) const { return seven(window_.row(y_ + dy).told); }
  /// One bit for each of the eight neighbours.
  [[nodiscard]] int eight(std::uint32_t Window::Row::*of) const {
    const int above = seven(window_.row(y_ - 1).*of) >> 2 & 7;
    const int beside = seven(window_.row(y_).*of) >> 2 & 5;
    const int below = seven(window_.row(y_ + 1).*of) >> 2 & 7;
    return above | ((beside & 1) | beside >> 1) << 3 | below << 5;
  }
  /// How many of the 25 within two cells.
  [[nodiscard]] int wide(std::uint32_t Window::Row::*of) const {
    int count = 0;
    for (int dy = -2; dy <= 2; ++dy) count += ones(seven(window_.row(y_ + dy).*of) >> 1 & 31);
    return count;
  }

 private:
  [[nodiscard]] int seven(std::uint32_t row) const {
    return static_cast<int>(row >> static_cast<unsigned>(x_)) & 127;
  }

  const Window& window_;
  int x_;
  int y_;
};

inline int known(const WindowCell& cell) { return cell.known() ? 1 : 0; }

}  // namespace cairn::proto::patch
