#include "tests/bench/delta_baselines.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#ifdef CAIRN_HAS_ZSTD
#include <zstd.h>
#endif
#ifdef CAIRN_HAS_BROTLI
#include <brotli/encode.h>
#endif
#ifdef CAIRN_HAS_LZMA
#include <lzma.h>
#endif
#ifdef CAIRN_HAS_WEBP
#include <webp/encode.h>
#endif
#ifdef CAIRN_HAS_CHARLS
#include <charls/charls.h>
#endif
#ifdef CAIRN_HAS_JXL
#include <jxl/encode.h>
#endif

namespace cairn::bench {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Pack = std::function<std::size_t(const Bytes&)>;

/// A told cell, in quanta and levels.
struct Told {
  int x;
  int y;
  int height;
  int level;  ///< From 1; 0 = unknown.
};

/// The delta's cells row by row through the whole map.
std::vector<Told> cells_of(const Delta& delta, const Coarseness& coarseness) {
  std::vector<Told> cells;
  for (const proto::BlockUpdate& update : delta) {
    for (int i = 0; i < kBlockCells; ++i) {
      if (!update.delta.changed[static_cast<std::size_t>(i)]) continue;
      const Cell& cell = update.delta.cells[static_cast<std::size_t>(i)];
      const int in_tile = index_in_tile(update.key.block, i);
      const int level = cell.known() ? 1 + level_of(cell.probability, coarseness.levels) : 0;
      cells.push_back({update.key.tile.tx * Tile::kSize + in_tile % Tile::kSize,
                       update.key.tile.ty * Tile::kSize + in_tile / Tile::kSize,
                       cell.known() ? cell.height_mm / coarseness.quantum_mm : 0, level});
    }
  }
  std::ranges::sort(
      cells, [](const Told& a, const Told& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
  return cells;
}

void put16(Bytes& out, int value) {
  out.push_back(static_cast<std::uint8_t>(value & 0xFF));
  out.push_back(static_cast<std::uint8_t>((value >> 8) & 0xFF));
}

void put_number(Bytes& out, unsigned value) {
  for (; value > 127; value >>= 7U) out.push_back(static_cast<std::uint8_t>(value | 128U));
  out.push_back(static_cast<std::uint8_t>(value));
}

/// One struct a cell, as most messages do.
Bytes struct_list(const std::vector<Told>& cells) {
  Bytes out;
  for (const Told& cell : cells) {
    put16(out, cell.x);
    put16(out, cell.y);
    put16(out, cell.height);
    out.push_back(static_cast<std::uint8_t>(cell.level));
  }
  return out;
}

/// Gaps between cells, height differences from cell to cell, levels: each in a plane of its own.
Bytes planes(const std::vector<Told>& cells) {
  int least_x = std::numeric_limits<int>::max();
  int most_x = std::numeric_limits<int>::min();
  for (const Told& cell : cells) {
    least_x = std::min(least_x, cell.x);
    most_x = std::max(most_x, cell.x);
  }
  const int width = most_x - least_x + 1;
  Bytes out;
  Bytes heights;
  Bytes levels;
  put16(out, least_x);
  put16(out, cells.front().y);
  put16(out, width);
  int last_at = -1;
  int last_height = 0;
  for (const Told& cell : cells) {
    const int at = (cell.y - cells.front().y) * width + cell.x - least_x;
    put_number(out, static_cast<unsigned>(at - last_at - 1));
    last_at = at;
    levels.push_back(static_cast<std::uint8_t>(cell.level));
    if (cell.level == 0) continue;
    const int by = cell.height - last_height;
    put_number(heights, static_cast<unsigned>(by < 0 ? -2 * by - 1 : 2 * by));
    last_height = cell.height;
  }
  out.insert(out.end(), heights.begin(), heights.end());
  out.insert(out.end(), levels.begin(), levels.end());
  return out;
}

/// The delta as a picture of its heights (0 = not told) and one of its levels.
struct Pictures {
  cv::Mat heights;
  cv::Mat levels;
};

Pictures pictures(const std::vector<Told>& cells) {
  int x0 = cells.front().x, x1 = x0, y0 = cells.front().y, y1 = y0;
  int least = std::numeric_limits<int>::max();
  for (const Told& cell : cells) {
    x0 = std::min(x0, cell.x), x1 = std::max(x1, cell.x);
    y0 = std::min(y0, cell.y), y1 = std::max(y1, cell.y);
    if (cell.level > 0) least = std::min(least, cell.height);
  }
  Pictures made{cv::Mat::zeros(y1 - y0 + 1, x1 - x0 + 1, CV_16UC1),
                cv::Mat::zeros(y1 - y0 + 1, x1 - x0 + 1, CV_8UC1)};
  for (const Told& cell : cells) {
    const int height = cell.level > 0 ? cell.height - least + 2 : 1;
    made.heights.at<std::uint16_t>(cell.y - y0, cell.x - x0) = static_cast<std::uint16_t>(height);
    made.levels.at<std::uint8_t>(cell.y - y0, cell.x - x0) = static_cast<std::uint8_t>(cell.level);
  }
  return made;
}

std::size_t png(const Pictures& of) {
  std::size_t bytes = 0;
  for (const cv::Mat* picture : {&of.heights, &of.levels}) {
    Bytes out;
    cv::imencode(".png", *picture, out, {cv::IMWRITE_PNG_COMPRESSION, 9});
    bytes += out.size();
  }
  return bytes;
}

#ifdef CAIRN_HAS_ZSTD
std::size_t zstd(const Bytes& in) {
  Bytes out(ZSTD_compressBound(in.size()));
  return ZSTD_compress(out.data(), out.size(), in.data(), in.size(), 19);
}
#endif
#ifdef CAIRN_HAS_BROTLI
std::size_t brotli(const Bytes& in) {
  Bytes out(BrotliEncoderMaxCompressedSize(in.size()));
  std::size_t size = out.size();
  BrotliEncoderCompress(11, BROTLI_MAX_WINDOW_BITS, BROTLI_MODE_GENERIC, in.size(), in.data(),
                        &size, out.data());
  return size;
}
#endif
#ifdef CAIRN_HAS_LZMA
/// Without container: the bare stream.
std::size_t lzma(const Bytes& in) {
  lzma_options_lzma options;
  lzma_lzma_preset(&options, 9 | LZMA_PRESET_EXTREME);
  const std::array<lzma_filter, 2> filters = {
      {{LZMA_FILTER_LZMA2, &options}, {LZMA_VLI_UNKNOWN, nullptr}}};
  Bytes out(in.size() * 2 + 1024);
  std::size_t size = 0;
  lzma_raw_buffer_encode(filters.data(), nullptr, in.data(), in.size(), out.data(), &size,
                         out.size());
  return size;
}
#endif
#ifdef CAIRN_HAS_WEBP
/// Height in two colours, level in the third.
std::size_t webp(const Pictures& of) {
  Bytes rgb;
  for (int y = 0; y < of.heights.rows; ++y) {
    for (int x = 0; x < of.heights.cols; ++x) {
      put16(rgb, of.heights.at<std::uint16_t>(y, x));
      rgb.push_back(of.levels.at<std::uint8_t>(y, x));
    }
  }
  std::uint8_t* out = nullptr;
  const std::size_t size = WebPEncodeLosslessRGB(rgb.data(), of.heights.cols, of.heights.rows,
                                                 of.heights.cols * 3, &out);
  WebPFree(out);
  return size;
}
#endif
#ifdef CAIRN_HAS_CHARLS
std::size_t jpeg_ls(const Pictures& of) {
  std::size_t bytes = 0;
  for (const cv::Mat* picture : {&of.heights, &of.levels}) {
    charls::jpegls_encoder encoder;
    encoder.frame_info({static_cast<std::uint32_t>(picture->cols),
                        static_cast<std::uint32_t>(picture->rows),
                        static_cast<std::int32_t>(picture->elemSize1() * 8), 1});
    Bytes out(encoder.estimated_destination_size());
    encoder.destination(out);
    bytes += encoder.encode(picture->data, picture->total() * picture->elemSize());
  }
  return bytes;
}
#endif
#ifdef CAIRN_HAS_JXL
std::size_t jpeg_xl_of(const cv::Mat& picture) {
  JxlEncoder* encoder = JxlEncoderCreate(nullptr);
  JxlBasicInfo info;
  JxlEncoderInitBasicInfo(&info);
  info.xsize = static_cast<std::uint32_t>(picture.cols);
  info.ysize = static_cast<std::uint32_t>(picture.rows);
  info.bits_per_sample = static_cast<std::uint32_t>(picture.elemSize1() * 8);
  info.num_color_channels = 1;
  info.uses_original_profile = JXL_TRUE;
  JxlEncoderSetBasicInfo(encoder, &info);
  JxlColorEncoding grey;
  JxlColorEncodingSetToSRGB(&grey, JXL_TRUE);
  JxlEncoderSetColorEncoding(encoder, &grey);
  JxlEncoderFrameSettings* settings = JxlEncoderFrameSettingsCreate(encoder, nullptr);
  JxlEncoderSetFrameLossless(settings, JXL_TRUE);
  JxlEncoderFrameSettingsSetOption(settings, JXL_ENC_FRAME_SETTING_EFFORT, 9);
  const JxlPixelFormat format{1, picture.elemSize1() == 2 ? JXL_TYPE_UINT16 : JXL_TYPE_UINT8,
                              JXL_NATIVE_ENDIAN, 0};
  JxlEncoderAddImageFrame(settings, &format, picture.data, picture.total() * picture.elemSize());
  JxlEncoderCloseInput(encoder);
  Bytes out(picture.total() * 4 + 4096);
  std::uint8_t* next = out.data();
  std::size_t left = out.size();
  JxlEncoderProcessOutput(encoder, &next, &left);
  JxlEncoderDestroy(encoder);
  return out.size() - left;
}
std::size_t jpeg_xl(const Pictures& of) { return jpeg_xl_of(of.heights) + jpeg_xl_of(of.levels); }
#endif

}  // namespace

std::vector<Baseline> delta_baselines(const Coarseness& coarseness,
                                      [[maybe_unused]] std::vector<std::string>& absent) {
  std::vector<Baseline> all;
  const auto bytewise = [&](const std::string& name, Bytes (*layout)(const std::vector<Told>&),
                            std::size_t (*pack)(const Bytes&)) {
    all.push_back(
        {name, [=](const Delta& delta) { return pack(layout(cells_of(delta, coarseness))); }});
  };
  const auto pictorial = [&](const std::string& name, std::size_t (*pack)(const Pictures&)) {
    all.push_back(
        {name, [=](const Delta& delta) { return pack(pictures(cells_of(delta, coarseness))); }});
  };
#ifdef CAIRN_HAS_ZSTD
  bytewise("struct list + zstd -19", struct_list, zstd);
  bytewise("planes + zstd -19", planes, zstd);
#else
  absent.emplace_back("zstd");
#endif
#ifdef CAIRN_HAS_BROTLI
  bytewise("planes + brotli -11", planes, brotli);
#else
  absent.emplace_back("brotli");
#endif
#ifdef CAIRN_HAS_LZMA
  bytewise("planes + LZMA -9e", planes, lzma);
#else
  absent.emplace_back("LZMA");
#endif
  pictorial("PNG, 16 bits", png);
#ifdef CAIRN_HAS_WEBP
  pictorial("WebP lossless", webp);
#else
  absent.emplace_back("WebP");
#endif
#ifdef CAIRN_HAS_CHARLS
  pictorial("JPEG-LS", jpeg_ls);
#else
  absent.emplace_back("JPEG-LS (CharLS)");
#endif
#ifdef CAIRN_HAS_JXL
  pictorial("JPEG XL -e 9", jpeg_xl);
#else
  absent.emplace_back("JPEG XL");
#endif
  return all;
}

}  // namespace cairn::bench
