#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/planner/trulla.h"

namespace cairn {

/// One bit per cell of a tile's row, the lowest for the westernmost.
using RowBits = std::uint64_t;

/// Which cells of a tile and of the rim around it have been lowered and not yet been looked at by a
/// sweep of one direction. Rows 0 and kSize + 1 are the rim's.
struct TileNews {
  std::array<RowBits, 66> row{};
  std::array<std::uint8_t, 66> before{};  ///< The rim's cell west of the row.
  std::array<std::uint8_t, 66> after{};   ///< And east of it.
};

/// What sweeps read and write of a tile, rim included, either as it lies or transposed: then its
/// columns are the rows.
struct TilePlane {
  static constexpr int kRows = 66;
  static constexpr int kStride = 80;
  static constexpr int kFirst = 16;  ///< Of a row's cells, the rim's is before it.
  static constexpr int kLength = kRows * kStride + 16;

  alignas(64) std::array<std::int32_t, kLength> levelled;  ///< As in Field.
  alignas(64) std::array<std::int32_t, kLength> lift;
  alignas(64) std::array<std::int32_t, kLength> price;
  std::array<RowBits, kRows> open;
  std::array<std::uint8_t, kRows> open_before;
  std::array<std::uint8_t, kRows> open_after;
  TileNews forth;  ///< For the sweep towards higher rows.
  TileNews back;   ///< For the one towards lower rows.

  [[nodiscard]] static constexpr int at(int column, int row) {
    return row * kStride + kFirst + column;
  }
};

/// 64 × 64 cells of a field being solved.
struct FieldTile {
  static constexpr int kSize = 64;

  TilePlane upright;
  TilePlane transposed;
  bool level = true;  ///< No lifts and one price: `price` is that of every open cell.
  std::int32_t price = 0;
};

/// Sweeps in one instruction set. All sets give the same field.
struct FieldKernels {
  const char* name;
  /// Lowers the tile's cells until none can be lowered by what is in the tile and its rim.
  /// Requires: the upright plane; of the transposed one what is open and the news. Afterwards there
  /// is no news and the upright plane has the costs.
  void (*solve)(FieldTile& tile);
};

/// Plain C++: the reference.
[[nodiscard]] const FieldKernels& portable_field_kernels();
/// All that this processor can run, fastest first, the portable one last.
[[nodiscard]] const std::vector<const FieldKernels*>& usable_field_kernels();

/// The processor's own sets, or null where there are none or the processor lacks them.
[[nodiscard]] const FieldKernels* avx2_field_kernels();
[[nodiscard]] const FieldKernels* avx512_field_kernels();

/// Bits of a square read column by column.
void transpose_bits(std::array<RowBits, 64>& square);

}  // namespace cairn
