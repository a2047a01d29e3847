#include "client/map_files/grey_picture.h"

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "client/map_files/raster.h"
#include "client/map_files/words.h"

namespace cairn::map_files {

namespace {

Error bad(const std::string& path, const std::string& what) {
  return {ErrorCode::corrupt, path + ": " + what};
}

/// Reads a PGM's head and pixels.
class Pgm {
 public:
  explicit Pgm(const std::string& path) : path_(path), file_(path, std::ios::binary) {}

  Result<GreyPicture> read() {
    const bool binary = file_.get() == 'P' && file_.peek() == '5';
    if (const int kind = file_.get(); kind != '2' && kind != '5') {
      return bad(path_, "is no PGM (P2 or P5)");
    }
    const std::int64_t columns = number();
    const std::int64_t rows = number();
    most_ = number();
    if (columns < 0 || rows < 0 || most_ < 1 || most_ > 65535) {
      return bad(path_, "has no sound PGM head (columns, rows, largest value)");
    }
    RasterFrame frame;
    if (auto sized = set_size(frame, columns, rows); !sized) {
      return Error{sized.error().code, path_ + ": " + sized.error().message};
    }
    if (binary && !std::isspace(file_.get())) return bad(path_, "has no sound PGM head");
    GreyPicture picture{frame.columns, frame.rows, std::vector<std::uint8_t>(frame.cells())};
    for (std::uint8_t& grey : picture.grey) {
      const std::int64_t value = binary ? sample() : number();
      if (value < 0) return bad(path_, "ends before its last pixel");
      grey = static_cast<std::uint8_t>(std::min(value, most_) * 255 / most_);
    }
    return picture;
  }

 private:
  /// The next number of the head, or of P2's pixels, past comments; -1 when there is none.
  std::int64_t number() {
    int c = file_.get();
    while (std::isspace(c) || c == '#') {
      while (c == '#' && file_.peek() != '\n' && file_.good()) file_.get();
      c = file_.get();
    }
    std::int64_t value = -1;
    for (; c >= '0' && c <= '9' && value < 1'000'000'000; c = file_.get()) {
      value = std::max<std::int64_t>(value, 0) * 10 + (c - '0');
    }
    if (file_.good()) file_.unget();
    return value;
  }

  std::int64_t sample() {
    const int high = most_ > 255 ? file_.get() : 0;
    const int low = file_.get();
    return high < 0 || low < 0 ? -1 : high * 256 + low;
  }

  std::string path_;
  std::ifstream file_;
  std::int64_t most_ = 255;
};

/// [pixels] Width and height in the head of a PNG, so that none is unpacked that is too large.
Status check_png_size(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  unsigned char head[24] = {};
  file.read(reinterpret_cast<char*>(head), sizeof head);
  if (!file || head[1] != 'P' || head[2] != 'N' || head[3] != 'G') {
    return bad(path, "is neither PGM nor PNG");
  }
  const auto number = [&](int at) {
    std::int64_t value = 0;
    for (int i = at; i < at + 4; ++i) value = value * 256 + head[i];
    return value;
  };
  RasterFrame frame;
  if (auto sized = set_size(frame, number(16), number(20)); !sized) {
    return Error{sized.error().code, path + ": " + sized.error().message};
  }
  return {};
}

Result<GreyPicture> read_png(const std::string& path) {
  if (auto sized = check_png_size(path); !sized) return sized.error();
  cv::Mat image;
  try {
    image = cv::imread(path, cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) return bad(path, "the picture cannot be decoded; is it whole?");
  GreyPicture picture{image.cols, image.rows, {}};
  picture.grey.reserve(image.total());
  for (int row = 0; row < image.rows; ++row) {
    picture.grey.insert(picture.grey.end(), image.ptr(row), image.ptr(row) + image.cols);
  }
  return picture;
}

}  // namespace

Result<GreyPicture> read_grey_picture(const std::string& path) {
  if (auto readable = check_readable(path); !readable) return readable.error();
  if (std::ifstream(path, std::ios::binary).get() == 'P') return Pgm(path).read();
  return read_png(path);
}

Status write_pgm(const std::string& path, const GreyPicture& picture) {
  auto file = create_file(path);
  if (!file) return file.error();
  *file << "P5\n" << picture.columns << ' ' << picture.rows << "\n255\n";
  file->write(reinterpret_cast<const char*>(picture.grey.data()),
              static_cast<std::streamsize>(picture.grey.size()));
  return finish_file(*file, path);
}

}  // namespace cairn::map_files
