#include "proto/codec/patch_view.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

namespace cairn::proto {

std::uint8_t heading_of(double yaw_rad) {
  const auto steps = std::llround(yaw_rad / (2.0 * std::numbers::pi) * kHeadings);
  return static_cast<std::uint8_t>(((steps % kHeadings) + kHeadings) % kHeadings);
}

namespace patch {
namespace {

/// 64 · sine of 0 … 16 sixty-fourths of a turn, to nearest.
constexpr std::array<std::int64_t, 17> kSine64 = {0,  6,  12, 19, 24, 30, 36, 41, 45,
                                                  49, 53, 56, 59, 61, 63, 64, 64};
constexpr std::int64_t kFarthest = 2047;  // [cells] Beyond it all is alike.

std::int64_t sine64(int heading) {
  const int turn = heading & (kHeadings - 1);
  const int half = turn & 31;
  const std::int64_t value = kSine64.at(static_cast<std::size_t>(half <= 16 ? half : 32 - half));
  return turn < 32 ? value : -value;
}

}  // namespace

Place place_from(const Viewpoint& view, std::int64_t x, std::int64_t y) {
  const std::int64_t dx = std::clamp(x - view.at.x, -kFarthest, kFarthest);
  const std::int64_t dy = std::clamp(y - view.at.y, -kFarthest, kFarthest);
  const std::int64_t cosine = sine64(view.heading + kHeadings / 4);
  const std::int64_t sine = sine64(view.heading);
  const std::int64_t ahead = dx * cosine + dy * sine;  // [1/64 cell]
  const std::int64_t aside = dy * cosine - dx * sine;  // [1/64 cell]
  const auto squared = static_cast<std::uint64_t>(dx * dx + dy * dy);
  const auto width = static_cast<std::size_t>(std::bit_width(squared));
  const std::size_t second = width > 1 ? (squared >> (width - 2)) & 1U : 0U;
  Place place;
  place.distance = std::min(2 * width + second, Place::kDistances - 1);
  place.ahead =
      static_cast<std::size_t>(std::clamp<std::int64_t>((ahead >> 8) + 12, 0, Place::kAhead - 1));
  place.aside = std::min(static_cast<std::size_t>(std::abs(aside) >> 9), Place::kAside - 1);
  place.octant =
      (ahead < 0 ? 1U : 0U) + (aside < 0 ? 2U : 0U) + (std::abs(ahead) < std::abs(aside) ? 4U : 0U);
  return place;
}

}  // namespace patch
}  // namespace cairn::proto
