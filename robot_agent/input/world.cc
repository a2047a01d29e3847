#include "robot_agent/input/world.h"

#include <cmath>
#include <limits>
#include <utility>

#include "robot_agent/input/built_worlds.h"
#include "robot_agent/input/dem_file.h"

namespace cairn::agent {
namespace {

constexpr char kDemPrefix[] = "dem:";

struct Builder {
  const char* name;
  World (*build)(std::uint64_t seed);
};
constexpr Builder kBuilders[] = {
    {"room", build_room}, {"ramp", build_ramp}, {"block", build_block}, {"hill", build_hill}};

std::string known_names() {
  std::string names;
  for (const std::string& name : world_names()) {
    names += (names.empty() ? "" : ", ") + name;
  }
  return names;
}

// Height difference over the size of a robot around a point: how rough the spot is. [m]
double unevenness_m(const HeightRaster& surface, double x_m, double y_m) {
  constexpr double kHalfM = 0.6;
  const double step = std::max(0.1, surface.cell_m() / 2.0);
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (double dx = -kHalfM; dx <= kHalfM; dx += step) {
    for (double dy = -kHalfM; dy <= kHalfM; dy += step) {
      const double h = surface.height_m(x_m + dx, y_m + dy);
      lowest = std::min(lowest, h);
      highest = std::max(highest, h);
    }
  }
  return highest - lowest;
}

}  // namespace

std::vector<std::string> world_names() {
  std::vector<std::string> names;
  for (const Builder& builder : kBuilders) {
    names.emplace_back(builder.name);
  }
  names.emplace_back("dem:FILE[@CELL_SIZE]");
  return names;
}

Result<World> make_world(const std::string& name, std::uint64_t seed) {
  for (const Builder& builder : kBuilders) {
    if (name == builder.name) {
      return builder.build(seed);
    }
  }
  if (name.starts_with(kDemPrefix)) {
    auto surface = read_dem(name.substr(sizeof(kDemPrefix) - 1));
    if (!surface) {
      return surface.error();
    }
    return terrain_world(name, std::move(*surface));
  }
  return Error{ErrorCode::not_found,
               "there is no world \"" + name + "\"; choose one of " + known_names()};
}

Pose open_spot(const HeightRaster& surface, double x_m, double y_m, double within_m) {
  constexpr double kGridM = 0.5;
  Pose best{.x_m = x_m, .y_m = y_m};
  double least = std::numeric_limits<double>::infinity();
  for (double dx = -within_m; dx <= within_m; dx += kGridM) {
    for (double dy = -within_m; dy <= within_m; dy += kGridM) {
      // A metre farther off must be worth a centimetre of smoothness.
      const double cost = unevenness_m(surface, x_m + dx, y_m + dy) + 0.01 * std::hypot(dx, dy);
      if (cost < least) {
        least = cost;
        best.x_m = x_m + dx;
        best.y_m = y_m + dy;
      }
    }
  }
  return best;
}

World founded_at(std::string name, HeightRaster surface, const Pose& start) {
  surface.raise(-surface.height_m(start.x_m, start.y_m));
  return {std::move(name), std::move(surface), start};
}

World terrain_world(std::string name, HeightRaster surface) {
  const double within =
      0.25 * std::min(surface.east_m() - surface.west_m(), surface.north_m() - surface.south_m());
  const Pose start =
      open_spot(surface, 0.5 * (surface.west_m() + surface.east_m()),
                0.5 * (surface.south_m() + surface.north_m()), std::min(within, 30.0));
  return founded_at(std::move(name), std::move(surface), start);
}

}  // namespace cairn::agent
