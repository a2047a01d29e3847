#include "core/map/packed_tile.h"

#include <bit>
#include <string>

namespace cairn {
namespace {

constexpr std::uint8_t kVersion = 1;
constexpr std::size_t kHeaderBytes = 1 + 4 + 8;
constexpr std::size_t kDatumAt = 1;
constexpr std::size_t kPresenceAt = 5;
constexpr std::size_t kMaskBytes = 8;
constexpr std::size_t kBytesPerCell = 3;

template <class Unsigned>
void put(std::vector<std::uint8_t>& bytes, Unsigned value) {
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
    bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
}

/// Requires: sizeof(Unsigned) bytes from `at` on.
template <class Unsigned>
Unsigned get(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
    value |= std::uint64_t{bytes[at + i]} << (8 * i);
  }
  return static_cast<Unsigned>(value);
}

std::int32_t datum_of(std::span<const std::uint8_t> bytes) {
  return static_cast<std::int32_t>(get<std::uint32_t>(bytes, kDatumAt));
}

std::int16_t offset_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::int16_t>(get<std::uint16_t>(bytes, at));
}

/// Index in the tile of bit `bit` of block `block`.
int cell_of(int block, int bit) {
  return Tile::index((block % 8) * 8 + bit % 8, (block / 8) * 8 + bit / 8);
}

std::uint64_t mask_of(const Tile& tile, int block) {
  std::uint64_t mask = 0;
  for (int bit = 0; bit < 64; ++bit) {
    mask |= std::uint64_t{tile.known(cell_of(block, bit))} << bit;
  }
  return mask;
}

/// Calls visit(index in the tile) for the known cells in the order of the format.
/// Requires: a header and its masks.
template <class Visit>
void for_each_known(std::span<const std::uint8_t> bytes, Visit&& visit) {
  std::size_t at = kHeaderBytes;
  for (auto rest = get<std::uint64_t>(bytes, kPresenceAt); rest != 0; rest &= rest - 1) {
    auto mask = get<std::uint64_t>(bytes, at);
    at += kMaskBytes;
    for (; mask != 0; mask &= mask - 1) {
      visit(cell_of(std::countr_zero(rest), std::countr_zero(mask)));
    }
  }
}

/// Where the heights begin. Requires: a header.
std::size_t heights_at(std::span<const std::uint8_t> bytes) {
  const auto blocks = std::popcount(get<std::uint64_t>(bytes, kPresenceAt));
  return kHeaderBytes + static_cast<std::size_t>(blocks) * kMaskBytes;
}

/// Known cells by the masks. Requires: a header and its masks.
std::size_t count_known(std::span<const std::uint8_t> bytes) {
  std::size_t count = 0;
  for (std::size_t at = kHeaderBytes; at < heights_at(bytes); at += kMaskBytes) {
    count += static_cast<std::size_t>(std::popcount(get<std::uint64_t>(bytes, at)));
  }
  return count;
}

Error corrupt(const char* what) {
  return {ErrorCode::corrupt, std::string("packed tile: ") + what + "; restore it from the log"};
}

bool has_empty_mask(std::span<const std::uint8_t> bytes) {
  for (std::size_t at = kHeaderBytes; at < heights_at(bytes); at += kMaskBytes) {
    if (get<std::uint64_t>(bytes, at) == 0) return true;
  }
  return false;
}

/// Requires: the size that the masks call for.
Status check_cells(std::span<const std::uint8_t> bytes) {
  const std::size_t known = count_known(bytes);
  const std::size_t heights = heights_at(bytes);
  const Tile tile(datum_of(bytes));
  for (std::size_t i = 0; i < known; ++i) {
    const std::int64_t height_mm =
        std::int64_t{tile.datum_mm()} + offset_at(bytes, heights + 2 * i);
    const auto fitted = static_cast<std::int32_t>(height_mm);
    if (fitted != height_mm || !tile.representable(fitted)) return corrupt("a height is too far");
    if (bytes[heights + 2 * known + i] == 0) return corrupt("a known cell has probability 0");
  }
  return {};
}

}  // namespace

PackedTile PackedTile::pack(const Tile& tile) {
  std::vector<std::uint8_t> masks;
  std::uint64_t presence = 0;
  for (int block = 0; block < 64; ++block) {
    const std::uint64_t mask = mask_of(tile, block);
    if (mask == 0) continue;
    presence |= std::uint64_t{1} << block;
    put(masks, mask);
  }
  std::vector<std::uint8_t> bytes;
  bytes.reserve(kHeaderBytes + masks.size() +
                static_cast<std::size_t>(tile.known_count()) * kBytesPerCell);
  bytes.push_back(kVersion);
  put(bytes, static_cast<std::uint32_t>(tile.datum_mm()));
  put(bytes, presence);
  bytes.insert(bytes.end(), masks.begin(), masks.end());
  const std::vector<std::uint8_t> frame = bytes;
  for_each_known(frame, [&](int i) {
    put(bytes, static_cast<std::uint16_t>(tile.height_mm(i) - tile.datum_mm()));
  });
  for_each_known(frame, [&](int i) { bytes.push_back(tile.probability(i)); });
  return PackedTile(std::move(bytes));
}

Result<PackedTile> PackedTile::from_bytes(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return corrupt("no bytes");
  if (bytes[0] != kVersion) {
    return Error{ErrorCode::unsupported_version,
                 "packed tile: version " + std::to_string(bytes[0]) +
                     " is not known here: read it with the program that wrote it"};
  }
  if (bytes.size() < kHeaderBytes || bytes.size() < heights_at(bytes)) return corrupt("cut short");
  if (has_empty_mask(bytes)) return corrupt("a block is present but empty");
  if (bytes.size() != heights_at(bytes) + count_known(bytes) * kBytesPerCell) {
    return corrupt("its length does not fit its masks");
  }
  if (Status cells = check_cells(bytes); !cells) return cells.error();
  return PackedTile(std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
}

Tile PackedTile::unpack() const {
  Tile tile(datum_of(bytes_));
  std::size_t height = heights_at(bytes_);
  std::size_t probability = height + 2 * static_cast<std::size_t>(known_count());
  for_each_known(bytes_, [&](int i) {
    tile.set(i, {tile.datum_mm() + offset_at(bytes_, height), bytes_[probability]});
    height += 2;
    ++probability;
  });
  return tile;
}

int PackedTile::known_count() const { return static_cast<int>(count_known(bytes_)); }

}  // namespace cairn
