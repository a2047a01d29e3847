#include "proto/codec/patch_predictor.h"

#include <algorithm>
#include <array>
#include <limits>

namespace cairn::proto::patch {
namespace {

constexpr int kReach = Window::kMargin;
constexpr int kNear = 8;  // Squared distance of what counts for least and most.
/// Heights further from the nearest cell's than this are held there: it bounds every product.
constexpr std::int64_t kMaxOff = 8192;

/// A neighbour's place and weight: 4096 / distance⁴.
struct Neighbour {
  int dx;
  int dy;
  int squared;
  std::int64_t weight;
};

constexpr auto make_neighbours() {
  constexpr std::size_t kCount = (2 * kReach + 1) * (2 * kReach + 1) - 1;
  std::array<Neighbour, kCount> all{};
  std::size_t count = 0;
  for (int squared = 1; squared <= 2 * kReach * kReach; ++squared) {
    for (int dy = -kReach; dy <= kReach; ++dy) {
      for (int dx = -kReach; dx <= kReach; ++dx) {
        if (dx * dx + dy * dy != squared) continue;
        all[count++] = {dx, dy, squared, 4096 / (squared * squared)};
      }
    }
  }
  return all;
}
/// Nearest first.
constexpr auto kNeighbours = make_neighbours();

/// Sums of a weighted plane fit.
struct Sums {
  std::int64_t w = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;

  void add(const Neighbour& at, std::int64_t height) {
    w += at.weight;
    x += at.weight * at.dx;
    y += at.weight * at.dy;
    z += at.weight * height;
    xx += at.weight * at.dx * at.dx;
    xy += at.weight * at.dx * at.dy;
    yy += at.weight * at.dy * at.dy;
    xz += at.weight * at.dx * height;
    yz += at.weight * at.dy * height;
  }
};

/// The fitted plane's height [1/16] at the origin. Slopes are held down (ridge) so that few or
/// lined-up cells make no steep planes. No product exceeds 2^61.
std::int64_t plane16_at_origin(const Sums& s) {
  const std::int64_t ridge = 3 * s.w * s.w / 10;
  const std::int64_t a = (s.xx * s.w - s.x * s.x + ridge) >> 10;
  const std::int64_t b = (s.xy * s.w - s.x * s.y) >> 10;
  const std::int64_t c = (s.yy * s.w - s.y * s.y + ridge) >> 10;
  const std::int64_t p = (s.xz * s.w - s.x * s.z) >> 8;
  const std::int64_t r = (s.yz * s.w - s.y * s.z) >> 8;
  const std::int64_t det = std::max<std::int64_t>(a * c - b * b, 1);
  const std::int64_t slope_x16 = (4 * (p * c - r * b)) / det;
  const std::int64_t slope_y16 = (4 * (r * a - p * b)) / det;
  return (16 * s.z - slope_x16 * s.x - slope_y16 * s.y) / s.w;
}

}  // namespace

Prediction predict(const Window& window, int x, int y) {
  Prediction prediction;
  Sums sums;
  std::int64_t even = 0;
  prediction.least = std::numeric_limits<std::int32_t>::max();
  prediction.most = std::numeric_limits<std::int32_t>::min();
  for (const Neighbour& at : kNeighbours) {
    const WindowCell& cell = window.at(x + at.dx, y + at.dy);
    if (!cell.known()) continue;
    if (prediction.count++ == 0) prediction.nearest = cell.height;
    const std::int64_t off = std::int64_t{cell.height} - prediction.nearest;
    const std::int64_t height = std::clamp(off, -kMaxOff, kMaxOff);
    sums.add(at, height);
    even += height;
    if (at.squared > kNear) continue;
    prediction.least = std::min(prediction.least, cell.height);
    prediction.most = std::max(prediction.most, cell.height);
  }
  if (prediction.count == 0) return {};
  if (prediction.least > prediction.most) {
    prediction.least = prediction.most = prediction.nearest;
  }
  const std::int64_t base16 = std::int64_t{16} * prediction.nearest;
  prediction.mean16 = static_cast<std::int32_t>(base16 + 16 * sums.z / sums.w);
  prediction.even16 = static_cast<std::int32_t>(base16 + 16 * even / prediction.count);
  const std::int64_t half_spread = 8 * (std::int64_t{prediction.most} - prediction.least) + 32;
  prediction.plane16 = static_cast<std::int32_t>(std::clamp(
      base16 + plane16_at_origin(sums), std::int64_t{16} * prediction.least - half_spread,
      std::int64_t{16} * prediction.most + half_spread));
  return prediction;
}

}  // namespace cairn::proto::patch
