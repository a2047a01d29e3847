#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/delta/coarseness.h"
#include "core/delta/context_image.h"

namespace cairn::proto::patch {

/// A cell as the coder sees it: in steps and classes.
struct WindowCell {
  std::int32_t height = 0;       ///< [quanta] Above the submap's origin.
  std::uint8_t level = 0;        ///< Probability: 0 unknown, 1 … 16 of 16 levels, 17 certain.
  std::uint8_t age = 0;          ///< Class of the time since its last change, see age_class.
  std::uint8_t marks = 0;        ///< kChanged …, in this packet.
  std::uint8_t residual = 0;     ///< [quanta] By how much its new height was missed, saturating.
  std::uint8_t updates = 0;      ///< Changes since it was unknown, 0 … 7.
  std::uint8_t probability = 0;  ///< [1/255]

  [[nodiscard]] bool known() const { return level != 0; }
};

// Marks of a cell that is told.
inline constexpr std::uint8_t kChanged = 1;
inline constexpr std::uint8_t kCleared = 2;
inline constexpr std::uint8_t kMoved = 4;    ///< Its height changed.
inline constexpr std::uint8_t kAltMode = 8;  ///< Its height was told from the other surface.
inline constexpr std::uint8_t kOnGrid = 16;  ///< Its exact height is coarse ones' among its like.

inline constexpr std::uint8_t kUnknownAge = 7;

/// The cells of one block and as many around it as contexts look at.
class Window {
 public:
  static constexpr int kMargin = 3;
  static constexpr int kWidth = kBlockSize + 2 * kMargin;
  using BlockCells = std::array<WindowCell, kBlockCells>;

  /// Requires: -kMargin ≤ x, y < kBlockSize + kMargin.
  [[nodiscard]] const WindowCell& at(int x, int y) const { return cells_[index(x, y)]; }
  /// The middle's cell is told. Requires: 0 ≤ x, y < kBlockSize.
  void tell(int x, int y, const WindowCell& cell);

  /// What most contexts ask for: which cells of a row are known, changed in the round before, told
  /// in this packet. Bit x + kMargin is the cell x.
  struct Row {
    std::uint32_t known = 0;
    std::uint32_t recent = 0;
    std::uint32_t told = 0;
  };
  /// Requires: -kMargin ≤ y < kBlockSize + kMargin.
  [[nodiscard]] const Row& row(int y) const { return rows_[static_cast<std::size_t>(y + kMargin)]; }
  /// Puts the block that lies (dx, dy) blocks off the middle one; null: nothing known there.
  void put(int dx, int dy, const BlockCells* cells);
  [[nodiscard]] BlockCells middle() const;

 private:
  static constexpr std::size_t index(int x, int y) {
    return static_cast<std::size_t>((y + kMargin) * kWidth + x + kMargin);
  }
  void mark(int x, int y);

  std::array<WindowCell, std::size_t{kWidth} * kWidth> cells_{};
  std::array<Row, std::size_t{kWidth}> rows_{};
};

/// What the image holds of a block, as the coder sees it at `tick`.
[[nodiscard]] Window::BlockCells cells_of(const ContextImage::Block& block, std::uint8_t tick,
                                          const Coarseness& coarseness);
/// The cell after it was told, `marks` saying how.
[[nodiscard]] WindowCell told_cell(const WindowCell& before, const Cell& now,
                                   const Coarseness& coarseness);
/// Class of an age in rounds: 0 in this one, 1 the one before, then wider and wider, up to 6.
[[nodiscard]] std::uint8_t age_class(std::uint8_t age);
/// Whether an exact probability is one that a level among 16 stands for.
[[nodiscard]] bool is_level_value(std::uint8_t probability);
/// Level of a probability among 16, from 1; 0 unknown, 17 certain.
[[nodiscard]] std::uint8_t context_level(std::uint8_t probability);

}  // namespace cairn::proto::patch
