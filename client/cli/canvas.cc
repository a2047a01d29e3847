#include "client/cli/canvas.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace cairn::cli {

namespace {

/// Text is drawn this many times larger and shrunk: OpenCV's stroke fonts then look like type.
constexpr int kTextOversampling = 4;
constexpr int kSubpixelBits = 4;

cv::Point subpixel(const cv::Point2d& point) {
  return {cvRound(point.x * (1 << kSubpixelBits)), cvRound(point.y * (1 << kSubpixelBits))};
}

std::vector<cv::Point> subpixels(std::span<const cv::Point2d> points) {
  std::vector<cv::Point> result;
  result.reserve(points.size());
  for (const auto& point : points) result.push_back(subpixel(point));
  return result;
}

struct Type {
  int font = cv::FONT_HERSHEY_SIMPLEX;
  double scale = 1.0;
  int thickness = 1;
};

/// Capitals of the font are 21 of its units high at scale 1.
Type type_of(double capital_px, bool bold) {
  const double large = capital_px * kTextOversampling;
  return {bold ? cv::FONT_HERSHEY_DUPLEX : cv::FONT_HERSHEY_SIMPLEX, large / 21.0,
          std::max(1, cvRound(large * (bold ? 0.19 : 0.125)))};
}

/// Lets `colour` through where `mask` (0 … 255) is set.
void blend(cv::Mat3b image, const cv::Mat1b& mask, cv::Point at, const cv::Scalar& colour) {
  const cv::Rect area = cv::Rect(at, mask.size()) & cv::Rect({0, 0}, image.size());
  for (int row = area.y; row < area.y + area.height; ++row) {
    for (int column = area.x; column < area.x + area.width; ++column) {
      const double opacity = mask(row - at.y, column - at.x) / 255.0;
      auto& pixel = image(row, column);
      for (int i = 0; i < 3; ++i) {
        pixel[i] = cv::saturate_cast<uchar>(pixel[i] * (1.0 - opacity) + colour[i] * opacity);
      }
    }
  }
}

}  // namespace

double Canvas::text_width(const std::string& text, double size, bool bold) const {
  const auto type = type_of(size * unit_, bold);
  return static_cast<double>(
             cv::getTextSize(text, type.font, type.scale, type.thickness, nullptr).width) /
         kTextOversampling;
}

void Canvas::text(const std::string& text, cv::Point2d at, double size, const cv::Scalar& colour,
                  Align align, bool bold) {
  if (text.empty()) return;
  const auto type = type_of(size * unit_, bold);
  const auto width = text_width(text, size, bold);
  if (align == Align::centre) at.x -= width / 2.0;
  if (align == Align::right) at.x -= width;
  const int border = type.thickness + kTextOversampling;
  const auto box = cv::getTextSize(text, type.font, type.scale, type.thickness, nullptr);
  const int rise = box.height + border;
  const auto whole = [](int pixels) {
    return (pixels / kTextOversampling + 1) * kTextOversampling;
  };
  cv::Mat1b large(whole(2 * box.height + 2 * border), whole(box.width + 2 * border), uchar{0});
  cv::putText(large, text, {border, rise}, type.font, type.scale, 255, type.thickness, cv::LINE_AA);
  cv::Mat1b mask;
  cv::resize(large, mask, large.size() / kTextOversampling, 0, 0, cv::INTER_AREA);
  blend(image_, mask,
        {cvRound(at.x - static_cast<double>(border) / kTextOversampling),
         cvRound(at.y - static_cast<double>(rise) / kTextOversampling)},
        colour);
}

void Canvas::line(std::span<const cv::Point2d> points, double width, const cv::Scalar& colour) {
  if (points.size() < 2) return;
  const std::vector<std::vector<cv::Point>> lines = {subpixels(points)};
  cv::polylines(image_, lines, false, colour, thickness(width), cv::LINE_AA, kSubpixelBits);
}

void Canvas::dashes(std::span<const cv::Point2d> points, double width, double dash,
                    const cv::Scalar& colour) {
  const double length = dash * unit_;
  double along = 0.0;  // Of the whole line so far, so that dashes run round corners.
  for (std::size_t i = 1; i < points.size(); ++i) {
    const cv::Point2d step = points[i] - points[i - 1];
    const double all = std::hypot(step.x, step.y);
    for (double done = 0.0; done < all - 1e-6;) {
      const double left = length - std::fmod(along, length);
      const double part = std::min(std::max(left, 1e-3), all - done);
      if (std::fmod(along / length, 2.0) < 1.0) {
        const std::array<cv::Point2d, 2> ends = {points[i - 1] + step * (done / all),
                                                 points[i - 1] + step * ((done + part) / all)};
        line(ends, width, colour);
      }
      done += part;
      along += part;
    }
  }
}

void Canvas::polygon(std::span<const cv::Point2d> points, const cv::Scalar& colour) {
  const std::vector<std::vector<cv::Point>> polygons = {subpixels(points)};
  cv::fillPoly(image_, polygons, colour, cv::LINE_AA, kSubpixelBits);
}

void Canvas::circle(cv::Point2d centre, double radius, const cv::Scalar& colour, double width) {
  cv::circle(image_, subpixel(centre), cvRound(radius * unit_ * (1 << kSubpixelBits)), colour,
             width < 0.0 ? cv::FILLED : thickness(width), cv::LINE_AA, kSubpixelBits);
}

void Canvas::wash(const cv::Rect& area, const cv::Scalar& colour, double opacity) {
  const cv::Rect inside = area & cv::Rect({0, 0}, image_.size());
  if (inside.empty()) return;
  cv::Mat part = image_(inside);
  const cv::Mat cover(part.size(), part.type(), colour);
  cv::addWeighted(part, 1.0 - opacity, cover, opacity, 0.0, part);
}

void Canvas::frame(const cv::Rect& area, double width, const cv::Scalar& colour) {
  cv::rectangle(image_, area, colour, thickness(width), cv::LINE_AA);
}

int Canvas::thickness(double width) const { return std::max(1, cvRound(width * unit_)); }

}  // namespace cairn::cli
