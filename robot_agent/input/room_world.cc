#include <numbers>

#include "robot_agent/input/built_worlds.h"
#include "robot_agent/input/paint.h"

namespace cairn::agent {
namespace {

constexpr double kSizeM = 13.0;
constexpr double kWallM = 2.5;
// The lap is the square at this distance from the walls; furniture keeps off it.
constexpr double kLapM = 2.5;
constexpr double kDeepestM = 1.4;  // Of furniture along a wall.
constexpr double kIslandM = 3.0;   // Half a side of the furnished middle; 0.95 m off the lap.

struct Furniture {
  double length_m, depth_m, height_m;
};

Furniture pick(Noise& noise) {
  switch (noise.below(4)) {
    case 0:
      return {noise.uniform(1.2, 2.0), noise.uniform(0.6, 0.9), 0.75};  // Table.
    case 1:
      return {noise.uniform(0.8, 1.6), noise.uniform(0.4, 0.6),
              noise.uniform(1.2, 1.8)};  // Cupboard.
    case 2:
      return {noise.uniform(0.4, 0.8), noise.uniform(0.4, 0.8), noise.uniform(0.3, 0.6)};  // Box.
    default:
      return {noise.uniform(0.5, 1.0), noise.uniform(0.8, kDeepestM), noise.uniform(0.5, 1.1)};
  }
}

// A spot `along` a wall and `off` it, for the four walls in turn.
Rectangle at_wall(int wall, double along, double off, const Furniture& item) {
  const double a = along + 0.5 * item.length_m;
  const double o = off + 0.5 * item.depth_m;
  switch (wall) {
    case 0:
      return {a, o, item.length_m, item.depth_m};
    case 1:
      return {kSizeM - o, a, item.depth_m, item.length_m};
    case 2:
      return {a, kSizeM - o, item.length_m, item.depth_m};
    default:
      return {o, a, item.depth_m, item.length_m};
  }
}

// On the floor, not on what stands there.
void put_on_floor(HeightRaster& surface, const Rectangle& where, double height_m) {
  paint(surface, where, [=](double, double, double old) { return std::max(old, height_m); });
}

void furnish_walls(HeightRaster& surface, Noise& noise) {
  for (int wall = 0; wall < 4; ++wall) {
    double along = noise.uniform(0.1, 1.0);
    while (true) {
      const Furniture item = pick(noise);
      if (along + item.length_m > kSizeM - 0.1) {
        break;
      }
      put_on_floor(surface, at_wall(wall, along, noise.uniform(0.0, 0.1), item), item.height_m);
      along += item.length_m + noise.uniform(0.0, 1.2);
    }
  }
}

void furnish_middle(HeightRaster& surface, Noise& noise) {
  constexpr double kMiddleM = 0.5 * kSizeM;
  for (int i = 0; i < 9; ++i) {
    const Furniture item = pick(noise);
    const double reach = kIslandM - 0.5 * std::hypot(item.length_m, item.depth_m);
    put_on_floor(surface,
                 {kMiddleM + noise.uniform(-reach, reach), kMiddleM + noise.uniform(-reach, reach),
                  item.length_m, item.depth_m, noise.uniform(0.0, std::numbers::pi)},
                 item.height_m);
  }
}

void put_walls(HeightRaster& surface) {
  paint_all(surface, [](double x, double y, double old) {
    const bool inside = x > 0.0 && y > 0.0 && x < kSizeM && y < kSizeM;
    return inside ? old : kWallM;
  });
  put_box(surface, {0.15, 8.2, 0.5, 0.5}, kWallM);  // Pillars.
  put_box(surface, {12.85, 4.9, 0.5, 0.5}, kWallM);
}

}  // namespace

World build_room(std::uint64_t seed) {
  constexpr double kCellM = 0.025;
  constexpr double kMarginM = 0.2;
  constexpr int kNodes = static_cast<int>((kSizeM + 2.0 * kMarginM) / kCellM) + 1;
  HeightRaster surface(kCellM, kNodes, kNodes, -kMarginM, -kMarginM);
  Noise noise(seed, 10);
  put_walls(surface);
  furnish_walls(surface, noise);
  furnish_middle(surface, noise);
  roughen(surface, 0.001, noise);
  return founded_at("room", std::move(surface), {.x_m = kLapM, .y_m = kLapM});
}

}  // namespace cairn::agent
