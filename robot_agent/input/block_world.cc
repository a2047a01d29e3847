#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "robot_agent/input/built_worlds.h"
#include "robot_agent/input/paint.h"

namespace cairn::agent {
namespace {

constexpr double kSizeM = 100.0;
constexpr double kHalfM = 0.5 * kSizeM;
constexpr double kRoadHalfM = 3.5;
constexpr double kPavementM = 2.5;  // Its width beside a road.
constexpr double kKerbM = 0.13;
constexpr double kLoweredM = 0.02;  // What is left of the kerb at a crossing.
constexpr double kCrossingM = 8.0;  // From the middle of a junction to its crossings.
constexpr std::array<double, 2> kRoadsM = {-22.0, 22.0};  // Two each way.

// Distance to the nearest of the roads that cross this coordinate.
double to_road_m(double coordinate) {
  return std::min(std::abs(coordinate - kRoadsM[0]), std::abs(coordinate - kRoadsM[1]));
}

// 1 in the middle of a crossing, where kerbs are lowered, 0 away from it; 0.5 m of transition.
double lowering(double along_m) {
  return std::clamp((1.5 - std::abs(to_road_m(along_m) - kCrossingM)) / 0.5, 0.0, 1.0);
}

// Height of roads and pavements above the sloping ground.
double paving_m(double x, double y) {
  const double to_ns = to_road_m(x);
  const double to_ew = to_road_m(y);
  const double off = std::min(to_ns, to_ew);
  if (off < kRoadHalfM) {
    return -0.02 * std::pow(off / kRoadHalfM, 2.0);  // Cambered.
  }
  const double lowered = lowering(to_ns < to_ew ? y : x);
  const double ramp = std::clamp((off - kRoadHalfM) / 1.2, 0.0, 1.0);
  const double low = std::lerp(kLoweredM, kKerbM, ramp);
  return std::lerp(kKerbM, low, lowered);
}

void put_ground(HeightRaster& surface, Noise& noise) {
  Hills swell(60.0, 0.8, 1, noise);
  Hills lawn(2.0, 0.02, 3, noise);
  const double east = noise.uniform(-0.015, 0.015);
  const double north = noise.uniform(-0.015, 0.015);
  paint_all(surface, [&](double x, double y, double) {
    const double off = std::min(to_road_m(x), to_road_m(y)) - kRoadHalfM - kPavementM;
    const double rough = std::clamp(off, 0.0, 1.0);
    return east * x + north * y + swell.height_m(x, y) + paving_m(x, y) +
           rough * lawn.height_m(x, y);
  });
}

// A flight of steps up to a door on the southern side.
void put_steps(HeightRaster& surface, double x_m, double south_m) {
  constexpr double kStepM = 0.16;
  constexpr double kTreadM = 0.3;
  for (int step = 0; step < 4; ++step) {
    const double depth = kTreadM * (4 - step);
    put_box(surface, {x_m, south_m - 0.5 * depth, 2.0, depth}, kStepM);  // Each on the one before.
  }
}

void put_building(HeightRaster& surface, double x_m, double y_m, Noise& noise) {
  const Rectangle house{x_m, y_m, noise.uniform(7.0, 11.0), noise.uniform(6.0, 9.0)};
  put_steps(surface, x_m + noise.uniform(-2.0, 2.0), y_m - 0.5 * house.width_m);
  put_box(surface, house, noise.uniform(5.0, 12.0));
  // A wing gives it corners that face inwards.
  put_box(surface,
          {x_m + 0.3 * house.length_m, y_m + 0.5 * house.width_m, noise.uniform(2.0, 4.0),
           noise.uniform(2.0, 5.0)},
          noise.uniform(3.0, 5.0));
}

// Nine lots between the roads: the middle one is a square, the others are built on.
void put_lots(HeightRaster& surface, Noise& noise) {
  for (const double x : {-39.0, -8.0, 8.0, 39.0}) {
    for (const double y : {-39.0, 39.0}) {
      put_building(surface, x, y + noise.uniform(-1.0, 1.0), noise);
    }
  }
  for (const double x : {-39.0, 39.0}) {
    for (const double y : {-8.0, 8.0}) {
      put_building(surface, x + noise.uniform(-1.0, 1.0), y, noise);
    }
  }
  put_building(surface, -7.0, 7.0, noise);
  put_box(surface, {9.0, -12.5, 11.0, 0.3}, 1.2);  // Garden walls around the square.
  put_box(surface, {14.5, -8.0, 0.3, 9.0}, 1.2);
  put_box(surface, {-12.0, -11.0, 4.0, 2.0}, 0.45);  // A raised bed.
}

void put_car(HeightRaster& surface, double x_m, double y_m, double yaw_rad) {
  constexpr double kCabinBackM = 0.3;
  put_box(surface, {x_m, y_m, 4.3, 1.75, yaw_rad}, 0.8);
  put_box(surface,
          {x_m - kCabinBackM * std::cos(yaw_rad), y_m - kCabinBackM * std::sin(yaw_rad), 2.2, 1.5,
           yaw_rad},
          0.62);
}

// Parked along the kerbs; junctions and crossings stay free.
void put_cars(HeightRaster& surface, Noise& noise) {
  for (const double road : kRoadsM) {
    for (const double side : {-kRoadHalfM + 1.1, kRoadHalfM - 1.1}) {
      for (double along = -46.0; along < 47.0; along += 6.0) {
        if (to_road_m(along) < kCrossingM + 4.0) {
          continue;
        }
        const double askew = noise.uniform(-0.05, 0.05);
        if (noise.uniform() < 0.35) {
          put_car(surface, along + noise.uniform(-0.5, 0.5), road + side, askew);
        }
        if (noise.uniform() < 0.35) {
          put_car(surface, road + side, along, 0.5 * std::numbers::pi + askew);
        }
      }
    }
  }
}

// Lamp posts and trees in the grass beside the pavements.
void put_posts(HeightRaster& surface, Noise& noise) {
  const double off = kRoadHalfM + kPavementM;
  for (const double road : kRoadsM) {
    for (double along = -46.0; along < 47.0; along += noise.uniform(6.0, 11.0)) {
      if (to_road_m(along) < off + 1.0) {
        continue;
      }
      put_tree(surface, road + off + 0.5, along, noise);
      put_cylinder(surface, along, road - off - 0.3, 0.08, 5.0);
    }
  }
  for (int i = 0; i < 8; ++i) {
    put_tree(surface, noise.uniform(-14.0, 14.0), noise.uniform(-14.0, -3.0), noise);
  }
}

}  // namespace

World build_block(std::uint64_t seed) {
  constexpr double kCellM = 0.05;
  constexpr int kNodes = static_cast<int>(kSizeM / kCellM) + 1;
  HeightRaster surface(kCellM, kNodes, kNodes, -kHalfM, -kHalfM);
  Noise noise(seed, 13);
  put_ground(surface, noise);
  put_lots(surface, noise);
  put_cars(surface, noise);
  put_posts(surface, noise);
  roughen(surface, 0.003, noise);
  const Pose start = open_spot(surface, 0.0, -kRoadHalfM, 6.0);
  return founded_at("block", std::move(surface), start);
}

}  // namespace cairn::agent
