#include "tests/support/baselines/evidence_update.h"

#include <algorithm>
#include <cassert>

#include "core/map/sensor_model.h"

namespace cairn::baselines {
namespace {

// Keeps Dempster's rule away from masses of exactly 1, which nothing could ever change.
constexpr float kMostMass = 0.99F;

}  // namespace

Bayes::Belief Bayes::after_hit(Belief belief) {
  return std::min(cairn::combine(belief, kHit), kHighest);
}

Bayes::Belief Bayes::after_pass(Belief belief) {
  return std::max(cairn::combine(belief, kPass), kLowest);
}

Himm::Belief Himm::after_hit(Belief belief) {
  return static_cast<Belief>(std::min<int>(belief + kRise, kHighest));
}

Himm::Belief Himm::after_pass(Belief belief) {
  return static_cast<Belief>(std::max<int>(belief - kFall, 0));
}

Masses combine(const Masses& a, const Masses& b) {
  const float a_either = 1.0F - a.occupied - a.empty;
  const float b_either = 1.0F - b.occupied - b.empty;
  const float conflict = a.occupied * b.empty + a.empty * b.occupied;
  assert(conflict < 1.0F);
  const float scale = 1.0F / (1.0F - conflict);
  const float occupied =
      scale * (a.occupied * b.occupied + a.occupied * b_either + a_either * b.occupied);
  const float empty = scale * (a.empty * b.empty + a.empty * b_either + a_either * b.empty);
  return {std::min(occupied, kMostMass), std::min(empty, kMostMass)};
}

}  // namespace cairn::baselines
