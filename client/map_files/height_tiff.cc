#include "client/map_files/height_tiff.h"

#include <bit>
#include <opencv2/imgcodecs.hpp>

#include "client/map_files/tiff_tags.h"
#include "client/map_files/words.h"

namespace cairn::map_files {

namespace {

Error bad(const std::string& path, const std::string& what) {
  return {ErrorCode::corrupt, path + ": " + what};
}

Result<cv::Mat1d> pixels_of(const std::string& path, const RasterFrame& frame) {
  cv::Mat image;
  try {
    image = cv::imread(path, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) return bad(path, "the TIFF cannot be decoded; is it whole?");
  if (image.channels() != 1) return bad(path, "must have one channel, heights in metres");
  if (image.cols != frame.columns || image.rows != frame.rows) {
    return bad(path, "has not the size that its first directory tells");
  }
  cv::Mat1d heights;
  image.convertTo(heights, CV_64F);
  return heights;
}

/// Collects a TIFF's bytes, little-endian.
class TiffBytes {
 public:
  void add(std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i)
      bytes_.push_back(static_cast<char>(value >> (8U * static_cast<unsigned>(i))));
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value), 8); }
  void entry(int tag, int type, std::uint64_t count, std::uint64_t value) {
    add(static_cast<std::uint64_t>(tag), 2);
    add(static_cast<std::uint64_t>(type), 2);
    add(count, 4);
    add(value, 4);
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// All that stands before the pixels.
std::string tiff_head(const RasterFrame& frame) {
  constexpr std::uint64_t kShort = 3;
  constexpr std::uint64_t kLong = 4;
  constexpr std::uint64_t kEntries = 14;
  constexpr std::uint64_t kScaleAt = 8 + 2 + 12 * kEntries + 4;
  constexpr std::uint64_t kTieAt = kScaleAt + 24;
  constexpr std::uint64_t kKeysAt = kTieAt + 48;
  constexpr std::uint64_t kNoDataAt = kKeysAt + 24;
  constexpr std::uint64_t kPixelsAt = kNoDataAt + 8;
  TiffBytes tiff;
  tiff.add(0x4949, 2);
  tiff.add(42, 2);
  tiff.add(8, 4);
  tiff.add(kEntries, 2);
  const auto columns = static_cast<std::uint64_t>(frame.columns);
  const auto rows = static_cast<std::uint64_t>(frame.rows);
  tiff.entry(256, kLong, 1, columns);
  tiff.entry(257, kLong, 1, rows);
  tiff.entry(258, kShort, 1, 32);                 // Bits per sample,
  tiff.entry(259, kShort, 1, 1);                  // not packed,
  tiff.entry(262, kShort, 1, 1);                  // black is 0.
  tiff.entry(273, kLong, 1, kPixelsAt);           // One strip,
  tiff.entry(277, kShort, 1, 1);                  // one channel,
  tiff.entry(278, kLong, 1, rows);                // all rows in the strip,
  tiff.entry(279, kLong, 1, columns * rows * 4);  // so many bytes,
  tiff.entry(339, kShort, 1, 3);                  // of floating point.
  tiff.entry(33550, 12, 3, kScaleAt);
  tiff.entry(33922, 12, 6, kTieAt);
  tiff.entry(34735, kShort, 12, kKeysAt);
  tiff.entry(42113, 2, 6, kNoDataAt);
  tiff.add(0, 4);  // No further directory.
  for (const double scale : {frame.cell_m, frame.cell_m, 1.0}) tiff.add(scale);
  const double north_m = frame.south_west->y_m + frame.rows * frame.cell_m;
  for (const double tie : {0.0, 0.0, 0.0, frame.south_west->x_m, north_m, 0.0}) tiff.add(tie);
  // Keys 1.1.0, two of them: a projected model, pixels are areas.
  for (const int key : {1, 1, 0, 2, 1024, 0, 1, 1, 1025, 0, 1, 1}) {
    tiff.add(static_cast<std::uint64_t>(key), 2);
  }
  return tiff.bytes() + std::string("-9999\0\0\0", 8);
}

}  // namespace

Result<HeightRaster> read_height_tiff(const std::string& path) {
  const auto tags = read_tiff_tags(path);
  if (!tags) return tags.error();
  const auto pixels = pixels_of(path, tags->frame);
  if (!pixels) return pixels.error();
  HeightRaster raster{tags->frame, std::vector<std::int32_t>(tags->frame.cells())};
  for (int row = 0; row < raster.frame.rows; ++row) {
    const double* heights_m = (*pixels)[raster.frame.rows - 1 - row];
    for (int column = 0; column < raster.frame.columns; ++column) {
      const auto height = height_mm_of(heights_m[column], tags->no_data_m);
      if (!height) return bad(path, height.error().message);
      raster.height_mm[raster.frame.at(column, row)] = *height;
    }
  }
  return raster;
}

Status write_height_tiff(const std::string& path, const HeightRaster& raster) {
  auto file = create_file(path);
  if (!file) return file.error();
  const RasterFrame& frame = raster.frame;
  *file << tiff_head(frame);
  for (int row = frame.rows - 1; row >= 0; --row) {
    TiffBytes line;
    for (int column = 0; column < frame.columns; ++column) {
      const std::int32_t height_mm = raster.height_mm[frame.at(column, row)];
      const double height_m =
          height_mm == HeightRaster::kUnknown ? kUsualNoDataM : height_mm / 1000.0;
      line.add(std::bit_cast<std::uint32_t>(static_cast<float>(height_m)), 4);
    }
    *file << line.bytes();
  }
  return finish_file(*file, path);
}

}  // namespace cairn::map_files
