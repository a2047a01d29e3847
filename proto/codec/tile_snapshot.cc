#include "proto/codec/tile_snapshot.h"

#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <memory>
#include <string>
#include <type_traits>

namespace cairn::proto {
namespace {

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;

constexpr std::uint8_t kVersion = 2;
constexpr std::uint8_t kPackedVersion = 1;
/// Higher ones save little more and take much longer.
constexpr int kLevel = 6;
constexpr std::size_t kPresenceAt = 4;
constexpr std::size_t kMasksAt = kPresenceAt + 8;

Error corrupt(const char* what) {
  return {ErrorCode::corrupt, std::string("tile snapshot: ") + what};
}

std::uint64_t number_at(ByteSpan bytes, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t i = 8; i > 0; --i) value = value << 8U | bytes[at + i - 1];
  return value;
}

/// Heights of known cells, from the datum, as they become known one after the other.
class Heights {
 public:
  [[nodiscard]] int expected(int x, int y) const {
    const bool w = x > 0 && known(x - 1, y);
    const bool n = y > 0 && known(x, y - 1);
    if (!w && !n) return last_;
    if (!n) return at(x - 1, y);
    if (!w) return at(x, y - 1);
    const int west = at(x - 1, y);
    const int north = at(x, y - 1);
    if (!known(x - 1, y - 1)) return (west + north) >> 1;
    return std::clamp(west + north - at(x - 1, y - 1), std::min(west, north),
                      std::max(west, north));
  }
  void put(int x, int y, std::int16_t height) {
    const auto i = static_cast<std::size_t>(Tile::index(x, y));
    height_[i] = height;
    known_[i] = true;
    last_ = height;
  }

 private:
  [[nodiscard]] bool known(int x, int y) const {
    return known_[static_cast<std::size_t>(Tile::index(x, y))];
  }
  [[nodiscard]] int at(int x, int y) const {
    return height_[static_cast<std::size_t>(Tile::index(x, y))];
  }

  std::array<std::int16_t, Tile::kCells> height_{};
  std::array<bool, Tile::kCells> known_{};
  int last_ = 0;
};

/// Calls visit(x, y) for the known cells in the order of a PackedTile; false when masks are
/// missing.
template <class Visit>
bool for_each_known(ByteSpan front, Visit&& visit) {
  std::size_t at = kMasksAt;
  for (auto rest = number_at(front, kPresenceAt); rest != 0; rest &= rest - 1) {
    if (at + 8 > front.size()) return false;
    const int block = std::countr_zero(rest);
    for (auto mask = number_at(front, at); mask != 0; mask &= mask - 1) {
      const int bit = std::countr_zero(mask);
      visit((block % 8) * 8 + bit % 8, (block / 8) * 8 + bit / 8);
    }
    at += 8;
  }
  return true;
}

std::uint16_t zig_zag(int miss) {
  const auto wrapped = static_cast<std::int16_t>(miss);
  return static_cast<std::uint16_t>(wrapped < 0 ? -2 * wrapped - 1 : 2 * wrapped);
}

int un_zig_zag(std::uint16_t value) { return (value & 1U) != 0 ? -(value + 1) / 2 : value / 2; }

/// Packed: 1 | front | heights | probabilities; planes: front | low | high | probabilities.
Bytes to_planes(const PackedTile& tile) {
  const ByteSpan packed = tile.bytes();
  const auto known = static_cast<std::size_t>(tile.known_count());
  const std::size_t heights_at = packed.size() - 3 * known;
  Bytes planes(packed.begin() + 1, packed.end());
  std::uint8_t* const low = planes.data() + heights_at - 1;
  Heights heights;
  std::size_t i = 0;
  for_each_known(packed.subspan(1), [&](int x, int y) {
    const std::size_t at = heights_at + 2 * i;
    const auto height = static_cast<std::int16_t>(packed[at] | packed[at + 1] << 8U);
    const std::uint16_t miss = zig_zag(height - heights.expected(x, y));
    heights.put(x, y, height);
    low[i] = static_cast<std::uint8_t>(miss);
    low[known + i] = static_cast<std::uint8_t>(miss >> 8U);
    ++i;
  });
  return planes;
}

Result<PackedTile> from_planes(ByteSpan planes) {
  if (planes.size() < kMasksAt) return corrupt("cut short");
  std::size_t known = 0;
  if (!for_each_known(planes, [&](int, int) { ++known; })) return corrupt("cut short");
  if (planes.size() < kMasksAt + 3 * known) return corrupt("its length does not fit its masks");
  const std::size_t front = planes.size() - 3 * known;
  Bytes packed{kPackedVersion};
  packed.insert(packed.end(), planes.begin(), planes.end());
  Heights heights;
  std::size_t i = 0;
  for_each_known(planes.first(front), [&](int x, int y) {
    const auto miss =
        static_cast<std::uint16_t>(planes[front + i] | planes[front + known + i] << 8);
    const auto height = static_cast<std::int16_t>(heights.expected(x, y) + un_zig_zag(miss));
    heights.put(x, y, height);
    packed[1 + front + 2 * i] = static_cast<std::uint8_t>(height);
    packed[1 + front + 2 * i + 1] = static_cast<std::uint8_t>(height >> 8);
    ++i;
  });
  return PackedTile::from_bytes(packed);
}

/// A context of zstd, kept as it is much larger than a tile.
template <auto kCreate, auto kFree>
auto of_this_thread() {
  using Context = decltype(kCreate());
  struct Free {
    void operator()(Context context) const { kFree(context); }
  };
  static thread_local const std::unique_ptr<std::remove_pointer_t<Context>, Free> context(
      kCreate());
  return context.get();
}

}  // namespace

std::vector<std::uint8_t> write_tile_snapshot(const PackedTile& tile) {
  const Bytes planes = to_planes(tile);
  Bytes bytes(1 + ZSTD_compressBound(planes.size()));
  bytes[0] = kVersion;
  const std::size_t size =
      ZSTD_compressCCtx(of_this_thread<ZSTD_createCCtx, ZSTD_freeCCtx>(), bytes.data() + 1,
                        bytes.size() - 1, planes.data(), planes.size(), kLevel);
  assert(ZSTD_isError(size) == 0U);
  bytes.resize(1 + size);
  return bytes;
}

Result<PackedTile> read_tile_snapshot(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return corrupt("no bytes");
  if (bytes[0] != kVersion) {
    return Error{ErrorCode::unsupported_version,
                 "tile snapshot: version " + std::to_string(bytes[0]) +
                     " is not known here: use programs of one release"};
  }
  Bytes planes(PackedTile::kMaxBytes);
  const std::size_t size =
      ZSTD_decompressDCtx(of_this_thread<ZSTD_createDCtx, ZSTD_freeDCtx>(), planes.data(),
                          planes.size(), bytes.data() + 1, bytes.size() - 1);
  if (ZSTD_isError(size) != 0U) return corrupt("cannot be decompressed");
  planes.resize(size);
  return from_planes(planes);
}

}  // namespace cairn::proto
