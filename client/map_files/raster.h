#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/common/result.h"
#include "core/map/traversability.h"

/// Ground as files of other programs hold it: a dense raster, somewhere on earth.
namespace cairn::map_files {

/// Where a raster lies and how large it is.
struct RasterFrame {
  int columns = 0;
  int rows = 0;
  double cell_m = 0.0;  ///< [m] 0: the file does not tell.
  struct Corner {
    double x_m = 0.0;
    double y_m = 0.0;
    friend bool operator==(const Corner&, const Corner&) = default;
  };
  /// [m] Outer corner of the cell in the south-west, in the file's own coordinates; none when the
  /// file does not tell.
  std::optional<Corner> south_west;
  double yaw_rad = 0.0;  ///< The rows run this much counter-clockwise of east, about that corner.

  /// [cells] Larger rasters are refused: 8192 × 8192, 256 MB of heights.
  static constexpr std::int64_t kMaxCells = std::int64_t{1} << 26;

  [[nodiscard]] std::size_t cells() const {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
  /// Row 0 is the southernmost.
  [[nodiscard]] std::size_t at(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
};

/// Heights, row by row from the south-west.
struct HeightRaster {
  /// Of a cell that nothing is known of.
  static constexpr std::int32_t kUnknown = std::numeric_limits<std::int32_t>::min();

  RasterFrame frame;
  std::vector<std::int32_t> height_mm;
};

/// What 2-D maps tell, row by row from the south-west.
struct ClassRaster {
  RasterFrame frame;
  std::vector<CellClass> classes;
};

/// Sets the size. invalid_argument when it is not positive, exhausted when beyond kMaxCells.
[[nodiscard]] Status set_size(RasterFrame& frame, std::int64_t columns, std::int64_t rows);

/// [mm] A height in metres: kUnknown for NaN and for `no_data`; invalid_argument beyond
/// HeightMap::kMaxExtentM.
[[nodiscard]] Result<std::int32_t> height_mm_of(double height_m, double no_data_m);

/// [m] What files that name no other value mean by "no height here".
inline constexpr double kUsualNoDataM = -9999.0;

}  // namespace cairn::map_files
