#include "core/delta/coarseness.h"

#include <array>
#include <cassert>
#include <cmath>
#include <cstdlib>

#include "core/delta/logistic.h"

namespace cairn {
namespace {

constexpr std::uint8_t kCertain = 255;

/// [1/256 nat] Log odds of a probability in 1/255.
int logit(std::uint8_t probability) { return stretch(probability * 65535 / 255); }

struct LevelTable {
  std::array<std::uint8_t, kMaxLevels> probability{};
  std::array<std::uint8_t, 256> level{};
};

LevelTable make_levels(int levels) {
  LevelTable table;
  const int least = logit(kLeastLevel);
  const int width = logit(kMostLevel) - least;
  const int steps = levels - 1;
  for (int level = 0; level < levels; ++level) {
    const int middle = least + (2 * width * level + steps) / (2 * steps);
    table.probability.at(static_cast<std::size_t>(level)) =
        static_cast<std::uint8_t>((squash(middle) * 255 + 32768) / 65536);
  }
  table.probability.front() = kLeastLevel;
  table.probability.at(static_cast<std::size_t>(steps)) = kMostLevel;
  for (std::size_t p = 0; p < table.level.size(); ++p) {
    const int above = logit(static_cast<std::uint8_t>(p)) - least;
    const int level = above <= 0 ? 0 : (2 * above * steps + width) / (2 * width);
    table.level.at(p) = static_cast<std::uint8_t>(std::min(level, steps));
  }
  // A level's own value is always of that level, however it was rounded.
  for (std::size_t level = 0; level < static_cast<std::size_t>(levels); ++level) {
    table.level.at(table.probability.at(level)) = static_cast<std::uint8_t>(level);
  }
  return table;
}

const LevelTable& table_of(int levels) {
  static const auto tables = [] {
    std::array<LevelTable, kMaxLevels + 1> all;
    for (int count = 2; count <= kMaxLevels; ++count) {
      all.at(static_cast<std::size_t>(count)) = make_levels(count);
    }
    return all;
  }();
  assert(levels >= 2 && levels <= kMaxLevels);
  return tables.at(static_cast<std::size_t>(levels));
}

std::int32_t nearest_multiple(std::int32_t height_mm, std::int32_t quantum_mm) {
  const std::int32_t half = quantum_mm / 2;
  const std::int32_t away = height_mm < 0 ? height_mm - half : height_mm + half;
  return away - away % quantum_mm;
}

std::uint8_t coarse_probability(std::uint8_t exact, std::uint8_t told, int levels) {
  if (levels == kExactProbability || exact == kCertain) return exact;
  const int level = level_of(exact, levels);
  if (told == 0 || told == kCertain) return probability_of(level, levels);
  const int told_level = level_of(told, levels);
  if (std::abs(level - told_level) > 1) return probability_of(level, levels);
  const int width = (logit(kMostLevel) - logit(kLeastLevel)) / (levels - 1);
  const int moved = std::abs(logit(exact) - logit(probability_of(told_level, levels)));
  const bool to_an_end = level != told_level && (exact >= kMostLevel || exact <= kLeastLevel);
  return moved >= width || to_an_end ? probability_of(level, levels) : told;
}

}  // namespace

std::string faults(const Coarseness& coarseness) {
  std::string all;
  if (coarseness.quantum_mm < 1 || coarseness.quantum_mm > 255) all = "quantum must be 1 to 255 mm";
  const bool exact = coarseness.levels == kExactProbability;
  if (!exact && (coarseness.levels < 2 || coarseness.levels > kMaxLevels)) {
    if (!all.empty()) all += "; ";
    all += "probability levels must be 2 to 16, or 0 for exact";
  }
  return all;
}

std::uint8_t probability_of(int level, int levels) {
  return table_of(levels).probability.at(static_cast<std::size_t>(level));
}

int level_of(std::uint8_t probability, int levels) {
  return table_of(levels).level.at(probability);
}

bool representable(const Cell& cell, const Coarseness& coarseness) {
  if (!cell.known()) return true;
  if (cell.height_mm % coarseness.quantum_mm != 0) return false;
  if (coarseness.levels == kExactProbability || cell.probability == kCertain) return true;
  const int level = level_of(cell.probability, coarseness.levels);
  return probability_of(level, coarseness.levels) == cell.probability;
}

Cell coarse(const Cell& exact, const Cell& told, const Coarseness& coarseness) {
  if (!exact.known()) return {};
  Cell now{told.height_mm,
           coarse_probability(exact.probability, told.probability, coarseness.levels)};
  const bool moved =
      std::abs(std::int64_t{exact.height_mm} - told.height_mm) >= coarseness.quantum_mm;
  if (!told.known() || moved) {
    now.height_mm = nearest_multiple(exact.height_mm, coarseness.quantum_mm);
  }
  return now;
}

}  // namespace cairn
