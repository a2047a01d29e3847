#include "robot_agent/input/carmen_log.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/common/angle.h"
#include "robot_agent/input/carmen_line.h"
#include "robot_agent/input/limits.h"
#include "robot_agent/input/log_clock.h"
#include "robot_agent/input/log_lines.h"

namespace cairn::agent {
namespace {

constexpr std::size_t kMessagesToJudge = 256;  // How far the stamps are looked at when opening.
constexpr std::size_t kMostBeforeLaser = 10'000;
constexpr std::size_t kMostWaiting = 4096;  // For an earlier one to come.

LaserSpec spec_of(const CarmenMessage& message, const LogConfig& config) {
  LaserSpec spec;
  spec.T_robot_sensor.z_m = config.laser_height_m;
  spec.beam_count = static_cast<int>(message.range_m.size());
  spec.first_angle_rad = message.angles.first_rad;
  spec.step_rad = message.angles.step_rad;
  spec.max_range_m = config.max_range_m;
  spec.ground_along_beam = true;
  return spec;
}

constexpr char kOtherLaser[] =
    "another laser (number or angles of the readings) than before; cut the log here";

bool is_other_laser(const CarmenMessage& message, const LaserSpec& laser) {
  return !message.range_m.empty() &&
         (message.range_m.size() != static_cast<std::size_t>(laser.beam_count) ||
          std::abs(message.angles.first_rad - laser.first_angle_rad) > 1e-3 ||
          std::abs(message.angles.step_rad - laser.step_rad) > 1e-5);
}

// The messages of a log, one after the other; comments and other messages are left out.
class Messages {
 public:
  Messages(LogLines lines, std::string path) : lines_(std::move(lines)), path_(std::move(path)) {}

  Result<std::optional<CarmenMessage>> next() {
    while (true) {
      auto line = lines_.next();
      if (!line) {
        return line.error();
      }
      if (!line->has_value()) {
        return std::optional<CarmenMessage>();
      }
      auto message = parse_carmen_line(**line);
      if (!message) {
        return at_line(lines_.unfinished() ? "the file is cut off here; cut the line out"
                                           : message.error().message);
      }
      if (message->has_value()) {
        return message;
      }
    }
  }

  // An error about the message last returned.
  [[nodiscard]] Error at_line(const std::string& what) const {
    return {ErrorCode::corrupt, path_ + ", line " + std::to_string(lines_.number()) + ": " + what};
  }

 private:
  LogLines lines_;
  std::string path_;
};

// What is read when opening: enough to know the laser and to judge the stamps.
struct Beginning {
  std::vector<CarmenMessage> messages;
  std::optional<LaserSpec> laser;

  [[nodiscard]] std::vector<double> stamps_s() const {
    std::vector<double> stamps;
    for (std::size_t i = 0; i < std::min(messages.size(), kMessagesToJudge); ++i) {
      stamps.push_back(messages[i].stamp_s);
    }
    return stamps;
  }
};

Result<Beginning> read_beginning(Messages& messages, const LogConfig& config) {
  Beginning beginning;
  while (beginning.messages.size() < kMessagesToJudge ||
         (!beginning.laser && beginning.messages.size() < kMostBeforeLaser)) {
    auto message = messages.next();
    if (!message) {
      return message.error();
    }
    if (!message->has_value()) {
      break;
    }
    if (!beginning.laser && !(*message)->range_m.empty()) {
      beginning.laser = spec_of(**message, config);
    }
    if (beginning.laser && is_other_laser(**message, *beginning.laser)) {
      return messages.at_line(kOtherLaser);
    }
    beginning.messages.push_back(std::move(**message));
  }
  return beginning;
}

class CarmenLog final : public Input {
 public:
  CarmenLog(Messages messages, Beginning beginning)
      : messages_(std::move(messages)), lasers_{*beginning.laser}, clock_(beginning.stamps_s()) {
    for (CarmenMessage& message : beginning.messages) {
      take(std::move(message));
    }
    fetch();
  }

  [[nodiscard]] const std::vector<LaserSpec>& lasers() const override { return lasers_; }
  [[nodiscard]] Pose start() const override { return {}; }
  [[nodiscard]] bool finished() const override {
    return waiting_.empty() && (!error_ || error_told_);
  }
  void drive(const DriveCommand& /*command*/) override {}
  [[nodiscard]] bool can_drive() const override { return false; }
  [[nodiscard]] std::optional<Truth> truth() const override { return std::nullopt; }

  [[nodiscard]] std::optional<MonotonicTime> next_stamp() const override {
    if (finished()) {
      return std::nullopt;
    }
    return waiting_.empty() ? last_stamp_ : std::max(waiting_.begin()->first, last_stamp_);
  }

  Result<std::vector<Reading>> advance(MonotonicTime until) override {
    if (waiting_.empty() && error_) {
      error_told_ = true;
      return *error_;
    }
    std::vector<Reading> readings;
    while (!waiting_.empty() && *next_stamp() <= until) {
      auto first = waiting_.extract(waiting_.begin());
      fetch();
      replay(std::max(first.key(), last_stamp_), std::move(first.mapped()), readings);
    }
    return readings;
  }

 private:
  // Reads on until the first of the waiting messages can have no predecessor any more.
  void fetch() {
    while (!at_end_ && waiting_.size() < kMostWaiting &&
           (waiting_.empty() || waiting_.begin()->first > clock_.settled())) {
      auto message = messages_.next();
      if (!message) {
        stop(message.error());
      } else if (!message->has_value()) {
        at_end_ = true;
      } else if (is_other_laser(**message, lasers_.front())) {
        stop(
            messages_.at_line("another laser (number or angles of the readings) than before; "
                              "cut the log here"));
      } else {
        take(std::move(**message));
      }
    }
  }

  void take(CarmenMessage message) {
    const MonotonicTime time = clock_.time_of(message.stamp_s);
    waiting_.emplace(time, std::move(message));
  }

  void stop(Error error) {
    error_ = std::move(error);
    at_end_ = true;
  }

  void replay(MonotonicTime stamp, CarmenMessage message, std::vector<Reading>& readings) {
    gyro_yaw_rad_ = first_ ? message.yaw_rad
                           : gyro_yaw_rad_ + gyro_rate_rad_s_ * to_seconds(stamp - last_stamp_);
    first_ = false;
    last_stamp_ = stamp;
    readings.emplace_back(motion(message));
    if (turn_towards_next()) {
      readings.emplace_back(motion(message));
    }
    if (!message.range_m.empty()) {
      readings.emplace_back(Scan{stamp, 0, std::move(message.range_m)});
    }
  }

  [[nodiscard]] MotionReading motion(const CarmenMessage& message) const {
    MotionReading reading;
    reading.stamp = last_stamp_;
    reading.odometer_x_m = message.x_m;
    reading.odometer_y_m = message.y_m;
    reading.odometer_yaw_rad = message.yaw_rad;
    reading.gyro_yaw_rate_rad_s = gyro_rate_rad_s_;
    return reading;
  }

  // Sets the rate that leads to the next message's heading. Whether it is another than before;
  // turns between equal stamps go into the one after.
  bool turn_towards_next() {
    if (waiting_.empty() || waiting_.begin()->first <= last_stamp_) {
      return false;
    }
    const auto& [stamp, next] = *waiting_.begin();
    const double before = std::exchange(gyro_rate_rad_s_, wrap_angle(next.yaw_rad - gyro_yaw_rad_) /
                                                              to_seconds(stamp - last_stamp_));
    return gyro_rate_rad_s_ != before;
  }

  Messages messages_;
  std::vector<LaserSpec> lasers_;
  LogClock clock_;
  std::multimap<MonotonicTime, CarmenMessage> waiting_;
  MonotonicTime last_stamp_{};
  bool first_ = true;
  double gyro_yaw_rad_ = 0.0;  ///< What the rates so far add up to.
  double gyro_rate_rad_s_ = 0.0;
  bool at_end_ = false;
  std::optional<Error> error_;
  bool error_told_ = false;
};

}  // namespace

std::string faults(const LogConfig& c) {
  Faults faults;
  faults.check("max_range_m", c.max_range_m, 1.0, 200.0);
  faults.check("laser_height_m", c.laser_height_m, 0.0, 3.0);
  return faults.text();
}

Result<std::unique_ptr<Input>> open_carmen_log(const std::string& path, const LogConfig& config) {
  if (const std::string wrong = faults(config); !wrong.empty()) {
    return Error{ErrorCode::invalid_argument, "log: " + wrong};
  }
  auto lines = LogLines::open(path);
  if (!lines) {
    return lines.error();
  }
  Messages messages(std::move(*lines), path);
  auto beginning = read_beginning(messages, config);
  if (!beginning) {
    return beginning.error();
  }
  if (!beginning->laser) {
    return Error{
        ErrorCode::corrupt,
        path + " has no FLASER or ROBOTLASER1 message at its beginning; is it a CARMEN log?"};
  }
  return std::unique_ptr<Input>(
      std::make_unique<CarmenLog>(std::move(messages), std::move(*beginning)));
}

}  // namespace cairn::agent
