#include "tests/bench/planning_worlds.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace cairn::bench {
namespace {

constexpr std::int32_t kBlockMm = 2000;

class World {
 public:
  World(int size, std::uint32_t seed)
      : random_(seed), grid_(empty_grid({0, 0}, {size - 1, size - 1}, 125).value()), size_(size) {
    std::fill(grid_.probability.begin(), grid_.probability.end(), std::uint8_t{200});
  }

  HeightGrid closed() {
    for (int i = 0; i < size_; ++i)
      at(i, 0) = at(i, size_ - 1) = at(0, i) = at(size_ - 1, i) = 9000;
    return std::move(grid_);
  }

  void scatter_blocks() {
    for (std::int32_t& h : grid_.height_mm) h = chance(0.2) ? kBlockMm : 0;
  }

  void build_city() {
    const std::vector<Lot> lots = cut_by_streets();
    std::vector<std::uint8_t> built(grid_.height_mm.size());
    for (const Lot& lot : lots) {
      if (!chance(0.12)) build_houses(lot, built);  // The others are parks.
    }
    turn(built, 0.31);
  }

  void carve_maze() {
    constexpr int kWay = 8;
    constexpr int kWall = 2;
    const int rooms = (size_ - kWall) / (kWay + kWall);
    std::fill(grid_.height_mm.begin(), grid_.height_mm.end(), kBlockMm);
    const auto join = [&](int x0, int y0, int x1, int y1) {
      level(kWall + std::min(x0, x1) * (kWay + kWall), kWall + std::min(y0, y1) * (kWay + kWall),
            std::abs(x1 - x0) * (kWay + kWall) + kWay, std::abs(y1 - y0) * (kWay + kWall) + kWay);
    };
    std::vector<bool> seen(static_cast<std::size_t>(rooms * rooms));
    std::vector<std::pair<int, int>> trail{{rooms / 2, rooms / 2}};
    seen[static_cast<std::size_t>(rooms / 2 * rooms + rooms / 2)] = true;
    while (!trail.empty()) {
      const auto [x, y] = trail.back();
      std::vector<std::pair<int, int>> next;
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const bool inside = x + dx >= 0 && y + dy >= 0 && x + dx < rooms && y + dy < rooms;
        if (inside && !seen[static_cast<std::size_t>((y + dy) * rooms + x + dx)]) {
          next.emplace_back(x + dx, y + dy);
        }
      }
      if (next.empty()) {
        trail.pop_back();
        continue;
      }
      const auto [to_x, to_y] =
          next[static_cast<std::size_t>(below(static_cast<int>(next.size())))];
      seen[static_cast<std::size_t>(to_y * rooms + to_x)] = true;
      join(x, y, to_x, to_y);
      trail.emplace_back(to_x, to_y);
    }
    for (int i = 0; i < rooms * rooms / 20; ++i) {
      const int x = below(rooms - 1);
      const int y = below(rooms - 1);
      const bool east = chance(0.5);
      join(x, y, x + (east ? 1 : 0), y + (east ? 0 : 1));
    }
  }

  void raise_hills() {
    const std::uint32_t seed = static_cast<std::uint32_t>(random_());
    for (int y = 0; y < size_; ++y) {
      for (int x = 0; x < size_; ++x)
        at(x, y) = static_cast<std::int32_t>(std::lround(hill_mm(x, y, seed)));
    }
    for (int i = 0; i < size_ * size_ / 18000; ++i) drop_rock();
    for (int i = 0; i < size_ * size_ / 18000; ++i) build_wall();
  }

 private:
  struct Lot {
    int x0, y0, x1, y1;
  };

  std::int32_t& at(int x, int y) { return grid_.height_mm[index(x, y)]; }
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] bool inside(int x, int y) const {
    return x >= 0 && y >= 0 && x < size_ && y < size_;
  }
  int below(int limit) {
    return static_cast<int>(random_() % static_cast<unsigned>(std::max(limit, 1)));
  }
  bool chance(double p) { return static_cast<double>(random_()) < p * 4294967296.0; }

  void level(int x0, int y0, int width, int height) {
    for (int y = y0; y < y0 + height; ++y) {
      for (int x = x0; x < x0 + width; ++x) at(x, y) = 0;
    }
  }

  /// Streets halve the land, roughly, until lots are small.
  std::vector<Lot> cut_by_streets() {
    std::vector<Lot> lots;
    std::vector<Lot> land{{0, 0, size_, size_}};
    while (!land.empty()) {
      const Lot lot = land.back();
      land.pop_back();
      const int width = lot.x1 - lot.x0;
      const int height = lot.y1 - lot.y0;
      const int street = 5 + below(9);
      if (std::max(width, height) < 70) {
        lots.push_back(lot);
      } else if (width >= height) {
        const int x = lot.x0 + width / 3 + below(width / 3);
        land.push_back({lot.x0, lot.y0, x, lot.y1});
        land.push_back({x + street, lot.y0, lot.x1, lot.y1});
      } else {
        const int y = lot.y0 + height / 3 + below(height / 3);
        land.push_back({lot.x0, lot.y0, lot.x1, y});
        land.push_back({lot.x0, y + street, lot.x1, lot.y1});
      }
    }
    return lots;
  }

  void build_houses(const Lot& lot, std::vector<std::uint8_t>& built) {
    const auto fill = [&](int x0, int y0, int x1, int y1, std::uint8_t value) {
      for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) built[index(x, y)] = value;
      }
    };
    const int y0 = lot.y0 + 2;
    const int y1 = lot.y1 - 2;
    for (int x = lot.x0 + 2; x < lot.x1 - 8;) {
      const int end = std::min(x + 8 + below(24), lot.x1 - 2);
      fill(x, y0, end, y1, 1);
      const bool yard = end - x > 14 && y1 - y0 > 14 && chance(0.7);
      if (yard) fill(x + 4, y0 + 4, end - 4, y1 - 4, 0);
      if (yard && chance(0.6)) fill((x + end) / 2 - 1, y0, (x + end) / 2 + 2, y0 + 4, 0);
      x = end + (chance(0.6) ? 0 : 3 + below(4));
    }
  }

  /// So that walls are not parallel to the grid.
  void turn(const std::vector<std::uint8_t>& built, double angle) {
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const auto wrap = [&](double v) {
      const int i = static_cast<int>(std::floor(v)) % size_;
      return i < 0 ? i + size_ : i;
    };
    for (int y = 0; y < size_; ++y) {
      for (int x = 0; x < size_; ++x) {
        const double dx = x - size_ / 2.0;
        const double dy = y - size_ / 2.0;
        const int from_x = wrap(size_ / 2.0 + c * dx - s * dy);
        const int from_y = wrap(size_ / 2.0 + s * dx + c * dy);
        at(x, y) = built[index(from_x, from_y)] != 0 ? kBlockMm : 0;
      }
    }
  }

  static double lattice(int x, int y, std::uint32_t seed) {
    std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9E3779B1U +
                      static_cast<std::uint32_t>(y) * 0x85EBCA77U + seed;
    h = (h ^ (h >> 15)) * 0x2C1B3C6DU;
    h = (h ^ (h >> 12)) * 0x297A2D39U;
    return (h ^ (h >> 15)) / 4294967296.0 - 0.5;
  }

  static double smooth_noise(double x, double y, std::uint32_t seed) {
    const int x0 = static_cast<int>(std::floor(x));
    const int y0 = static_cast<int>(std::floor(y));
    const auto ease = [](double t) { return t * t * (3 - 2 * t); };
    const double fx = ease(x - x0);
    const double fy = ease(y - y0);
    const double south = std::lerp(lattice(x0, y0, seed), lattice(x0 + 1, y0, seed), fx);
    const double north = std::lerp(lattice(x0, y0 + 1, seed), lattice(x0 + 1, y0 + 1, seed), fx);
    return std::lerp(south, north, fy);
  }

  static double hill_mm(int x, int y, std::uint32_t seed) {
    double height = 0.0;
    double amplitude = 4000.0;
    double scale = 1 / 480.0;
    for (std::uint32_t octave = 0; octave < 6; ++octave) {
      height += amplitude * smooth_noise(x * scale, y * scale, seed + octave);
      amplitude *= 0.42;
      scale *= 2.1;
    }
    return height;
  }

  void drop_rock() {
    const int x0 = below(size_);
    const int y0 = below(size_);
    const int radius = 2 + below(10);
    const int rock_mm = 200 + below(2200);
    for (int y = y0 - radius; y <= y0 + radius; ++y) {
      for (int x = x0 - radius; x <= x0 + radius; ++x) {
        const bool part = (x - x0) * (x - x0) + (y - y0) * (y - y0) <= radius * radius;
        if (part && inside(x, y)) at(x, y) += rock_mm;
      }
    }
  }

  void build_wall() {
    const int x0 = below(size_);
    const int y0 = below(size_);
    const double angle = below(1000) * std::numbers::pi / 1000;
    const int length = 10 + below(80);
    const std::int32_t top_mm = at(x0, y0) + 200 + below(2200);
    for (int t = 0; t < length; ++t) {
      for (int k = 0; k < 9; ++k) {
        const int x = x0 + static_cast<int>(t * std::cos(angle)) + k % 3 - 1;
        const int y = y0 + static_cast<int>(t * std::sin(angle)) + k / 3 - 1;
        if (inside(x, y)) at(x, y) = std::max(at(x, y), top_mm);
      }
    }
  }

  std::mt19937 random_;
  HeightGrid grid_;
  int size_;
};

}  // namespace

HeightGrid planning_world(const std::string& kind, int size, std::uint32_t seed) {
  World world(size, seed);
  if (kind == "random") world.scatter_blocks();
  if (kind == "city") world.build_city();
  if (kind == "maze") world.carve_maze();
  if (kind == "terrain") world.raise_hills();
  return world.closed();
}

}  // namespace cairn::bench
