#include "client/cli/map_overlay.h"

#include <array>
#include <cmath>

namespace cairn::cli {

namespace {

std::vector<cv::Point2d> in_panel(const PictureLayout& layout,
                                  const std::vector<api::PointJson>& points) {
  std::vector<cv::Point2d> result;
  result.reserve(points.size());
  for (const auto& point : points) result.push_back(layout.in_panel(point.x_m, point.y_m));
  return result;
}

bool under_way(const api::CommandJson& command) {
  return command.kind == "goto" &&
         (command.state == "sent" || command.state == "accepted" || command.state == "blocked");
}

/// The name on a light plate beside the robot, inside the panel.
void draw_name(Canvas& panel, cv::Point2d at, const std::string& name) {
  const double unit = panel.unit();
  const double width = panel.text_width(name, 10.0) + 12.0 * unit;
  double left = at.x + 16.0 * unit;
  if (left + width > panel.image().cols) left = at.x - 16.0 * unit - width;
  const cv::Rect plate(cvRound(left), cvRound(at.y - 10.0 * unit), cvRound(width),
                       cvRound(20.0 * unit));
  panel.wash(plate, kWhite, 0.82);
  panel.text(name, {left + 6.0 * unit, at.y + 5.0 * unit}, 10.0, kInk);
}

}  // namespace

void draw_track(Canvas& canvas, std::span<const cv::Point2d> points) {
  canvas.line(points, 4.5, kWhite);
  canvas.line(points, 2.0, kTrackColour);
}

void draw_path(Canvas& canvas, std::span<const cv::Point2d> points) {
  canvas.line(points, 6.0, kWhite);
  canvas.dashes(points, 3.0, 11.0, kPathColour);
}

void draw_goal(Canvas& canvas, cv::Point2d at) {
  canvas.circle(at, 11.0, kWhite);
  canvas.circle(at, 8.5, kGoalColour, 3.0);
  canvas.circle(at, 3.5, kGoalColour);
}

void draw_robot(Canvas& canvas, cv::Point2d at, double yaw_rad) {
  const auto arrow = [&](double size) {
    const auto corner = [&](double ahead, double left) {
      const double a = ahead * size * canvas.unit();
      const double l = left * size * canvas.unit();
      return at + cv::Point2d(a * std::cos(yaw_rad) - l * std::sin(yaw_rad),
                              -a * std::sin(yaw_rad) - l * std::cos(yaw_rad));
    };
    return std::array<cv::Point2d, 4>{corner(1.0, 0.0), corner(-0.8, 0.72), corner(-0.4, 0.0),
                                      corner(-0.8, -0.72)};
  };
  canvas.polygon(arrow(18.5), kWhite);
  canvas.polygon(arrow(15.5), kInk);
  canvas.polygon(arrow(12.0), kRobotColour);
}

void draw_motion(Canvas& panel, const PictureLayout& layout, const SiteMap& map,
                 const PictureOptions& options) {
  for (const auto& track : map.head.tracks) draw_track(panel, in_panel(layout, track));
  if (!options.path.empty()) draw_path(panel, in_panel(layout, options.path));
  for (const auto& robot : map.head.robots) {
    if (!robot.command || !under_way(*robot.command)) continue;
    draw_path(panel, in_panel(layout, robot.command->path));
    draw_goal(panel, layout.in_panel(robot.command->goal.x_m, robot.command->goal.y_m));
  }
  if (options.goal) draw_goal(panel, layout.in_panel(options.goal->x_m, options.goal->y_m));
  for (const auto& robot : map.head.robots) {
    const auto at = layout.in_panel(robot.x_m, robot.y_m);
    draw_robot(panel, at, robot.yaw_rad);
    draw_name(panel, at, robot.id);
  }
}

}  // namespace cairn::cli
