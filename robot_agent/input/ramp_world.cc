#include <algorithm>
#include <numbers>

#include "robot_agent/input/built_worlds.h"
#include "robot_agent/input/paint.h"

namespace cairn::agent {
namespace {

// Along x: yard, ramp up to the platform, the platform with its sheer eastern and southern edges,
// ground again. The building stands along the north.
constexpr double kLengthM = 32.0;
constexpr double kWidthM = 16.0;
constexpr double kPlatformM = 1.0;
constexpr double kRampWestM = 11.0;
constexpr double kRampEastM = 18.5;  // 1 m over 7.5 m is 7.6°.
constexpr double kPlatformEastM = 26.0;
constexpr double kRampSouthM = 8.0;
constexpr double kPlatformSouthM = 5.0;
constexpr double kWallSouthM = 12.5;
constexpr double kKerbM = 0.15;

double ground_m(double x, double y) {
  if (y >= kWallSouthM) {
    return 0.0;
  }
  if (x >= kRampWestM && x < kRampEastM && y >= kRampSouthM) {
    return kPlatformM * (x - kRampWestM) / (kRampEastM - kRampWestM);
  }
  const bool platform = x >= kRampEastM && x < kPlatformEastM && y >= kPlatformSouthM;
  return platform ? kPlatformM : 0.0;
}

// The ramp has a kerb on its open side; the yard a raised bed. The platform's edges are bare.
void put_kerbs(HeightRaster& surface) {
  paint(surface, kRampWestM, kRampSouthM, kRampEastM, kRampSouthM + 0.2,
        [](double x, double y, double) { return ground_m(x, y) + kKerbM; });
  put_box(surface, {5.5, 1.0, 9.0, 1.2}, kKerbM);
}

void put_building(HeightRaster& surface) {
  const auto wall = [&](double x, double y, double length, double width) {
    put_box(surface, {x, y, length, width}, 5.0);
  };
  wall(0.5 * kLengthM, 0.5 * (kWallSouthM + kWidthM), kLengthM, kWidthM - kWallSouthM);
  wall(4.0, kWallSouthM, 0.8, 0.6);  // Buttresses.
  wall(9.0, kWallSouthM, 0.8, 0.6);
  put_box(surface, {22.5, kWallSouthM, 2.0, 0.5}, 3.0);
  put_box(surface, {29.5, kWallSouthM, 1.5, 1.0}, 2.5);
  const double fence = 1.8;
  put_box(surface, {0.0, 0.5 * kWidthM, 0.4, kWidthM}, fence);
  put_box(surface, {kLengthM, 0.5 * kWidthM, 0.4, kWidthM}, fence);
  put_box(surface, {0.5 * kLengthM, 0.0, kLengthM, 0.4}, fence);
}

void put_objects(HeightRaster& surface, Noise& noise) {
  for (int i = 0; i < 5; ++i) {  // Crates in the yard, south of the way to the ramp.
    put_box(surface,
            {noise.uniform(2.5, 17.0), noise.uniform(2.6, 5.5), noise.uniform(0.4, 1.2),
             noise.uniform(0.4, 1.0), noise.uniform(0.0, std::numbers::pi)},
            noise.uniform(0.3, 1.2));
  }
  for (int i = 0; i < 3; ++i) {  // Barrels on the platform, along the wall.
    put_cylinder(surface, noise.uniform(19.5, 25.0), noise.uniform(11.5, 12.0), 0.3, 0.9);
  }
  put_box(surface, {22.0, noise.uniform(6.2, 7.2), 1.4, 0.8}, 0.8);
  put_cylinder(surface, noise.uniform(28.0, 30.0), noise.uniform(3.0, 6.0), 0.15, 4.0);
  put_box(surface, {29.0, noise.uniform(7.5, 9.5), 0.9, 0.9, noise.uniform(0.0, 1.5)}, 1.0);
}

}  // namespace

World build_ramp(std::uint64_t seed) {
  constexpr double kCellM = 0.025;
  HeightRaster surface(kCellM, static_cast<int>(kLengthM / kCellM) + 1,
                       static_cast<int>(kWidthM / kCellM) + 1, 0.0, 0.0);
  Noise noise(seed, 11);
  paint_all(surface, [](double x, double y, double) { return ground_m(x, y); });
  put_kerbs(surface);
  put_objects(surface, noise);
  put_building(surface);
  roughen(surface, 0.002, noise);
  return founded_at("ramp", std::move(surface), {.x_m = 4.0, .y_m = 8.5});
}

}  // namespace cairn::agent
