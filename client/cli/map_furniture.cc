#include "client/cli/map_furniture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "client/cli/map_overlay.h"

namespace cairn::cli {

namespace {

const cv::Scalar kSoftInk{118, 110, 104};

template <class... Values>
std::string printed(const char* pattern, Values... values) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

double grid_step_m(const PictureLayout& layout) {
  return nice_step(190.0 * layout.unit * layout.pixel_m());
}

/// Calls `line(coordinate_m)` for the multiples of the step between two coordinates.
template <class Line>
void for_each_step(double from_m, double to_m, double step_m, Line line) {
  for (double i = std::ceil(from_m / step_m); i * step_m <= to_m; i += 1.0) line(i * step_m);
}

struct Extent {
  double west, south, east, north;
};

Extent extent_of(const PictureLayout& layout) {
  const auto& w = layout.window;
  return {w.lowest.x * layout.cell_m, w.lowest.y * layout.cell_m,
          (w.highest.x + 1.0) * layout.cell_m, (w.highest.y + 1.0) * layout.cell_m};
}

void draw_coordinates(Canvas& page, const PictureLayout& layout) {
  const auto extent = extent_of(layout);
  const auto& panel = layout.panel;
  const double u = page.unit();
  const double step = grid_step_m(layout);
  for_each_step(extent.west, extent.east, step, [&](double x_m) {
    const double x = panel.x + layout.in_panel(x_m, 0.0).x;
    page.text(printed("%g", x_m), {x, panel.y + panel.height + 22.0 * u}, 9.0, kSoftInk,
              Align::centre);
  });
  for_each_step(extent.south, extent.north, step, [&](double y_m) {
    const double y = panel.y + layout.in_panel(0.0, y_m).y;
    page.text(printed("%g", y_m), {panel.x - 10.0 * u, y + 4.5 * u}, 9.0, kSoftInk, Align::right);
  });
}

void draw_title(Canvas& page, const PictureLayout& layout, const SiteMap& map) {
  const double u = page.unit();
  const double left = layout.panel.x;
  const auto extent = extent_of(layout);
  const auto& head = map.head;
  page.text(head.site, {left, 40.0 * u}, 18.0, kInk, Align::left, true);
  std::size_t known = 0;
  for (const auto& [key, tile] : map.tiles) known += static_cast<std::size_t>(tile.known_count());
  page.text(printed("map version %llu   cells of %g m   %.0f m2 known   window %.0f x %.0f m",
                    static_cast<unsigned long long>(head.map_version), layout.cell_m,
                    static_cast<double>(known) * layout.cell_m * layout.cell_m,
                    extent.east - extent.west, extent.north - extent.south),
            {left, 66.0 * u}, 9.5, kSoftInk);
}

void draw_north_arrow(Canvas& page, const PictureLayout& layout) {
  const double u = page.unit();
  const double x = layout.panel.x + layout.panel.width - 14.0 * u;
  const std::array<cv::Point2d, 3> west = {
      cv::Point2d{x, 32.0 * u}, {x, 64.0 * u}, {x - 10.0 * u, 72.0 * u}};
  const std::array<cv::Point2d, 3> east = {
      cv::Point2d{x, 32.0 * u}, {x, 64.0 * u}, {x + 10.0 * u, 72.0 * u}};
  page.polygon(west, kInk);
  page.polygon(east, cv::Scalar(176, 170, 166));
  page.text("N", {x, 26.0 * u}, 11.0, kInk, Align::centre, true);
}

void draw_scale_bar(Canvas& page, const PictureLayout& layout, double y) {
  const double u = page.unit();
  const double bar_m = nice_step(220.0 * u * layout.pixel_m());
  const double px = bar_m / layout.pixel_m();
  const double left = layout.panel.x;
  for (int part = 0; part < 4; ++part) {
    const cv::Rect box(cvRound(left + px * part / 4.0), cvRound(y), cvRound(px / 4.0),
                       cvRound(7.0 * u));
    page.wash(box, part % 2 == 0 ? kInk : kWhite, 1.0);
  }
  page.frame({cvRound(left), cvRound(y), cvRound(px), cvRound(7.0 * u)}, 1.0, kInk);
  page.text("0", {left, y + 24.0 * u}, 9.5, kInk);
  page.text(bar_m >= 1000.0 ? printed("%g km", bar_m / 1000.0) : printed("%g m", bar_m),
            {left + px, y + 24.0 * u}, 9.5, kInk, Align::centre);
}

void draw_height_ramp(Canvas& page, const HeightRange& range, double right, double y) {
  const double u = page.unit();
  const double width = 220.0 * u;
  const int left = cvRound(right - width);
  for (int i = 0; i < cvRound(width); ++i) {
    const auto part = static_cast<float>(i / width);
    const float height_m = range.low_m + (range.high_m - range.low_m) * part;
    page.wash({left + i, cvRound(y), 1, cvRound(9.0 * u)}, cv::Scalar(tint(height_m, range)), 1.0);
  }
  page.frame({left, cvRound(y), cvRound(width), cvRound(9.0 * u)}, 1.0, kSoftInk);
  page.text(printed("%.1f m", static_cast<double>(range.low_m)), {right - width, y + 25.0 * u}, 9.5,
            kInk);
  page.text("height", {right - width / 2.0, y + 25.0 * u}, 9.5, kSoftInk, Align::centre);
  page.text(printed("%.1f m", static_cast<double>(range.high_m)), {right, y + 25.0 * u}, 9.5, kInk,
            Align::right);
}

/// A patch of colour, hatched as the map is where `hatch` is given.
void draw_swatch(Canvas& page, cv::Point2d left, const cv::Vec3b& colour, const cv::Vec3b* hatch) {
  const double u = page.unit();
  const cv::Rect box(cvRound(left.x), cvRound(left.y - 8.0 * u), cvRound(26.0 * u),
                     cvRound(16.0 * u));
  page.wash(box, cv::Scalar(colour), 1.0);
  if (hatch != nullptr) {
    for (int row = box.y; row < box.y + box.height; ++row) {
      for (int column = box.x; column < box.x + box.width; ++column) {
        if ((row + column) % 9 == 0) page.image()(row, column) = *hatch;
      }
    }
  }
  page.frame(box, 1.0, kSoftInk);
}

void draw_legend(Canvas& page, const PictureLayout& layout, double y) {
  const double u = page.unit();
  double x = layout.panel.x;
  const auto entry = [&](const std::string& name, auto symbol) {
    symbol(cv::Point2d(x, y));
    page.text(name, {x + 34.0 * u, y + 5.0 * u}, 10.0, kInk);
    x += 34.0 * u + page.text_width(name, 10.0) + 26.0 * u;
  };
  const auto stroke = [u](cv::Point2d at) {
    return std::array<cv::Point2d, 2>{at, at + cv::Point2d(26.0 * u, 0.0)};
  };
  const auto middle = [u](cv::Point2d at) { return at + cv::Point2d(13.0 * u, 0.0); };
  entry("ground", [&](auto at) { draw_swatch(page, at, tint(0.4F, {0.0F, 1.0F}), nullptr); });
  entry("obstacle", [&](auto at) { draw_swatch(page, at, kObstacleColour, nullptr); });
  entry("unknown", [&](auto at) { draw_swatch(page, at, kUnknownColour, &kUnknownHatch); });
  entry("driven", [&](auto at) { draw_track(page, stroke(at)); });
  entry("planned", [&](auto at) { draw_path(page, stroke(at)); });
  entry("goal", [&](auto at) { draw_goal(page, middle(at)); });
  entry("robot", [&](auto at) { draw_robot(page, middle(at), 0.0); });
}

}  // namespace

double nice_step(double most) {
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= most) return factor * power;
  }
  return power;
}

void draw_grid(Canvas& panel, const PictureLayout& layout) {
  const auto extent = extent_of(layout);
  const int line_px = std::max(1, cvRound(layout.unit));
  const auto ink = [](double coordinate_m) { return coordinate_m == 0.0 ? 0.28 : 0.10; };
  for_each_step(extent.west, extent.east, grid_step_m(layout), [&](double x_m) {
    const int x = cvRound(layout.in_panel(x_m, 0.0).x);
    panel.wash({x, 0, line_px, panel.image().rows}, kInk, ink(x_m));
  });
  for_each_step(extent.south, extent.north, grid_step_m(layout), [&](double y_m) {
    const int y = cvRound(layout.in_panel(0.0, y_m).y);
    panel.wash({0, y, panel.image().cols, line_px}, kInk, ink(y_m));
  });
}

void draw_furniture(Canvas& page, const PictureLayout& layout, const SiteMap& map,
                    const HeightRange& range) {
  const double below = layout.panel.y + layout.panel.height;
  const double u = page.unit();
  page.frame(layout.panel, 1.0, kSoftInk);
  draw_coordinates(page, layout);
  draw_title(page, layout, map);
  draw_north_arrow(page, layout);
  draw_scale_bar(page, layout, below + 50.0 * u);
  draw_height_ramp(page, range, layout.panel.x + layout.panel.width, below + 50.0 * u);
  draw_legend(page, layout, below + 114.0 * u);
}

}  // namespace cairn::cli
