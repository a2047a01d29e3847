#include "tests/bench/lap.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>
#include <variant>

#include "core/common/angle.h"
#include "core/localization/match_raster.h"
#include "core/map/update.h"
#include "core/pose/dead_reckoning.h"
#include "robot_agent/input/simulator.h"
#include "robot_agent/pipeline/mapper.h"

namespace cairn::bench {
namespace {

constexpr double kMappingRangeM = 15.0;
constexpr MonotonicTime kLongestDrive = std::chrono::minutes(10);

/// Steers towards one way point after the other.
class Steering {
 public:
  explicit Steering(const std::vector<WayPoint>& way) : way_(way) {}

  [[nodiscard]] bool done() const { return next_ == way_.size(); }

  agent::DriveCommand command(const Pose& pose) {
    const double dx = way_[next_].x_m - pose.x_m;
    const double dy = way_[next_].y_m - pose.y_m;
    if (std::hypot(dx, dy) < 0.2) ++next_;
    const double off = wrap_angle(std::atan2(dy, dx) - pose.yaw_rad);
    return {.speed_m_s = std::abs(off) < radians(20.0) ? 0.5 : 0.0,
            .turn_rate_rad_s = std::clamp(2.0 * off, -0.6, 0.6)};
  }

 private:
  const std::vector<WayPoint>& way_;
  std::size_t next_ = 0;
};

using TakeReading = std::function<void(const agent::Reading&, agent::Input&)>;

Status drive(agent::Input& robot, const std::vector<WayPoint>& way, const TakeReading& take) {
  Steering steering(way);
  while (!steering.done()) {
    const std::optional<MonotonicTime> now = robot.next_stamp();
    if (!now || *now > kLongestDrive) {
      return Error{ErrorCode::unavailable, "the robot did not finish its way; try another seed"};
    }
    auto readings = robot.advance(*now);
    if (!readings) return readings.error();
    for (const agent::Reading& reading : *readings) take(reading, robot);
    robot.drive(steering.command(robot.truth()->T_site_robot));
  }
  return {};
}

Result<std::unique_ptr<agent::Input>> robot_in(const std::string& world, std::uint64_t seed,
                                               std::uint64_t noise) {
  auto built = agent::make_world(world, seed);
  if (!built) return built.error();
  agent::SimulatorConfig config;
  config.world = world;
  config.seed = noise;
  return agent::make_simulator(config, std::move(*built));
}

/// The agent's map making and localization with the world's map, and a pose module alone beside it.
class Localized {
 public:
  Localized(const agent::Input& robot, const HeightMap& long_term)
      : alone_(DeadReckoningConfig{}, robot.start()),
        mapper_(agent::MapperConfig{}, robot.lasers(), robot.start(), 1, evidence_) {
    std::vector<agent::GivenTile> tiles;
    for (const auto& [key, tile] : long_term.tiles()) tiles.push_back({key, *tile, 0});
    mapper_.take_tiles(tiles);
  }

  void take(const agent::Reading& reading, const agent::Input& robot) {
    const std::uint64_t refused = mapper_.corrections_refused();
    if (const auto* motion = std::get_if<MotionReading>(&reading)) {
      alone_.update(*motion);
      mapper_.take_motion(*motion);
      note(robot.truth()->T_site_robot);
    } else if (const auto* scan = std::get_if<Scan>(&reading)) {
      mapper_.take_scan(*scan);
    }
    if (mapper_.corrections_refused() > refused) lap_.last_refusal = mapper_.localization_why();
    lap_.lost = lap_.lost || mapper_.localization() == LocalizationState::lost;
  }

  void note(const Pose& truth) {
    lap_.truth.push_back(truth);
    lap_.corrected.push_back(mapper_.pose());
    lap_.uncorrected.push_back(alone_.pose());
  }

  [[nodiscard]] Lap finish(const Pose& truth) {
    note(truth);
    lap_.corrections = mapper_.corrections_accepted();
    lap_.refusals = mapper_.corrections_refused();
    return std::move(lap_);
  }

 private:
  DeadReckoning alone_;
  proto::EvidenceSender evidence_;
  agent::Mapper mapper_;
  Lap lap_;
};

void draw_track(cv::Mat& picture, const std::vector<Pose>& track, const cv::Scalar& colour,
                const std::function<cv::Point(double, double)>& pixel) {
  for (std::size_t i = 1; i < track.size(); ++i) {
    cv::line(picture, pixel(track[i - 1].x_m, track[i - 1].y_m), pixel(track[i].x_m, track[i].y_m),
             colour, 1, cv::LINE_AA);
  }
}

}  // namespace

Result<HeightMap> map_from_true_poses(const std::string& world, std::uint64_t seed,
                                      const std::vector<WayPoint>& way) {
  auto robot = robot_in(world, seed, seed + 10'000);
  if (!robot) return robot.error();
  HeightMap map(agent::MapperConfig{}.cell_size_mm);
  ScanIntegrator integrator(SensorModel{});
  const Status driven =
      drive(**robot, way, [&](const agent::Reading& reading, agent::Input& input) {
        const Scan* scan = std::get_if<Scan>(&reading);
        if (scan == nullptr) return;
        integrator.integrate(map,
                             beams_in_site(*scan, input.lasers()[scan->laser],
                                           input.truth()->T_site_robot, kMappingRangeM),
                             std::nullopt, nullptr);
      });
  if (!driven) return driven.error();
  return map;
}

Result<Lap> drive_lap(const std::string& world, std::uint64_t seed,
                      const std::vector<WayPoint>& way, const HeightMap& long_term) {
  auto robot = robot_in(world, seed, seed + 20'000);
  if (!robot) return robot.error();
  Localized localized(**robot, long_term);
  const Status driven = drive(
      **robot, way,
      [&](const agent::Reading& reading, agent::Input& input) { localized.take(reading, input); });
  if (!driven) return driven.error();
  return localized.finish((*robot)->truth()->T_site_robot);
}

PoseError error_of(const Pose& believed, const Pose& truth) {
  return {std::hypot(believed.x_m - truth.x_m, believed.y_m - truth.y_m),
          std::abs(believed.z_m - truth.z_m),
          std::abs(wrap_angle(believed.yaw_rad - truth.yaw_rad))};
}

Status draw(const HeightMap& map, const Lap& lap, const std::string& file) {
  constexpr int kPixels = 6;  // For a cell.
  const auto box = known_box(map);
  if (!box) return Error{ErrorCode::invalid_argument, "an empty map cannot be drawn"};
  const int width = box->highest.x - box->lowest.x + 1;
  const int height = box->highest.y - box->lowest.y + 1;
  cv::Mat picture(height, width, CV_8UC3, cv::Scalar(60, 40, 40));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Cell cell = map.cell({box->lowest.x + x, box->lowest.y + y});
      if (!cell.known()) continue;
      const auto grey = static_cast<std::uint8_t>(std::clamp(90 + cell.height_mm / 10, 0, 255));
      picture.at<cv::Vec3b>(height - 1 - y, x) = {grey, grey, grey};
    }
  }
  cv::resize(picture, picture, {}, kPixels, kPixels, cv::INTER_NEAREST);
  const auto pixel = [&](double x_m, double y_m) {
    const double scale = kPixels / map.cell_size_m();
    return cv::Point(
        static_cast<int>((x_m - box->lowest.x * map.cell_size_m()) * scale),
        static_cast<int>(height * kPixels - (y_m - box->lowest.y * map.cell_size_m()) * scale));
  };
  draw_track(picture, lap.uncorrected, {60, 60, 255}, pixel);
  draw_track(picture, lap.truth, {60, 220, 60}, pixel);
  draw_track(picture, lap.corrected, {255, 120, 40}, pixel);
  if (!cv::imwrite(file, picture)) {
    return Error{ErrorCode::io, "cannot write " + file + "; is its folder there?"};
  }
  return {};
}

}  // namespace cairn::bench
