#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "core/map/fold.h"
#include "robot_agent/pipeline/mapper.h"
#include "tests/support/evidence_frames.h"
#include "tests/unit/robot_agent/pipeline/scene.h"

namespace cairn::agent::testing {

inline constexpr std::uint64_t kBoot = 77;
inline constexpr double kSpeed_m_s = 0.5;
inline constexpr Duration kPeriod = std::chrono::milliseconds(50);

/// The ATRV-Jr with perfect instruments in a scene.
class MappingRobot {
 public:
  explicit MappingRobot(MapperConfig config = {}, Pose start = {},
                        std::vector<LaserSpec> lasers = atrv_jr_lasers())
      : scene{.boxes = {}, .ground_m = start.z_m},
        truth(start),
        lasers_(std::move(lasers)),
        mapper(config, lasers_, start, kBoot, evidence) {
    reading_.odometer_yaw_rad = start.yaw_rad;
    mapper.take_motion(reading_);
  }

  Scene scene;
  Pose truth;  ///< Where it stands in the scene, whatever it believes.

 private:
  std::vector<LaserSpec> lasers_;
  MotionReading reading_;

 public:
  proto::EvidenceSender evidence;
  Mapper mapper;

  void look() {
    for (std::size_t i = 0; i < lasers_.size(); ++i) {
      mapper.take_scan(scene.scan(lasers_[i], i, truth, reading_.stamp));
    }
  }
  void forward(double way_m) {
    const int steps = static_cast<int>(std::lround(way_m / (kSpeed_m_s * to_seconds(kPeriod))));
    for (int i = 0; i < steps; ++i) move(kSpeed_m_s, 0.0, i % 4 == 3);
  }
  void roll_blindly(double way_m) {
    const int steps = static_cast<int>(std::lround(way_m / (kSpeed_m_s * to_seconds(kPeriod))));
    for (int i = 0; i < steps; ++i) move(kSpeed_m_s, 0.0, false);
  }
  void stand(int readings) {
    for (int i = 0; i < readings; ++i) move(0.0, 0.0, false);
  }
  void turn(double angle_rad) {
    const double rate = angle_rad < 0.0 ? -0.5 : 0.5;
    const int steps = static_cast<int>(std::lround(angle_rad / (rate * to_seconds(kPeriod))));
    for (int i = 0; i < steps; ++i) move(0.0, rate, i % 4 == 3);
    move(0.0, 0.0, true);
  }

  /// The cell at a place.
  [[nodiscard]] Cell at(double x_m, double y_m) const {
    const double cell_m = mapper.cell_size_mm() / 1000.0;
    return mapper.cell({static_cast<std::int32_t>(std::floor(x_m / cell_m)),
                        static_cast<std::int32_t>(std::floor(y_m / cell_m))});
  }

 private:
  void move(double speed_m_s, double turn_rad_s, bool look_too) {
    const double way_m = speed_m_s * to_seconds(kPeriod);
    reading_.stamp += kPeriod;
    reading_.odometer_x_m += way_m * std::cos(reading_.odometer_yaw_rad);
    reading_.odometer_y_m += way_m * std::sin(reading_.odometer_yaw_rad);
    truth.x_m += way_m * std::cos(truth.yaw_rad);
    truth.y_m += way_m * std::sin(truth.yaw_rad);
    truth.yaw_rad = wrap_angle(truth.yaw_rad + turn_rad_s * to_seconds(kPeriod));
    reading_.odometer_yaw_rad =
        wrap_angle(reading_.odometer_yaw_rad + turn_rad_s * to_seconds(kPeriod));
    reading_.gyro_yaw_rate_rad_s = turn_rad_s;
    mapper.take_motion(reading_);
    if (look_too) look();
  }
};

inline MapperConfig short_submaps() {
  MapperConfig config;
  config.submap_distance_m = 0.4;
  return config;
}

inline HeightMap fold_of(const std::map<std::uint32_t, Submap>& submaps) {
  HeightMap site(125);
  for (const auto& [sequence, submap] : submaps) (void)fold(site, submap, SensorModel{});
  return site;
}

}  // namespace cairn::agent::testing
