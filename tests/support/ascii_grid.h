#pragma once

#include <cctype>
#include <string>
#include <vector>

#include "core/map/traversability.h"

namespace cairn::test {

/// A map drawn in characters, the first row being the north. '?' unknown, '#' a block of 2 m,
/// a digit its number of steps high, everything else ground at height 0. Letters can be looked up.
struct AsciiGrid {
  std::vector<std::string> rows;
  HeightGrid grid;

  /// The cell where `letter` was drawn.
  [[nodiscard]] CellIndex cell(char letter) const {
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const auto column = rows[row].find(letter);
      if (column != std::string::npos) return index(row, column);
    }
    return {-1, -1};
  }
  [[nodiscard]] CellIndex index(std::size_t row, std::size_t column) const {
    return {static_cast<std::int32_t>(column), static_cast<std::int32_t>(rows.size() - 1 - row)};
  }
};

inline AsciiGrid draw(const std::vector<std::string>& rows, int step_mm = 100,
                      int cell_size_mm = 125) {
  AsciiGrid drawn{rows, {}};
  const auto width = static_cast<std::int32_t>(rows.front().size());
  const auto height = static_cast<std::int32_t>(rows.size());
  drawn.grid = empty_grid({0, 0}, {width - 1, height - 1}, cell_size_mm).value();
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (std::size_t column = 0; column < rows[row].size(); ++column) {
      const char c = rows[row][column];
      const std::size_t at = drawn.grid.at(drawn.index(row, column));
      const bool digit = std::isdigit(static_cast<unsigned char>(c)) != 0;
      drawn.grid.probability[at] = c == '?' ? 0 : 200;
      drawn.grid.height_mm[at] = c == '#' ? 2000 : digit ? (c - '0') * step_mm : 0;
    }
  }
  return drawn;
}

/// Classes drawn the same way: '?' unknown, '.' free, '#' obstacle.
inline std::vector<std::string> picture(const HeightGrid& grid,
                                        const std::vector<CellClass>& classes) {
  std::vector<std::string> rows;
  for (int y = grid.height - 1; y >= 0; --y) {
    std::string row;
    for (int x = 0; x < grid.width; ++x) {
      const CellIndex cell{grid.origin.x + x, grid.origin.y + y};
      row += "?.#"[static_cast<std::size_t>(classes[grid.at(cell)])];
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace cairn::test
