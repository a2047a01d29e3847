#include <algorithm>
#include <cmath>

#include "client/cli/map_picture.h"

namespace cairn::cli {

namespace {

// Around the panel, in units: coordinates at the left and below, title above, legend at the foot.
constexpr double kLeft = 72.0;
constexpr double kRight = 28.0;
constexpr double kAbove = 84.0;
constexpr double kBelow = 150.0;

// The panel of a picture that fits a screen [pixels].
constexpr double kPanelWidth = 1440.0;
constexpr double kPanelHeight = 1300.0;
constexpr std::int64_t kMinPanelWidth = 800;
constexpr std::int64_t kMinPanelHeight = 240;
constexpr int kMaxPixelsPerCell = 64;

CellIndex cell_of(const api::PointJson& point, double cell_m) {
  return {static_cast<std::int32_t>(std::floor(point.x_m / cell_m)),
          static_cast<std::int32_t>(std::floor(point.y_m / cell_m))};
}

/// Adds a place unless it is so far away that the map would become a speck.
void add_near(CellWindow& window, const CellWindow& known, CellIndex cell) {
  const std::int64_t reach = std::max({known.width(), known.height(), std::int64_t{400}});
  const bool near = cell.x >= known.lowest.x - reach && cell.x <= known.highest.x + reach &&
                    cell.y >= known.lowest.y - reach && cell.y <= known.highest.y + reach;
  if (near) window.add(cell);
}

CellWindow shown_window(const SiteMap& map, const PictureOptions& options, double cell_m) {
  auto known = known_window(map);
  if (known.empty()) {
    known.add({0, 0});
    if (!map.head.robots.empty()) {
      known = {};
      known.add(cell_of({map.head.robots[0].x_m, map.head.robots[0].y_m}, cell_m));
    }
  }
  auto window = known;
  for (const auto& robot : map.head.robots) {
    add_near(window, known, cell_of({robot.x_m, robot.y_m}, cell_m));
  }
  for (const auto& point : options.path) add_near(window, known, cell_of(point, cell_m));
  if (options.goal) add_near(window, known, cell_of(*options.goal, cell_m));
  return window;
}

/// Widens the window by so many cells, half on either side.
void widen(CellWindow& window, std::int64_t across, std::int64_t up) {
  window.lowest.x -= static_cast<std::int32_t>(across / 2);
  window.highest.x += static_cast<std::int32_t>(across - across / 2);
  window.lowest.y -= static_cast<std::int32_t>(up / 2);
  window.highest.y += static_cast<std::int32_t>(up - up / 2);
}

double pixels_at(const CellWindow& window, double scale) {
  return static_cast<double>(window.width()) * static_cast<double>(window.height()) * scale * scale;
}

void choose_scale(PictureLayout& layout, int wanted) {
  const auto& window = layout.window;
  double scale = wanted;
  if (wanted == 0) {
    scale = std::min({kPanelWidth / static_cast<double>(window.width()),
                      kPanelHeight / static_cast<double>(window.height()),
                      static_cast<double>(kMaxPixelsPerCell)});
  }
  // Some of the pixels are for what surrounds the panel.
  const double most = 0.75 * static_cast<double>(kMaxPicturePixels);
  if (const double all = pixels_at(window, scale); all > most) scale *= std::sqrt(most / all);
  if (scale >= 1.0) {
    layout.pixels_per_cell = static_cast<int>(scale);
  } else {
    // By choice a picture may become a little larger than asked for rather than a lot smaller.
    const double slack = wanted == 0 ? 0.25 : 0.0;
    layout.cells_per_pixel = std::max(1, static_cast<int>(std::ceil(1.0 / scale - slack)));
  }
}

/// Makes the window whole pixels and the panel wide enough for title and legend.
void fill_panel(PictureLayout& layout) {
  const std::int64_t k = layout.cells_per_pixel;
  const std::int64_t s = layout.pixels_per_cell;
  const auto lack = [&](std::int64_t cells, std::int64_t min_pixels) {
    const std::int64_t least = (min_pixels * k + s - 1) / s;
    const std::int64_t whole = (std::max(cells, least) + k - 1) / k * k;
    return whole - cells;
  };
  widen(layout.window, lack(layout.window.width(), kMinPanelWidth),
        lack(layout.window.height(), kMinPanelHeight));
}

}  // namespace

cv::Point2d PictureLayout::in_panel(double x_m, double y_m) const {
  const double east = x_m - window.lowest.x * cell_m;
  const double south = (static_cast<double>(window.highest.y) + 1.0) * cell_m - y_m;
  const auto bounded = [](double pixels) { return std::clamp(pixels, -1e6, 1e6); };
  return {bounded(east / pixel_m()), bounded(south / pixel_m())};
}

PictureLayout lay_out(const SiteMap& map, const PictureOptions& options) {
  PictureLayout layout;
  layout.cell_m = map.head.cell_size_mm / 1000.0;
  layout.window = shown_window(map, options, layout.cell_m);
  const auto margin = [](std::int64_t cells) { return 2 * std::max<std::int64_t>(2, cells / 40); };
  widen(layout.window, margin(layout.window.width()), margin(layout.window.height()));
  choose_scale(layout, options.scale);
  fill_panel(layout);
  const auto pixels = [&](std::int64_t cells) {
    return static_cast<int>(cells / layout.cells_per_pixel * layout.pixels_per_cell);
  };
  const int width = pixels(layout.window.width());
  const int height = pixels(layout.window.height());
  layout.unit = std::clamp(width / 1400.0, 1.0, 3.0);
  layout.panel = {cvRound(kLeft * layout.unit), cvRound(kAbove * layout.unit), width, height};
  layout.page = {width + cvRound((kLeft + kRight) * layout.unit),
                 height + cvRound((kAbove + kBelow) * layout.unit)};
  return layout;
}

}  // namespace cairn::cli
