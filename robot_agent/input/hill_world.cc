#include <cmath>
#include <numbers>

#include "robot_agent/input/built_worlds.h"
#include "robot_agent/input/paint.h"

namespace cairn::agent {
namespace {

constexpr double kSizeM = 100.0;

void put_rocks(HeightRaster& surface, Noise& noise) {
  for (int i = 0; i < 350; ++i) {
    // Many stones, few boulders.
    const double radius = 0.1 + 0.9 * std::pow(noise.uniform(), 3.0);
    put_rock(surface, noise.uniform(-50.0, 50.0), noise.uniform(-50.0, 50.0), radius,
             radius * noise.uniform(0.4, 1.1), noise);
  }
}

// Trees stand in groves, with a few in the open.
void put_trees(HeightRaster& surface, Noise& noise) {
  for (int grove = 0; grove < 7; ++grove) {
    const double x = noise.uniform(-45.0, 45.0);
    const double y = noise.uniform(-45.0, 45.0);
    for (int i = 0; i < 12; ++i) {
      put_tree(surface, x + 5.0 * noise.normal(), y + 5.0 * noise.normal(), noise);
    }
  }
  for (int i = 0; i < 25; ++i) {
    put_tree(surface, noise.uniform(-49.0, 49.0), noise.uniform(-49.0, 49.0), noise);
  }
}

}  // namespace

World build_hill(std::uint64_t seed) {
  constexpr double kCellM = 0.05;
  constexpr int kNodes = static_cast<int>(kSizeM / kCellM) + 1;
  HeightRaster surface(kCellM, kNodes, kNodes, -0.5 * kSizeM, -0.5 * kSizeM);
  Noise noise(seed, 12);
  Hills hills(45.0, 2.4, 4, noise);
  Hills ground(1.6, 0.03, 3, noise);
  paint_all(surface, [&](double x, double y, double) {
    return hills.height_m(x, y) + ground.height_m(x, y);
  });
  put_rocks(surface, noise);
  put_trees(surface, noise);
  roughen(surface, 0.004, noise);
  const Pose start = open_spot(surface, 0.0, 0.0, 12.0);
  return founded_at("hill", std::move(surface), start);
}

}  // namespace cairn::agent
