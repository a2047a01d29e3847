#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/common/result.h"
#include "core/map/tile.h"

namespace cairn {

/// An immutable tile at rest: only known cells take room (3 bytes each and a mask). It is how the
/// long-term map is held in memory (proto/codec/tile_snapshot.h: on disk, and sent to clients); to
/// read cells, unpack.
///
/// Bytes, little-endian: version u8 = 1 | datum_mm i32 | presence u64, one bit per 8×8 block, block
/// b = (y/8)·8 + x/8 | for each present block a mask u64, bit (y%8)·8 + x%8 | for each known cell
/// in that order height - datum i16 | in the same order probability u8 (never 0).
class PackedTile {
 public:
  [[nodiscard]] static PackedTile pack(const Tile& tile);
  /// Checks every bound and rule of the format; corrupt when one is broken (also when a mask is
  /// empty, bytes are left over, or a probability is 0).
  [[nodiscard]] static Result<PackedTile> from_bytes(std::span<const std::uint8_t> bytes);

  [[nodiscard]] Tile unpack() const;
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return bytes_; }
  [[nodiscard]] int known_count() const;
  friend bool operator==(const PackedTile&, const PackedTile&) = default;

  static constexpr std::size_t kMaxBytes = 1 + 4 + 8 + 64 * 8 + std::size_t{Tile::kCells} * 3;

 private:
  explicit PackedTile(std::vector<std::uint8_t> bytes) : bytes_(std::move(bytes)) {}

  std::vector<std::uint8_t> bytes_;
};

}  // namespace cairn
