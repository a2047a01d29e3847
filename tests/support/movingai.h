#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/planner/trulla.h"

namespace cairn::test {

/// A map of the MovingAI benchmarks (Sturtevant 2012) as flat ground with blocks of 2 m; row 0 of
/// the file is row 0 of the grid. Requires: the file is one.
inline HeightGrid read_movingai_map(const std::filesystem::path& file, int cell_size_mm = 125) {
  std::ifstream in(file);
  std::string word;
  int width = 0;
  int height = 0;
  while (in >> word && word != "map") {
    if (word == "width") in >> width;
    if (word == "height") in >> height;
  }
  HeightGrid grid = empty_grid({0, 0}, {width - 1, height - 1}, cell_size_mm).value();
  for (std::size_t i = 0; i < grid.height_mm.size(); ++i) {
    char c = '@';
    in >> c;
    const bool passable = c == '.' || c == 'G' || c == 'S';
    grid.height_mm[i] = passable ? 0 : 2000;
    grid.probability[i] = 200;
  }
  return grid;
}

struct Scenario {
  CellIndex start;
  CellIndex goal;
  double length = 0.0;  ///< [cells] Of the best way in steps to the eight neighbours.

  [[nodiscard]] bool reachable() const { return length > 0.0 || start == goal; }
};

inline std::vector<Scenario> read_scenarios(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  std::vector<Scenario> scenarios;
  int bucket = 0;
  int width = 0;
  int height = 0;
  std::string map;
  Scenario s;
  while (in >> bucket >> map >> width >> height >> s.start.x >> s.start.y >> s.goal.x >> s.goal.y >>
         s.length) {
    scenarios.push_back(s);
  }
  return scenarios;
}

}  // namespace cairn::test
