#include "core/map/fold_rules.h"

#include <algorithm>
#include <cstdlib>

#include "core/map/submap.h"

namespace cairn {
namespace {

/// Eq. 1 for probabilities that may come from elsewhere: no opinion is certain.
std::uint8_t combine_unsure(int a, int b) {
  return combine(static_cast<std::uint8_t>(std::clamp(a, 1, 254)),
                 static_cast<std::uint8_t>(std::clamp(b, 1, 254)));
}

/// The mean of `old_hits` hits at `old_mm` and `new_hits` at `new_mm`, to the nearest millimetre.
std::int32_t mean_mm(std::int32_t old_mm, int old_hits, std::int32_t new_mm, int new_hits) {
  const std::int64_t off = std::int64_t{new_mm} - old_mm;
  const std::int64_t hits = old_hits + new_hits;
  const std::int64_t step = (2 * std::abs(off) * new_hits + hits) / (2 * hits);
  return static_cast<std::int32_t>(old_mm + (off < 0 ? -step : step));
}

}  // namespace

FoldRules::FoldRules(const SensorModel& model) : model_(model) {
  for (std::size_t p = 1; p < hits_.size(); ++p) {
    hits_[p] = hits_behind(static_cast<std::uint8_t>(p), model);
  }
}

Cell FoldRules::after_seen_through(const Cell& cell, const Cell& seen) const {
  const std::int64_t above_mm = std::int64_t{cell.height_mm} - seen.height_mm;
  if (!cell.known() || !seen.known() || above_mm <= model_.tolerance_mm) return cell;
  if (seen.probability == kCertainlyEmpty) return {};
  return believed(
      cell.height_mm,
      std::min(cell.probability, combine_unsure(cell.probability, 255 - seen.probability)));
}

Cell FoldRules::after_surface(const Cell& cell, const Cell& surface) const {
  if (!surface.known()) return cell;
  const std::int64_t above_mm = std::int64_t{surface.height_mm} - cell.height_mm;
  if (!cell.known() || above_mm > model_.tolerance_mm) {
    return believed(surface.height_mm, surface.probability);
  }
  if (above_mm < -model_.tolerance_mm) return cell;
  return believed(mean_mm(cell.height_mm, hits_[cell.probability], surface.height_mm,
                          hits_[surface.probability]),
                  combine_unsure(cell.probability, surface.probability));
}

Cell FoldRules::believed(std::int32_t height_mm, std::uint8_t probability) const {
  if (probability < model_.min_probability) return {};
  return {height_mm, std::min(probability, model_.max_probability)};
}

}  // namespace cairn
