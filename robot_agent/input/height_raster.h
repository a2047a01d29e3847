#pragma once

#include <cstddef>
#include <vector>

namespace cairn::agent {

/// Heights at the nodes of a regular grid, bilinear in between. Node (column, row) stands at
/// (west + column · cell, south + row · cell) in the site frame; row 0 is the southernmost.
class HeightRaster {
 public:
  /// All heights 0. Requires: cell_m > 0, columns and rows ≥ 2, at most kMaxNodes of them.
  HeightRaster(double cell_m, int columns, int rows, double west_m, double south_m);

  static constexpr std::size_t kMaxNodes = 64U << 20U;
  /// [m] Outside of the raster there is a wall that nothing escapes over.
  static constexpr double kOutside = 1000.0;

  /// [m] The surface at a point of the site frame; kOutside beyond the raster.
  [[nodiscard]] double height_m(double x_m, double y_m) const;
  /// Requires: the node exists.
  [[nodiscard]] float at(int column, int row) const { return heights_m_[index(column, row)]; }
  [[nodiscard]] float& at(int column, int row) { return heights_m_[index(column, row)]; }

  [[nodiscard]] double cell_m() const { return cell_m_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] double west_m() const { return west_m_; }
  [[nodiscard]] double south_m() const { return south_m_; }
  [[nodiscard]] double east_m() const { return west_m_ + cell_m_ * (columns_ - 1); }
  [[nodiscard]] double north_m() const { return south_m_ + cell_m_ * (rows_ - 1); }
  /// The site coordinates of a node.
  [[nodiscard]] double x_m(int column) const { return west_m_ + cell_m_ * column; }
  [[nodiscard]] double y_m(int row) const { return south_m_ + cell_m_ * row; }

  /// Adds the same to every height.
  void raise(double by_m);

 private:
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }

  double cell_m_;
  int columns_;
  int rows_;
  double west_m_;
  double south_m_;
  std::vector<float> heights_m_;
};

}  // namespace cairn::agent
