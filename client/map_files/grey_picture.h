#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/common/result.h"

namespace cairn::map_files {

/// Brightness, row by row from the top.
struct GreyPicture {
  int columns = 0;
  int rows = 0;
  std::vector<std::uint8_t> grey;
};

/// A PGM (P2 or P5, up to 16 bits, scaled to 0 … 255) or a PNG. corrupt
/// for wrong magic, odd head, missing pixels; exhausted beyond RasterFrame::kMaxCells.
[[nodiscard]] Result<GreyPicture> read_grey_picture(const std::string& path);
/// As P5.
[[nodiscard]] Status write_pgm(const std::string& path, const GreyPicture& picture);

}  // namespace cairn::map_files
