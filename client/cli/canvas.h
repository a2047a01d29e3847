#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <string>

namespace cairn::cli {

enum class Align { left, centre, right };

/// Drawing with smooth edges and text on a picture.
class Canvas {
 public:
  /// `unit` scales text and lines: 1 for pictures of about 1,400 pixels.
  Canvas(cv::Mat3b image, double unit) : image_(std::move(image)), unit_(unit) {}

  [[nodiscard]] double unit() const { return unit_; }
  [[nodiscard]] cv::Mat3b& image() { return image_; }

  /// `size` is the height of capitals [units]; `at` is on the base line.
  void text(const std::string& text, cv::Point2d at, double size, const cv::Scalar& colour,
            Align align = Align::left, bool bold = false);
  [[nodiscard]] double text_width(const std::string& text, double size, bool bold = false) const;
  /// `width` in units.
  void line(std::span<const cv::Point2d> points, double width, const cv::Scalar& colour);
  void dashes(std::span<const cv::Point2d> points, double width, double dash,
              const cv::Scalar& colour);
  void polygon(std::span<const cv::Point2d> points, const cv::Scalar& colour);
  void circle(cv::Point2d centre, double radius, const cv::Scalar& colour, double width = -1.0);
  /// Mixes `colour` over a rectangle; opacity 0 … 1.
  void wash(const cv::Rect& area, const cv::Scalar& colour, double opacity);
  void frame(const cv::Rect& area, double width, const cv::Scalar& colour);

 private:
  [[nodiscard]] int thickness(double width) const;

  cv::Mat3b image_;
  double unit_;
};

}  // namespace cairn::cli
