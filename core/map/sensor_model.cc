#include "core/map/sensor_model.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace cairn {
namespace {

constexpr double kCertain = 255.0;

double log_odds(std::uint8_t probability) {
  return std::log(probability / (kCertain - probability));
}

void check(bool sound, const char* fault, std::string& all) {
  if (sound) return;
  if (!all.empty()) all += "; ";
  all += fault;
}

}  // namespace

std::string faults(const SensorModel& model) {
  std::string all;
  check(model.hit_probability >= 128 && model.hit_probability <= 254,
        "hit_probability must be 128 to 254", all);
  check(model.miss_probability >= 1 && model.miss_probability <= 127,
        "miss_probability must be 1 to 127", all);
  check(model.graze_probability >= model.miss_probability && model.graze_probability <= 127,
        "graze_probability must be miss_probability to 127", all);
  check(model.graze_beyond_m >= 0.0 && model.graze_beyond_m <= 10.0,
        "graze_beyond_m must be 0 to 10", all);
  check(model.min_probability >= 1 && model.min_probability <= 127,
        "min_probability must be 1 to 127", all);
  check(model.max_probability >= model.hit_probability && model.max_probability <= 254,
        "max_probability must be hit_probability to 254", all);
  check(model.tolerance_mm >= 1 && model.tolerance_mm <= 10'000, "tolerance_mm must be 1 to 10000",
        all);
  check(model.mean_memory_hits >= 1 && model.mean_memory_hits <= 255,
        "mean_memory_hits must be 1 to 255", all);
  return all;
}

std::uint8_t combine(std::uint8_t a, std::uint8_t b) {
  const std::uint32_t both = std::uint32_t{a} * b;
  const std::uint32_t neither = (255U - a) * (255U - b);
  const std::uint32_t any = both + neither;
  assert(any != 0);
  return static_cast<std::uint8_t>((2U * 255U * both + any) / (2U * any));  // Equation (1)
}

int hits_behind(std::uint8_t probability, const SensorModel& model) {
  if (probability >= model.max_probability) return model.mean_memory_hits;
  if (probability <= model.hit_probability) return 1;
  const double hits = log_odds(probability) / log_odds(model.hit_probability);
  return static_cast<int>(std::lround(std::min(hits, 1.0 * model.mean_memory_hits)));
}

}  // namespace cairn
