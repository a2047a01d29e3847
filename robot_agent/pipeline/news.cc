#include "robot_agent/pipeline/news.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace cairn::agent {

News::News(const NewsConfig& config, const SensorModel& model)
    : config_(config), tolerance_mm_(model.tolerance_mm), rules_(model) {
  for (std::size_t p = 1; p < belief_.size(); ++p) {
    const double most = std::min<double>(static_cast<double>(p), config.sure) / 255.0;
    belief_.at(p) = std::log(most / (1.0 - most));
  }
}

Cell News::folded(const Cell& known, const Cell& seen_through, const Cell& surface) const {
  return rules_.after_surface(rules_.after_seen_through(known, seen_through), surface);
}

bool News::still_stands(const Cell& known, const Cell& surface, std::int32_t ground_mm) const {
  constexpr std::uint8_t kLikely = 128;
  const auto stands = [&](const Cell& cell) {
    return cell.probability >= kLikely &&
           std::int64_t{cell.height_mm} - ground_mm > config_.standing_mm;
  };
  const std::int64_t apart_mm = std::int64_t{surface.height_mm} - known.height_mm;
  return stands(known) && stands(surface) && std::abs(apart_mm) < config_.standing_apart_mm;
}

News::Worth News::worth(const Cell& known, const Cell& after, const Cell& surface,
                        std::int32_t ground_mm) const {
  const bool stands = after.probability >= config_.stands;
  if (!known.known()) return stands ? Worth::little : Worth::nothing;
  if (still_stands(known, surface, ground_mm)) return Worth::nothing;
  if (!after.known()) return Worth::little;
  const std::int64_t higher_mm = std::int64_t{after.height_mm} - known.height_mm;
  if (higher_mm > tolerance_mm_) return stands ? Worth::much : Worth::nothing;
  const double belief = std::abs(belief_.at(after.probability) - belief_.at(known.probability));
  const bool same = std::abs(higher_mm) < config_.height_mm && belief < config_.doubt;
  return same ? Worth::nothing : Worth::little;
}

}  // namespace cairn::agent
