#include "client/cli/map_picture.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "client/cli/map_furniture.h"
#include "client/cli/map_overlay.h"
#include "client/cli/map_relief.h"

namespace cairn::cli {

namespace {

cv::Mat3b draw(const SiteMap& map, const PictureOptions& options) {
  const auto layout = lay_out(map, options);
  const auto raster = rasterize(map, layout.window, layout.cells_per_pixel);
  const auto range = tint_range(raster);
  Canvas panel(draw_relief(raster, range, layout.pixels_per_cell), layout.unit);
  draw_grid(panel, layout);
  draw_motion(panel, layout, map, options);

  Canvas page(cv::Mat3b(layout.page, kPaperColour), layout.unit);
  panel.image().copyTo(page.image()(layout.panel));
  draw_furniture(page, layout, map, range);
  return page.image();
}

}  // namespace

Result<cv::Mat3b> draw_map(const SiteMap& map, const PictureOptions& options) {
  try {
    return draw(map, options);
  } catch (const cv::Exception& fault) {
    return Error{ErrorCode::exhausted, "cannot draw the map: " + fault.err};
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::exhausted, "no memory for the picture: give a smaller --scale"};
  }
}

Status write_png(const cv::Mat3b& picture, const std::string& file) {
  std::vector<uchar> bytes;
  try {
    cv::imencode(".png", picture, bytes);
  } catch (const cv::Exception& fault) {
    return Error{ErrorCode::exhausted, "cannot encode the picture: " + fault.err};
  }
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) {
    return Error{ErrorCode::io, "cannot write " + file + ": check the folder and its free space"};
  }
  return {};
}

}  // namespace cairn::cli
