#include "core/planner/tile_wave.h"

#include <cstring>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

namespace cairn {
namespace {

constexpr int kSize = FieldTile::kSize;
constexpr int kPlaneRows = TilePlane::kRows;

/// Some of one row's cells, the first ones, into a plane; the others become `rest`.
void copy_row(const std::int32_t* from, std::int32_t* to, int cells, std::int32_t rest) {
  if (cells == kPlaneRows) {
    std::memcpy(to, from, kPlaneRows * sizeof *to);
    return;
  }
  std::copy_n(from, cells, to);
  std::fill(to + cells, to + kPlaneRows, rest);
}

}  // namespace

TileWave::TileWave(const DrivableGrid& grid, Field& field, const FieldKernels& kernels)
    : grid_(grid),
      ground_(grid.ground),
      reader_(grid),
      field_(field),
      kernels_(kernels),
      columns_((field.width + kSize - 1) / kSize),
      rows_((field.height + kSize - 1) / kSize),
      news_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)),
      tile_(std::make_unique<FieldTile>()) {}

void TileWave::radiate() {
  const int tx = (field_.goal.x - field_.origin.x) / kSize;
  const int ty = (field_.goal.y - field_.origin.y) / kSize;
  news_of(tx, ty)->inside = true;
  note(tx, ty, 0);
  while (!due_.empty()) {
    const Due due = due_.top();
    due_.pop();
    if (news_[static_cast<std::size_t>(due.tile)].cheapest == due.cheapest) solve(due.tile);
  }
}

void TileWave::solve(int tile) {
  const int tx = tile % columns_;
  const int ty = tile / columns_;
  const News news = std::exchange(news_[static_cast<std::size_t>(tile)], News{});
  const Edges before = edges(tx, ty);
  if (news.inside) field_.levelled[grid_.ground_at(field_.goal)] = 0;
  if (ground_.uneven && has_uneven(tx, ty)) {
    solve_uneven(tx, ty, news);
  } else {
    load(tx, ty);
    load_news(news);
    kernels_.solve(*tile_);
    store(tx, ty);
  }
  tell_neighbours(tx, ty, before);
}

void TileWave::load(int tx, int ty) {
  FieldTile& tile = *tile_;
  const int cells = std::min(kPlaneRows, field_.width - tx * kSize + 2);
  const std::uint16_t* price = ground_.price.data();
  tile.price =
      ground_.level_price[static_cast<std::size_t>(ty) * static_cast<std::size_t>(columns_) +
                          static_cast<std::size_t>(tx)];
  tile.level = tile.price != 0;
  for (int r = 0; r < kPlaneRows; ++r) {
    const int y = ty * kSize + r - 1;
    const bool there = y <= field_.height;
    const std::size_t from = ground_.at(tx * kSize - 1, there ? y : 0);
    const int count = there ? cells : 0;
    const auto to = static_cast<std::size_t>(TilePlane::at(-1, r));
    copy_row(field_.levelled.data() + from, tile.upright.levelled.data() + to, count,
             Field::kClosed);
    const auto row = static_cast<std::size_t>(r);
    const std::size_t word = ground_.open_word(tx, there ? y : -1);
    tile.upright.open[row] = ground_.open_bits[word];
    tile.upright.open_before[row] = static_cast<std::uint8_t>(ground_.open_bits[word - 1] >> 63);
    tile.upright.open_after[row] = static_cast<std::uint8_t>(ground_.open_bits[word + 1] & 1);
    if (tile.level) continue;
    copy_row(ground_.lift.data() + from, tile.upright.lift.data() + to, count, 0);
    std::copy_n(price + from, count, tile.upright.price.data() + to);
    std::fill_n(tile.upright.price.data() + to + count, kPlaneRows - count, 0);
  }
  std::array<RowBits, kSize> open;
  std::copy_n(tile.upright.open.begin() + 1, kSize, open.begin());
  transpose_bits(open);
  std::copy_n(open.begin(), kSize, tile.transposed.open.begin() + 1);
  const auto column = [&](const std::array<std::uint8_t, kPlaneRows>& bits) {
    RowBits all = 0;
    for (std::size_t i = 0; i < kSize; ++i) all |= RowBits{bits[i + 1]} << i;
    return all;
  };
  tile.transposed.open[0] = column(tile.upright.open_before);
  tile.transposed.open[kSize + 1] = column(tile.upright.open_after);
  for (std::size_t i = 0; i < kSize; ++i) {
    tile.transposed.open_before[i + 1] = static_cast<std::uint8_t>(tile.upright.open[0] >> i & 1);
    tile.transposed.open_after[i + 1] =
        static_cast<std::uint8_t>(tile.upright.open[kSize + 1] >> i & 1);
  }
  tile.transposed.open_before[0] = tile.upright.open_before[0];
  tile.transposed.open_after[0] = tile.upright.open_before[kSize + 1];
  tile.transposed.open_before[kSize + 1] = tile.upright.open_after[0];
  tile.transposed.open_after[kSize + 1] = tile.upright.open_after[kSize + 1];
}

void TileWave::load_news(const News& news) {
  const auto plane = [&](TilePlane& p, RowBits low, RowBits high, RowBits before, RowBits after,
                         const std::uint8_t(&corner)[4]) {
    TileNews all;
    for (std::size_t i = 0; i < kSize; ++i) {
      all.row[i + 1] = news.inside ? ~RowBits{0} : 0;
      all.before[i + 1] = static_cast<std::uint8_t>(before >> i & 1);
      all.after[i + 1] = static_cast<std::uint8_t>(after >> i & 1);
    }
    p.forth = p.back = all;
    p.forth.row[0] = low;
    p.forth.before[0] = corner[0];
    p.forth.after[0] = corner[1];
    p.back.row[kSize + 1] = high;
    p.back.before[kSize + 1] = corner[2];
    p.back.after[kSize + 1] = corner[3];
  };
  const auto bit = [&](int i) { return static_cast<std::uint8_t>(news.corners >> i & 1); };
  plane(tile_->upright, news.south, news.north, news.west, news.east,
        {bit(0), bit(1), bit(2), bit(3)});
  plane(tile_->transposed, news.west, news.east, news.south, news.north,
        {bit(0), bit(2), bit(1), bit(3)});
}

void TileWave::store(int tx, int ty) {
  const int columns = std::min(kSize, field_.width - tx * kSize);
  const int rows = std::min(kSize, field_.height - ty * kSize);
  for (int y = 0; y < rows; ++y) {
    std::memcpy(field_.levelled.data() + ground_.at(tx * kSize, ty * kSize + y),
                tile_->upright.levelled.data() + TilePlane::at(0, y + 1),
                static_cast<std::size_t>(columns) * sizeof(std::int32_t));
  }
}

bool TileWave::has_uneven(int tx, int ty) const {
  const int columns = std::min(kSize, field_.width - tx * kSize);
  for (int y = ty * kSize; y < std::min((ty + 1) * kSize, field_.height); ++y) {
    const std::uint16_t* price = ground_.price.data() + ground_.at(tx * kSize, y);
    std::uint16_t any = 0;
    for (int x = 0; x < columns; ++x) any |= price[x];
    if ((any & PricedGround::kUneven) != 0) return true;
  }
  return false;
}

/// From everything in the tile that there is news beside: in waves, each of the cells that the one
/// before lowered.
void TileWave::solve_uneven(int tx, int ty, const News&) {
  const int x1 = std::min((tx + 1) * kSize, field_.width);
  const int y1 = std::min((ty + 1) * kSize, field_.height);
  const auto stride = static_cast<std::size_t>(ground_.stride);
  // In the order of true costs, whatever was levelled: in any other, cells next to unknown ground,
  // where no effort counts, are bettered again and again.
  using Waiting = std::pair<std::int32_t, std::size_t>;
  std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>> wave;
  const auto key = [&](std::size_t cell) {
    return field_.levelled[cell] - ground_.one_way_effort(cell);
  };
  const auto offer = [&](std::size_t cell) {
    const std::int32_t old = field_.levelled[cell];
    if (old == Field::kClosed) return;
    const std::int32_t now = reader_.cost_by_neighbours(field_.levelled.data(), cell);
    if (now >= old || cell == grid_.ground_at(field_.goal)) return;
    field_.levelled[cell] = now;
    wave.emplace(key(cell), cell);
  };
  for (int y = ty * kSize; y < y1; ++y) {
    for (int x = tx * kSize; x < x1; ++x) offer(ground_.at(x, y));
  }
  while (!wave.empty()) {
    const auto [cost, cell] = wave.top();
    wave.pop();
    if (cost != key(cell)) continue;  // It was bettered since.
    for (int d = 0; d < 8; ++d) {
      const std::size_t other = cell + static_cast<std::size_t>(reader_.step(d));
      const int x = static_cast<int>(other % stride) - 1;
      const int y = static_cast<int>(other / stride) - 1;
      if (x >= tx * kSize && x < x1 && y >= ty * kSize && y < y1) offer(other);
    }
  }
}

TileWave::Edges TileWave::edges(int tx, int ty) const {
  Edges edges;
  const std::int32_t* levelled = field_.levelled.data();
  for (auto& edge : edges.cell) std::fill(std::begin(edge), std::end(edge), Field::kClosed);
  const int columns = std::min(kSize, field_.width - tx * kSize);
  const int rows = std::min(kSize, field_.height - ty * kSize);
  const std::size_t south = ground_.at(tx * kSize, ty * kSize);
  std::copy_n(levelled + south, columns, edges.cell[0]);
  if (rows == kSize)
    std::copy_n(levelled + ground_.at(tx * kSize, ty * kSize + kSize - 1), columns, edges.cell[1]);
  for (int i = 0; i < rows; ++i) {
    const std::int32_t* row =
        levelled + south + static_cast<std::size_t>(i) * static_cast<std::size_t>(ground_.stride);
    edges.cell[2][i] = row[0];
    if (columns == kSize) edges.cell[3][i] = row[kSize - 1];
  }
  return edges;
}

void TileWave::tell_neighbours(int tx, int ty, const Edges& before) {
  const Edges now = edges(tx, ty);
  constexpr int kDx[4] = {0, 0, -1, 1};
  constexpr int kDy[4] = {-1, 1, 0, 0};
  constexpr RowBits News::*kSides[4] = {&News::north, &News::south, &News::east, &News::west};
  RowBits lowered[4] = {};
  for (int side = 0; side < 4; ++side) {
    std::int32_t cheapest = Field::kUnreached;
    for (int i = 0; i < kSize; ++i) {
      if (now.cell[side][i] == before.cell[side][i]) continue;
      lowered[side] |= RowBits{1} << i;
      cheapest = std::min(cheapest, now.cell[side][i]);
    }
    wake(tx + kDx[side], ty + kDy[side], cheapest, kSides[side], lowered[side]);
  }
  const auto corner = [&](int side, int i, int dx, int dy, std::uint8_t bit) {
    if ((lowered[side] >> i & 1) != 0) wake_corner(tx + dx, ty + dy, now.cell[side][i], bit);
  };
  corner(0, 0, -1, -1, 8);
  corner(0, kSize - 1, 1, -1, 4);
  corner(1, 0, -1, 1, 2);
  corner(1, kSize - 1, 1, 1, 1);
}

TileWave::News* TileWave::news_of(int tx, int ty) {
  if (tx < 0 || ty < 0 || tx >= columns_ || ty >= rows_) return nullptr;
  return &news_[static_cast<std::size_t>(ty) * static_cast<std::size_t>(columns_) +
                static_cast<std::size_t>(tx)];
}

void TileWave::wake(int tx, int ty, std::int32_t cheapest, RowBits News::*side, RowBits bits) {
  News* news = news_of(tx, ty);
  if (news == nullptr || bits == 0) return;
  news->*side |= bits;
  note(tx, ty, cheapest);
}

void TileWave::wake_corner(int tx, int ty, std::int32_t cheapest, std::uint8_t corner) {
  News* news = news_of(tx, ty);
  if (news == nullptr) return;
  news->corners |= corner;
  note(tx, ty, cheapest);
}

void TileWave::note(int tx, int ty, std::int32_t cheapest) {
  News* news = news_of(tx, ty);
  if (cheapest >= news->cheapest) return;
  news->cheapest = cheapest;
  due_.push({cheapest, ty * columns_ + tx});
}

}  // namespace cairn
