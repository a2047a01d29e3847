#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/planner/trulla.h"

namespace cairn {

/// A path as it travels: points in quarters of a cell, so that each is moved by an eighth at most.
struct CodedPath {
  int cell_size_mm = 125;
  std::vector<CellIndex> points;  ///< [1/4 cells] In the site frame.

  [[nodiscard]] std::vector<Eigen::Vector2d> points_m() const;
  friend bool operator==(const CodedPath&, const CodedPath&) = default;

  static constexpr std::size_t kMaxPoints = 4096;
  /// [1/4 cells] Coordinates and the way between two points stay below.
  static constexpr std::int32_t kFarthest = 1 << 24;
};

/// invalid_argument beyond kMaxPoints or kFarthest.
[[nodiscard]] Result<CodedPath> quantise(const std::vector<Eigen::Vector2d>& points_m,
                                         int cell_size_mm);

/// Numbers in base 128, low first: cell size, number of points, the first point, bits per number;
/// then with so many bits each the way from each point to the next. Signed numbers zigzag.
[[nodiscard]] std::vector<std::uint8_t> encode_path(const CodedPath& path);
/// invalid_argument when it is no such path; anything after it is one, too.
[[nodiscard]] Result<CodedPath> decode_path(std::span<const std::uint8_t> bytes);

/// The same way with points put in so that no two lie further apart than `most` [1/4 cells] along x
/// or y. Requires: most ≥ 1.
[[nodiscard]] CodedPath subdivided(const CodedPath& path, std::int32_t most);

/// The field along a path: which way to go from every cell within some distance of it, so that who
/// had to leave the path picks the field up from where that leads (T2.2.4). Which cells these are
/// is reckoned in whole numbers: it comes out the same on every machine.
class Corridor {
 public:
  enum : std::uint8_t {
    at_goal = 8,
    no_way = 9,  ///< Closed, or the field does not reach it.
    outside = 10,
  };

  /// Every cell whose middle lies within `half_width` [cells] of the path, still without
  /// directions. invalid_argument without a path or beyond kMaxHalfWidth; exhausted beyond kMaxSide
  /// or kMaxLookedAt, which bounds the time.
  [[nodiscard]] static Result<Corridor> along(const CodedPath& path, int half_width);

  /// The step to take from a cell (0 … 7, see kStepX), at_goal, no_way or outside.
  [[nodiscard]] std::uint8_t direction(CellIndex cell) const;
  /// Takes the directions from a field: always one that leads to a lower cost, and rather that of a
  /// neighbour than one that is better by less than a tenth of a cell, which is coded smaller.
  void fill(const DrivableGrid& grid, const Field& field);
  [[nodiscard]] std::size_t cells() const;

  /// Directions that mostly agree with their neighbours', by an adaptive range coder. The path and
  /// the half width are not among the bytes: the decoder is given them.
  [[nodiscard]] std::vector<std::uint8_t> encode() const;
  /// invalid_argument when the bytes do not fit this corridor.
  [[nodiscard]] Status decode(std::span<const std::uint8_t> bytes);

  static constexpr int kMaxHalfWidth = 64;               ///< [cells]
  static constexpr std::int64_t kMaxSide = 4096;         ///< [cells] Of the box around the path.
  static constexpr std::int64_t kMaxLookedAt = 1 << 20;  ///< [cells] In the legs' boxes, together.

  friend bool operator==(const Corridor&, const Corridor&) = default;

 private:
  template <class Coder>
  [[nodiscard]] bool code(Coder&& coder);
  [[nodiscard]] std::uint8_t& at(int x, int y) {
    return direction_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                      static_cast<std::size_t>(x)];
  }
  [[nodiscard]] std::uint8_t way_on(const DrivableGrid& grid, const Field& field,
                                    CellIndex cell) const;
  /// [cells] Columns and rows that a leg may come near to.
  struct Box {
    int x0 = 0;
    int y0 = 0;
    int x1 = 0;
    int y1 = 0;
    [[nodiscard]] std::int64_t cells() const {
      return (std::int64_t{x1} - x0 + 1) * (std::int64_t{y1} - y0 + 1);
    }
  };
  [[nodiscard]] Box box_of(CellIndex from, CellIndex to, int half_width) const;
  void mark_near(CellIndex from, CellIndex to, int half_width);

  CellIndex origin_;
  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint8_t> direction_;  ///< Row by row, of the box around the path.
};

}  // namespace cairn
