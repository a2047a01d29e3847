#include "core/planner/corridor.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "core/planner/bit_coder.h"
#include "core/planner/field_walk.h"

namespace cairn {
namespace {

constexpr double kQuarters = 4.0;
/// A direction is nearly as good as the best when it costs less than this part of a cell more.
constexpr std::uint32_t kSlack = 10;

Error not_a_path() { return {ErrorCode::invalid_argument, "these bytes are no path"}; }

bool near_enough(std::int64_t value) {
  return value > -CodedPath::kFarthest && value < CodedPath::kFarthest;
}

void put_number(std::vector<std::uint8_t>& bytes, std::uint32_t value) {
  for (; value >= 128; value >>= 7) bytes.push_back(static_cast<std::uint8_t>(value | 128));
  bytes.push_back(static_cast<std::uint8_t>(value));
}

std::uint32_t zigzag(std::int32_t value) {
  const auto bits = static_cast<std::uint32_t>(value);
  return value < 0 ? ~(bits << 1) : bits << 1;
}

std::int32_t unzigzag(std::uint32_t bits) {
  return static_cast<std::int32_t>((bits & 1) != 0 ? ~(bits >> 1) : bits >> 1);
}

/// Numbers of a few bits each, the lowest first.
class BitPacker {
 public:
  explicit BitPacker(std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

  void put(std::uint32_t value, int width) {
    held_ |= std::uint64_t{value} << count_;
    count_ += width;
    for (; count_ >= 8; count_ -= 8, held_ >>= 8)
      bytes_.push_back(static_cast<std::uint8_t>(held_));
  }
  void finish() {
    if (count_ > 0) bytes_.push_back(static_cast<std::uint8_t>(held_));
  }

 private:
  std::vector<std::uint8_t>& bytes_;
  std::uint64_t held_ = 0;
  int count_ = 0;
};

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  std::optional<std::uint32_t> number() {
    std::uint32_t value = 0;
    for (unsigned shift = 0; shift < 32 && at_ < bytes_.size(); shift += 7) {
      const std::uint8_t byte = bytes_[at_++];
      value |= static_cast<std::uint32_t>(byte & 127) << shift;
      if (byte < 128) return value;
    }
    return {};
  }
  /// Requires: width ≤ 32.
  std::optional<std::uint32_t> bits(int width) {
    for (; count_ < width; count_ += 8) {
      if (at_ == bytes_.size()) return {};
      held_ |= std::uint64_t{bytes_[at_++]} << count_;
    }
    const auto value = static_cast<std::uint32_t>(held_ & ((std::uint64_t{1} << width) - 1));
    held_ >>= width;
    count_ -= width;
    return value;
  }
  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  std::uint64_t held_ = 0;
  int count_ = 0;
};

/// Whether a place lies within `reach` of a leg [1/4 cells]. Requires: all within
/// Corridor::kMaxSide cells of each other, so that nothing overflows.
bool near_leg(CellIndex place, CellIndex from, CellIndex to, std::int64_t reach) {
  const std::int64_t wx = std::int64_t{to.x} - from.x;
  const std::int64_t wy = std::int64_t{to.y} - from.y;
  const std::int64_t px = std::int64_t{place.x} - from.x;
  const std::int64_t py = std::int64_t{place.y} - from.y;
  const std::int64_t along = px * wx + py * wy;
  const std::int64_t length2 = wx * wx + wy * wy;
  if (along <= 0) return px * px + py * py <= reach * reach;
  if (along >= length2) return (px - wx) * (px - wx) + (py - wy) * (py - wy) <= reach * reach;
  const std::int64_t across = px * wy - py * wx;
  return across * across <= reach * reach * length2;
}

std::int32_t steps_between(std::int32_t a, std::int32_t b, std::int32_t most) {
  return static_cast<std::int32_t>((std::abs(std::int64_t{b} - a) + most - 1) / most);
}

}  // namespace

std::vector<Eigen::Vector2d> CodedPath::points_m() const {
  std::vector<Eigen::Vector2d> all;
  for (const CellIndex p : points) {
    all.emplace_back(p.x / kQuarters * cell_size_mm / 1000, p.y / kQuarters * cell_size_mm / 1000);
  }
  return all;
}

Result<CodedPath> quantise(const std::vector<Eigen::Vector2d>& points_m, int cell_size_mm) {
  if (points_m.size() > CodedPath::kMaxPoints || cell_size_mm <= 0 || cell_size_mm > 0xffff) {
    return Error{ErrorCode::invalid_argument, "the path has too many points, or no cell size"};
  }
  CodedPath path{cell_size_mm, {}};
  for (const Eigen::Vector2d& p : points_m) {
    const Eigen::Vector2d quarters = p * (kQuarters * 1000 / cell_size_mm);
    if (!(quarters.cwiseAbs().maxCoeff() < CodedPath::kFarthest / 2.0)) {
      return Error{ErrorCode::invalid_argument, "the path leads too far away"};
    }
    path.points.push_back({static_cast<std::int32_t>(std::lround(quarters.x())),
                           static_cast<std::int32_t>(std::lround(quarters.y()))});
  }
  return path;
}

std::vector<std::uint8_t> encode_path(const CodedPath& path) {
  std::vector<std::uint8_t> bytes;
  put_number(bytes, static_cast<std::uint32_t>(path.cell_size_mm));
  put_number(bytes, static_cast<std::uint32_t>(path.points.size()));
  if (path.points.empty()) return bytes;
  put_number(bytes, zigzag(path.points[0].x));
  put_number(bytes, zigzag(path.points[0].y));
  std::uint32_t all = 0;
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    all |= zigzag(path.points[i].x - path.points[i - 1].x);
    all |= zigzag(path.points[i].y - path.points[i - 1].y);
  }
  const int width = std::bit_width(all);
  bytes.push_back(static_cast<std::uint8_t>(width));
  BitPacker packer(bytes);
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    packer.put(zigzag(path.points[i].x - path.points[i - 1].x), width);
    packer.put(zigzag(path.points[i].y - path.points[i - 1].y), width);
  }
  packer.finish();
  return bytes;
}

Result<CodedPath> decode_path(std::span<const std::uint8_t> bytes) {
  Reader reader(bytes);
  const auto cell_size_mm = reader.number();
  const auto count = reader.number();
  if (!cell_size_mm || *cell_size_mm == 0 || *cell_size_mm > 0xffff) return not_a_path();
  if (!count || *count > CodedPath::kMaxPoints) return not_a_path();
  CodedPath path{static_cast<int>(*cell_size_mm), {}};
  std::int64_t x = 0;
  std::int64_t y = 0;
  int width = 0;
  for (std::uint32_t i = 0; i < *count; ++i) {
    const auto dx = i == 0 ? reader.number() : reader.bits(width);
    const auto dy = i == 0 ? reader.number() : reader.bits(width);
    if (!dx || !dy) return not_a_path();
    x += unzigzag(*dx);
    y += unzigzag(*dy);
    if (!near_enough(x) || !near_enough(y)) return not_a_path();
    path.points.push_back({static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)});
    if (i > 0) continue;
    const auto bits = reader.number();
    if (!bits || *bits > 32) return not_a_path();
    width = static_cast<int>(*bits);
  }
  if (!reader.at_end()) return not_a_path();
  return path;
}

CodedPath subdivided(const CodedPath& path, std::int32_t most) {
  CodedPath fine{path.cell_size_mm, {}};
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    const CellIndex to = path.points[i];
    const CellIndex from = path.points[i > 0 ? i - 1 : 0];
    const std::int64_t steps =
        std::max(steps_between(from.x, to.x, most), steps_between(from.y, to.y, most));
    for (std::int64_t k = 1; k < steps; ++k) {
      fine.points.push_back(
          {static_cast<std::int32_t>(from.x + (std::int64_t{to.x} - from.x) * k / steps),
           static_cast<std::int32_t>(from.y + (std::int64_t{to.y} - from.y) * k / steps)});
    }
    fine.points.push_back(to);
  }
  return fine;
}

Result<Corridor> Corridor::along(const CodedPath& path, int half_width) {
  if (path.points.empty() || half_width < 0 || half_width > kMaxHalfWidth) {
    return Error{ErrorCode::invalid_argument, "a corridor needs a path and a width up to 64 cells"};
  }
  const int margin = half_width + 1;
  CellIndex low = path.points.front();
  CellIndex high = low;
  for (const CellIndex p : path.points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  Corridor corridor;
  corridor.origin_ = {(low.x >> 2) - margin, (low.y >> 2) - margin};
  const std::int64_t width = std::int64_t{high.x >> 2} + margin - corridor.origin_.x + 1;
  const std::int64_t height = std::int64_t{high.y >> 2} + margin - corridor.origin_.y + 1;
  bool too_large = width > kMaxSide || height > kMaxSide;
  corridor.width_ = static_cast<int>(std::min(width, kMaxSide));
  corridor.height_ = static_cast<int>(std::min(height, kMaxSide));
  std::int64_t looked_at = 0;
  for (std::size_t i = 0; i < path.points.size() && !too_large; ++i) {
    looked_at +=
        corridor.box_of(path.points[i > 0 ? i - 1 : 0], path.points[i], half_width).cells();
    too_large = looked_at > kMaxLookedAt;
  }
  if (too_large) {
    return Error{ErrorCode::exhausted, "the path leads over too much ground for one corridor"};
  }
  corridor.direction_.assign(static_cast<std::size_t>(width * height), outside);
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    corridor.mark_near(path.points[i > 0 ? i - 1 : 0], path.points[i], half_width);
  }
  return corridor;
}

Corridor::Box Corridor::box_of(CellIndex from, CellIndex to, int half_width) const {
  const int margin = half_width + 1;
  const int x0 = (std::min(from.x, to.x) >> 2) - origin_.x - margin;
  const int y0 = (std::min(from.y, to.y) >> 2) - origin_.y - margin;
  const int x1 = (std::max(from.x, to.x) >> 2) - origin_.x + margin;
  const int y1 = (std::max(from.y, to.y) >> 2) - origin_.y + margin;
  return {std::max(x0, 0), std::max(y0, 0), std::min(x1, width_ - 1), std::min(y1, height_ - 1)};
}

void Corridor::mark_near(CellIndex from, CellIndex to, int half_width) {
  const Box box = box_of(from, to, half_width);
  for (int y = box.y0; y <= box.y1; ++y) {
    for (int x = box.x0; x <= box.x1; ++x) {
      const CellIndex middle{4 * (origin_.x + x) + 2, 4 * (origin_.y + y) + 2};
      if (near_leg(middle, from, to, 4 * std::int64_t{half_width})) at(x, y) = no_way;
    }
  }
}

std::uint8_t Corridor::direction(CellIndex cell) const {
  const std::int64_t x = std::int64_t{cell.x} - origin_.x;
  const std::int64_t y = std::int64_t{cell.y} - origin_.y;
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return outside;
  return direction_[static_cast<std::size_t>(y * width_ + x)];
}

void Corridor::fill(const DrivableGrid& grid, const Field& field) {
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      if (at(x, y) == outside) continue;
      const CellIndex cell{origin_.x + x, origin_.y + y};
      const bool reached = cost_to_goal(grid, field, cell) != kNoWay;
      at(x, y) = cell == field.goal ? std::uint8_t{at_goal}
                 : reached          ? way_on(grid, field, cell)
                                    : std::uint8_t{no_way};
    }
  }
}

/// The neighbours' direction where that is nearly as good as the best, else the best.
std::uint8_t Corridor::way_on(const DrivableGrid& grid, const Field& field, CellIndex cell) const {
  const std::uint32_t own = cost_to_goal(grid, field, cell);
  const std::uint32_t good = own + kCellUnits / kSlack;
  for (const CellIndex beside : {CellIndex{cell.x - 1, cell.y}, CellIndex{cell.x, cell.y - 1}}) {
    const std::uint8_t d = direction(beside);
    if (d >= at_goal) continue;
    const std::uint32_t step = step_cost(grid, cell, d);
    const std::uint32_t left = cost_to_goal(grid, field, {cell.x + kStepX[d], cell.y + kStepY[d]});
    if (step != kNoWay && left < own && step + left <= good) return d;
  }
  return static_cast<std::uint8_t>(first_step_down(grid, field, cell));
}

std::size_t Corridor::cells() const {
  return direction_.size() -
         static_cast<std::size_t>(std::count(direction_.begin(), direction_.end(), outside));
}

/// Each cell in turn: as the one to the west, else as the one to the south, else one of ten, told
/// apart by what the two are. `coder(chance, bit)` codes a bit and returns it. False when it made
/// one that is no direction.
template <class Coder>
bool Corridor::code(Coder&& coder) {
  bool sound = true;
  constexpr std::size_t kKinds = 11;
  constexpr std::size_t kNodes = 16;
  std::vector<BitChance> as_west(kKinds * kKinds * kKinds);
  std::vector<BitChance> as_south(kKinds * kKinds);
  std::vector<BitChance> tree(kKinds * kNodes);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      std::uint8_t& own = at(x, y);
      if (own == outside) continue;
      const std::uint8_t west = x > 0 ? at(x - 1, y) : std::uint8_t{outside};
      const std::uint8_t south = y > 0 ? at(x, y - 1) : std::uint8_t{outside};
      const std::uint8_t beside =
          y > 0 && x + 1 < width_ ? at(x + 1, y - 1) : std::uint8_t{outside};
      const std::size_t both = west * kKinds + south;
      if (west != outside && coder(as_west[both * kKinds + beside], own == west)) {
        own = west;
        continue;
      }
      if (south != outside && south != west && coder(as_south[both], own == south)) {
        own = south;
        continue;
      }
      std::size_t node = 1;
      for (int bit = 3; bit >= 0; --bit) {
        node = node * 2 + (coder(tree[west * kNodes + node], (own >> bit & 1) != 0) ? 1 : 0);
      }
      const auto value = static_cast<std::uint8_t>(node & 15);
      sound = sound && value < outside;
      own = std::min(value, std::uint8_t{no_way});
    }
  }
  return sound;
}

std::vector<std::uint8_t> Corridor::encode() const {
  BitEncoder encoder;
  Corridor copy = *this;
  (void)copy.code([&](BitChance& chance, bool bit) {
    encoder.put(chance, bit);
    return bit;
  });
  return encoder.finish();
}

Status Corridor::decode(std::span<const std::uint8_t> bytes) {
  BitDecoder decoder(bytes);
  const bool sound = code([&](BitChance& chance, bool) { return decoder.get(chance); });
  if (!sound || !decoder.at_end()) {
    return Error{ErrorCode::invalid_argument, "these bytes are no corridor of this path"};
  }
  return {};
}

}  // namespace cairn
