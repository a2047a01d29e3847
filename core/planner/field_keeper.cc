#include "core/planner/field_keeper.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/planner/wave.h"

namespace cairn {
namespace {

/// A repair that looks at more than this part of all cells takes as long as a new field: those are
/// swept, many at a time.
constexpr std::size_t kPatience = 16;
/// [cells] Changes are converted together within squares of this size: they may come from all over
/// the map.
constexpr int kGroup = 64;

GridBox grown(const GridBox& box, int by, const HeightGrid& within) {
  return {std::max(box.x0 - by, 0), std::max(box.y0 - by, 0),
          std::min(box.x1 + by, within.width - 1), std::min(box.y1 + by, within.height - 1)};
}

template <class Visit>
void each_cell(const GridBox& box, Visit&& visit) {
  for (int y = box.y0; y <= box.y1; ++y) {
    for (int x = box.x0; x <= box.x1; ++x) visit(x, y);
  }
}

/// The box with the unknown cells to its east, which carry on the lift of the last known one.
GridBox with_lift_carried(GridBox box, const HeightGrid& heights) {
  int x1 = box.x1;
  for (int y = box.y0; y <= box.y1; ++y) {
    const std::uint8_t* row = heights.probability.data() +
                              static_cast<std::size_t>(y) * static_cast<std::size_t>(heights.width);
    const std::uint8_t* known =
        std::find_if(row + box.x1 + 1, row + heights.width, [](std::uint8_t p) { return p != 0; });
    x1 = std::max(x1, static_cast<int>(known - row) - 1);
  }
  box.x1 = x1;
  return box;
}

/// The part of the heights in the box.
HeightGrid cut_out(const HeightGrid& heights, const GridBox& box) {
  const CellIndex low{heights.origin.x + box.x0, heights.origin.y + box.y0};
  const CellIndex high{heights.origin.x + box.x1, heights.origin.y + box.y1};
  HeightGrid part = empty_grid(low, high, heights.cell_size_mm).value();
  each_cell({low.x, low.y, high.x, high.y}, [&](int x, int y) {
    part.height_mm[part.at({x, y})] = heights.height_mm[heights.at({x, y})];
    part.probability[part.at({x, y})] = heights.probability[heights.at({x, y})];
  });
  return part;
}

WeightLayer cut_out(const WeightLayer& weights, const HeightGrid& heights, const GridBox& box) {
  WeightLayer part;
  if (weights.empty()) return part;
  each_cell(box, [&](int x, int y) {
    part.push_back(weights[heights.at({heights.origin.x + x, heights.origin.y + y})]);
  });
  return part;
}

}  // namespace

Result<FieldKeeper> FieldKeeper::create(DrivableGrid grid, const PlannerConfig& config,
                                        CellIndex goal) {
  Result<Field> field = compute_field(grid, goal);
  if (!field) return field.error();
  return FieldKeeper(std::move(grid), config, std::move(*field));
}

FieldKeeper::FieldKeeper(DrivableGrid grid, const PlannerConfig& config, Field field)
    : grid_(std::move(grid)),
      config_(config),
      field_(std::move(field)),
      doubted_(field_.levelled.size()) {}

void FieldKeeper::change(const std::vector<CellChange>& changes) {
  HeightGrid& heights = grid_.heights;
  std::map<std::pair<int, int>, GridBox> boxes;
  for (const CellChange& change : changes) {
    if (!heights.contains(change.cell)) continue;
    const std::size_t at = heights.at(change.cell);
    heights.height_mm[at] = change.height_mm;
    heights.probability[at] = change.probability;
    const int x = change.cell.x - heights.origin.x;
    const int y = change.cell.y - heights.origin.y;
    GridBox& box = boxes.try_emplace({x / kGroup, y / kGroup}, GridBox{x, y, x, y}).first->second;
    box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x), std::max(box.y1, y)};
  }
  std::vector<std::uint32_t> cells;
  for (const auto& [group, box] : boxes) {
    const std::vector<std::uint32_t> different = convert(box);
    cells.insert(cells.end(), different.begin(), different.end());
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  const auto goal = static_cast<std::uint32_t>(grid_.ground_at(field_.goal));
  if (std::binary_search(cells.begin(), cells.end(), goal)) {
    start_anew();
  } else {
    repair(cells);
  }
}

std::vector<std::uint32_t> FieldKeeper::convert(const GridBox& changed) {
  const HeightGrid& heights = grid_.heights;
  const int reach = reach_of_change(grid_, config_);
  const GridBox inner = grown(changed, reach, heights);
  convert_open(inner, grown(inner, reach, heights));

  // One more around: what a cell's steps are like depends on whether its neighbours are open.
  const GridBox priced = with_lift_carried(grown(inner, 1, heights), heights);
  struct Worth {
    std::int32_t lift;
    std::uint16_t price;
  };
  std::vector<Worth> before;
  each_cell(priced, [&](int x, int y) {
    const std::size_t at = grid_.ground.at(x, y);
    before.push_back({grid_.ground.lift[at], grid_.ground.price[at]});
  });
  price_ground(grid_, config_, priced);
  std::vector<std::uint32_t> different;
  auto was = before.begin();
  each_cell(priced, [&](int x, int y) {
    const std::size_t at = grid_.ground.at(x, y);
    const bool touched = x >= changed.x0 && x <= changed.x1 && y >= changed.y0 && y <= changed.y1;
    if (touched || was->lift != grid_.ground.lift[at] || was->price != grid_.ground.price[at]) {
      different.push_back(static_cast<std::uint32_t>(at));
    }
    ++was;
  });
  return different;
}

/// Classes and what is open in `box`, from the heights of `around`.
void FieldKeeper::convert_open(const GridBox& box, const GridBox& around) {
  const DrivableGrid part = make_drivable(cut_out(grid_.heights, around), config_,
                                          cut_out(grid_.weights, grid_.heights, around));
  each_cell(box, [&](int x, int y) {
    const CellIndex cell{grid_.heights.origin.x + x, grid_.heights.origin.y + y};
    grid_.classes[grid_.heights.at(cell)] = part.classes[part.heights.at(cell)];
    grid_.open[grid_.heights.at(cell)] = part.open[part.heights.at(cell)];
    if (!grid_.soft_price.empty()) {
      grid_.soft_price[grid_.heights.at(cell)] = part.soft_price[part.heights.at(cell)];
    }
  });
}

void FieldKeeper::repair(const std::vector<std::uint32_t>& cells) {
  for (const std::uint32_t cell : cells) {
    field_.levelled[cell] = grid_.ground.price[cell] != 0 ? Field::kUnreached : Field::kClosed;
  }
  const std::size_t most = 1000 + field_.levelled.size() / kPatience;
  if (!Wave(grid_, field_).repair(cells, doubted_, most)) start_anew();
}

std::size_t FieldKeeper::memory_bytes() const {
  const auto bytes = [](const auto& values) { return values.capacity() * sizeof values[0]; };
  const PricedGround& ground = grid_.ground;
  return bytes(grid_.heights.height_mm) + bytes(grid_.heights.probability) + bytes(grid_.classes) +
         bytes(grid_.open) + bytes(grid_.weights) + bytes(grid_.soft_price) + bytes(ground.lift) +
         bytes(ground.price) + bytes(ground.open_bits) + bytes(ground.level_price) +
         bytes(field_.levelled) + bytes(doubted_);
}

void FieldKeeper::start_anew() {
  field_ = unreached_field(grid_, field_.goal);
  if (why_closed(grid_, field_.goal).empty()) radiate(grid_, field_);
}

}  // namespace cairn
