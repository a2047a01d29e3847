#include "core/map/tile.h"

#include <algorithm>

namespace cairn {

std::size_t TileKeyHash::operator()(const TileKey& key) const {
  // Neighbouring keys differ in few low bits; two odd multipliers spread them over all of them.
  const std::uint64_t x = static_cast<std::uint32_t>(key.tx);
  const std::uint64_t y = static_cast<std::uint32_t>(key.ty);
  const std::uint64_t level = static_cast<std::uint8_t>(key.level);
  std::uint64_t hash = ((x << 32U) | y) + level * 0xD6E8FEB86659FD93ULL;
  hash *= 0x9E3779B97F4A7C15ULL;
  hash ^= hash >> 32U;
  hash *= 0xD6E8FEB86659FD93ULL;
  return static_cast<std::size_t>(hash ^ (hash >> 32U));
}

int Tile::known_count() const {
  const auto unknown = std::count(probability_.begin(), probability_.end(), std::uint8_t{0});
  return kCells - static_cast<int>(unknown);
}

}  // namespace cairn
