#include "core/frontier/frontier.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace cairn {
namespace {

using Word = std::uint64_t;

std::size_t words_per_row(const DrivableGrid& grid) {
  return static_cast<std::size_t>(grid.heights.width + 63) / 64;
}

/// One bit per cell of a row for which holds(x).
template <class Holds>
void pack_row(int width, Word* words, Holds&& holds) {
  for (int x0 = 0; x0 < width; x0 += 64) {
    Word word = 0;
    const int end = std::min(64, width - x0);
    for (int i = 0; i < end; ++i) word |= Word{holds(x0 + i)} << i;
    words[x0 / 64] = word;
  }
}

/// Every bit also at its left and right neighbour.
void widen(const std::vector<Word>& row, std::vector<Word>& wide) {
  const std::size_t words = row.size();
  for (std::size_t i = 0; i < words; ++i) {
    const Word before = i > 0 ? row[i - 1] >> 63 : 0;
    const Word after = i + 1 < words ? row[i + 1] << 63 : 0;
    wide[i] = row[i] | row[i] << 1 | row[i] >> 1 | before | after;
  }
}

/// Runs of flagged cells, joined where they touch (also across corners).
class Clusters {
 public:
  struct Run {
    int y;
    int first;
    int last;
  };

  void add_row(int y, const Word* words, std::size_t count) {
    const std::size_t row_begin = runs_.size();
    for (std::size_t i = 0; i < count; ++i) {
      Word word = words[i];
      while (word != 0) {
        const int first = std::countr_zero(word);
        const int length = std::countr_one(word >> first);
        add_run(y, static_cast<int>(i) * 64 + first, length, row_begin);
        word = first + length < 64 ? word & ~Word{0} << (first + length) : 0;
      }
    }
    join_with_row_before(row_begin);
    before_begin_ = row_begin;
    before_y_ = y;
  }

  [[nodiscard]] const std::vector<Run>& runs() const { return runs_; }
  [[nodiscard]] std::uint32_t root(std::uint32_t run) {
    while (parent_[run] != run) run = parent_[run] = parent_[parent_[run]];
    return run;
  }

 private:
  void add_run(int y, int first, int length, std::size_t row_begin) {
    if (runs_.size() > row_begin && runs_.back().last + 1 == first) {
      runs_.back().last += length;
      return;
    }
    parent_.push_back(static_cast<std::uint32_t>(runs_.size()));
    runs_.push_back({y, first, first + length - 1});
  }

  void join_with_row_before(std::size_t begin) {
    std::size_t other = before_begin_;
    for (std::size_t run = begin; run < runs_.size(); ++run) {
      if (before_y_ + 1 != runs_[run].y) return;
      while (other < begin && runs_[other].last + 1 < runs_[run].first) ++other;
      for (std::size_t k = other; k < begin && runs_[k].first <= runs_[run].last + 1; ++k) {
        const std::uint32_t a = root(static_cast<std::uint32_t>(k));
        const std::uint32_t b = root(static_cast<std::uint32_t>(run));
        parent_[std::max(a, b)] = std::min(a, b);
      }
    }
  }

  std::vector<Run> runs_;
  std::vector<std::uint32_t> parent_;
  std::size_t before_begin_ = 0;
  int before_y_ = -2;
};

struct Sum {
  std::uint32_t cells = 0;
  std::int64_t x = 0;
  std::int64_t y = 0;
  CellIndex nearest{0, 0};
  double distance = HUGE_VAL;
};

/// Number of unknown cells in squares, by a summed-area table in coarse blocks.
class UnknownArea {
 public:
  explicit UnknownArea(const DrivableGrid& grid)
      : columns_((grid.heights.width + kBlock - 1) / kBlock),
        rows_((grid.heights.height + kBlock - 1) / kBlock),
        sums_(static_cast<std::size_t>(columns_ + 1) * static_cast<std::size_t>(rows_ + 1)) {
    for (int y = 0; y < grid.heights.height; ++y) {
      const CellClass* row = grid.classes.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.heights.width);
      for (int column = 0; column < columns_; ++column) {
        const int end = std::min((column + 1) * kBlock, grid.heights.width);
        std::uint32_t unknown = 0;
        for (int x = column * kBlock; x < end; ++x) unknown += row[x] == CellClass::unknown;
        at(column + 1, y / kBlock + 1) += unknown;
      }
    }
    for (int y = 1; y <= rows_; ++y) {
      for (int x = 1; x <= columns_; ++x) {
        at(x, y) += at(x - 1, y) + at(x, y - 1) - at(x - 1, y - 1);
      }
    }
  }

  /// Around a cell, in whole blocks.
  [[nodiscard]] std::uint32_t around(int x, int y, int reach) {
    const auto block = [](int cell, int blocks) { return std::clamp(cell / kBlock, 0, blocks); };
    const int x0 = block(std::max(x - reach, 0), columns_);
    const int x1 = block(x + reach + kBlock, columns_);
    const int y0 = block(std::max(y - reach, 0), rows_);
    const int y1 = block(y + reach + kBlock, rows_);
    return at(x1, y1) + at(x0, y0) - at(x0, y1) - at(x1, y0);
  }

 private:
  static constexpr int kBlock = 8;

  std::uint32_t& at(int column, int row) {
    return sums_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_ + 1) + static_cast<std::size_t>(column)];
  }

  int columns_;
  int rows_;
  std::vector<std::uint32_t> sums_;
};

/// Calls visit(cluster's root, cell) for every flagged cell that the field reaches.
template <class Visit>
void each_reached(const DrivableGrid& grid, const Field& field, Clusters& clusters, Visit&& visit) {
  for (std::uint32_t i = 0; i < clusters.runs().size(); ++i) {
    const Clusters::Run run = clusters.runs()[i];
    const std::uint32_t root = clusters.root(i);
    for (int x = run.first; x <= run.last; ++x) {
      if (field.levelled[grid.ground.at(x, run.y)] < Field::kUnreached) {
        visit(root, CellIndex{x, run.y});
      }
    }
  }
}

}  // namespace

std::vector<std::uint64_t> frontier_flags(const DrivableGrid& grid) {
  const int width = grid.heights.width;
  const int height = grid.heights.height;
  const std::size_t words = words_per_row(grid);
  std::vector<Word> flags(words * static_cast<std::size_t>(height));
  std::vector<Word> unknown(words);
  std::vector<Word> below(words);
  std::vector<Word> own(words);
  std::vector<Word> above(words);
  const auto read = [&](int y, std::vector<Word>& wide) {
    const CellClass* row = grid.classes.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    pack_row(width, unknown.data(), [row](int x) { return row[x] == CellClass::unknown; });
    widen(unknown, wide);
  };
  if (height > 0) read(0, above);
  for (int y = 0; y < height; ++y) {
    below.swap(own);
    own.swap(above);
    if (y + 1 < height) {
      read(y + 1, above);
    } else {
      std::fill(above.begin(), above.end(), Word{0});
    }
    for (std::size_t i = 0; i < words; ++i) {
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + i * 64;
      const Word open = grid.ground.open_bits[grid.ground.open_word(static_cast<int>(i), y)];
      const Word near = (below[i] | own[i] | above[i]) & open;
      Word& out = flags[static_cast<std::size_t>(y) * words + i];
      out = 0;
      // Unknown ground that may be driven on is no frontier itself.
      for (Word rest = near; rest != 0; rest &= rest - 1) {
        const auto bit = static_cast<std::size_t>(std::countr_zero(rest));
        if (grid.classes[at + bit] != CellClass::unknown) out |= Word{1} << bit;
      }
    }
  }
  return flags;
}

std::vector<Frontier> find_frontiers(const DrivableGrid& grid, const Field& from_robot,
                                     const FrontierConfig& config) {
  const std::vector<Word> flags = frontier_flags(grid);
  const std::size_t words = words_per_row(grid);
  Clusters clusters;
  for (int y = 0; y < grid.heights.height; ++y) {
    clusters.add_row(y, flags.data() + static_cast<std::size_t>(y) * words, words);
  }
  std::vector<Sum> sums(clusters.runs().size());
  each_reached(grid, from_robot, clusters, [&](std::uint32_t root, CellIndex cell) {
    Sum& sum = sums[root];
    ++sum.cells;
    sum.x += cell.x;
    sum.y += cell.y;
  });
  each_reached(grid, from_robot, clusters, [&](std::uint32_t root, CellIndex cell) {
    Sum& sum = sums[root];
    const double dx = cell.x - static_cast<double>(sum.x) / sum.cells;
    const double dy = cell.y - static_cast<double>(sum.y) / sum.cells;
    if (dx * dx + dy * dy >= sum.distance) return;
    sum.distance = dx * dx + dy * dy;
    sum.nearest = cell;
  });
  UnknownArea unknown(grid);
  const double cell_m = grid.heights.cell_size_mm / 1000.0;
  const int reach = static_cast<int>(config.sight_m / cell_m);
  std::vector<Frontier> frontiers;
  for (const Sum& sum : sums) {
    if (sum.cells < static_cast<std::uint32_t>(config.min_cells)) continue;
    Frontier frontier;
    frontier.place = {grid.heights.origin.x + sum.nearest.x, grid.heights.origin.y + sum.nearest.y};
    frontier.cells = sum.cells;
    frontier.cost_m = cost_to_goal(grid, from_robot, frontier.place) * grid.unit_m();
    frontier.new_area_m2 = unknown.around(sum.nearest.x, sum.nearest.y, reach) * cell_m * cell_m;
    frontier.worth = frontier.new_area_m2 / (frontier.cost_m + config.nearness_m);
    frontiers.push_back(frontier);
  }
  std::stable_sort(frontiers.begin(), frontiers.end(),
                   [](const Frontier& a, const Frontier& b) { return a.worth > b.worth; });
  return frontiers;
}

}  // namespace cairn
