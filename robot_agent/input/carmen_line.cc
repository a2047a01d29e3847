#include "robot_agent/input/carmen_line.h"

#include <charconv>
#include <cmath>
#include <utility>

#include "core/common/angle.h"

namespace cairn::agent {
namespace {

constexpr double kFarthestM = 1e5;    // A robot this far from its start has lost its odometer.
constexpr double kMaxStampS = 1e10;   // In the year 2286.
constexpr double kMaxAngleRad = 1e4;  // Headings may have been summed up over many turns.
constexpr double kMaxRangeM = 1e4;

// The words of a line, in turn. The first fault is kept and everything after it reads as 0.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}

  std::string_view word() {
    constexpr std::string_view kSpace = " \t\r";
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kSpace), rest_.size()));
    const std::string_view word = rest_.substr(0, rest_.find_first_of(kSpace));
    rest_.remove_prefix(word.size());
    return word;
  }

  // A number whose size is at most `limit`.
  double number(const std::string& what, double limit) {
    const std::string_view text = word();
    double value = 0.0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty()) {
      fail(what + " is missing");
    } else if (end != text.data() + text.size() || std::isnan(value) ||
               (fault != std::errc() && fault != std::errc::result_out_of_range)) {
      fail(what + " is not a number");
    } else if (std::abs(value) > limit) {
      fail(what + " is out of all bounds");
    }
    return fault_.empty() ? value : 0.0;
  }

  int count(const std::string& what, int least, int most) {
    const double value = number(what, 1e6);
    if (fault_.empty() && (value != std::floor(value) || value < least || value > most)) {
      fail(what + " must be from " + std::to_string(least) + " to " + std::to_string(most));
    }
    return fault_.empty() ? static_cast<int>(value) : 0;
  }

  // How many words are left.
  [[nodiscard]] int left() const {
    Words ahead = *this;
    int words = 0;
    while (!ahead.word().empty()) {
      ++words;
    }
    return words;
  }

  void fail(const std::string& what) { fault_ = fault_.empty() ? what : fault_; }
  [[nodiscard]] const std::string& fault() const { return fault_; }

 private:
  std::string_view rest_;
  std::string fault_;
};

void read_pose(Words& words, const std::string& what, CarmenMessage& message) {
  message.x_m = words.number(what + " x", kFarthestM);
  message.y_m = words.number(what + " y", kFarthestM);
  message.yaw_rad = wrap_angle(words.number(what + " theta", kMaxAngleRad));
}

// `words_after` the ranges the message has at least.
void read_ranges(Words& words, int count, int words_after, CarmenMessage& message) {
  if (words.left() < count + words_after) {
    words.fail("the line is too short for " + std::to_string(count) + " readings");
  }
  message.range_m.reserve(static_cast<std::size_t>(count));
  for (int i = 1; i <= count && words.fault().empty(); ++i) {
    const std::string what = "range " + std::to_string(i);
    const double range = words.number(what, kMaxRangeM);
    if (range < 0.0) {
      words.fail(what + " is negative");
    }
    message.range_m.push_back(static_cast<float>(range));
  }
}

// Every message ends with its time, the host's name and the logger's own time.
void read_stamp(Words& words, CarmenMessage& message) {
  message.stamp_s = words.number("the timestamp", kMaxStampS);
  if (words.word().empty()) {
    words.fail("the host's name is missing");
  }
  if (words.word().empty()) {
    words.fail("the logger's timestamp is missing");
  }
}

// ODOM x y theta tv rv accel
void read_odom(Words& words, CarmenMessage& message) {
  read_pose(words, "odometry", message);
  for (const char* what : {"tv", "rv", "accel"}) {
    words.number(what, kFarthestM);
  }
}

// FLASER num_readings [range_readings] x y theta odom_x odom_y odom_theta
void read_flaser(Words& words, CarmenMessage& message) {
  const int beams = words.count("the number of readings", 1, LaserSpec::kMaxBeams);
  read_ranges(words, beams, 9, message);
  read_pose(words, "laser pose", message);
  read_pose(words, "odometry", message);
  // An even number leaves out the beam at +90°.
  const double step = radians(180.0) / (beams % 2 == 0 ? beams : std::max(beams - 1, 1));
  message.angles = {radians(-90.0), step};
}

// ROBOTLASER1 laser_type start_angle field_of_view angular_resolution maximum_range accuracy
// remission_mode num_readings [range_readings] num_remissions [remission values] laser_pose(x y
// theta) robot_pose(x y theta) laser_tv laser_rv forward_safety_dist side_safety_dist turn_axis
void read_robotlaser(Words& words, CarmenMessage& message) {
  words.number("the laser type", 1e6);
  message.angles.first_rad = words.number("the start angle", 10.0);
  words.number("the field of view", 10.0);
  message.angles.step_rad = words.number("the angular resolution", 10.0);
  for (const char* what : {"the maximum range", "the accuracy", "the remission mode"}) {
    words.number(what, 1e6);
  }
  const int beams = words.count("the number of readings", 1, LaserSpec::kMaxBeams);
  if (!(std::abs(message.angles.step_rad) * (beams - 1) <= 6.3) || message.angles.step_rad == 0.0) {
    words.fail("the angular resolution times the number of readings is not an angle up to 360°");
  }
  read_ranges(words, beams, 15, message);
  const int remissions = words.count("the number of remissions", 0, LaserSpec::kMaxBeams);
  for (int i = 0; i < remissions && words.fault().empty(); ++i) {
    words.number("a remission value", 1e9);
  }
  read_pose(words, "laser pose", message);
  read_pose(words, "robot pose", message);
  for (const char* what : {"tv", "rv", "forward safety", "side safety", "turn axis"}) {
    words.number(what, 1e9);
  }
}

}  // namespace

Result<std::optional<CarmenMessage>> parse_carmen_line(std::string_view line) {
  Words words(line);
  const std::string_view name = words.word();
  CarmenMessage message;
  if (name == "ODOM") {
    read_odom(words, message);
  } else if (name == "FLASER") {
    read_flaser(words, message);
  } else if (name == "ROBOTLASER1") {
    read_robotlaser(words, message);
  } else {
    return std::optional<CarmenMessage>();
  }
  read_stamp(words, message);
  if (!words.word().empty()) {
    words.fail("there are more words than the message has");
  }
  if (!words.fault().empty()) {
    return Error{ErrorCode::corrupt,
                 std::string(name) + ": " + words.fault() + "; cut the line out or repair the log"};
  }
  return std::optional(std::move(message));
}

}  // namespace cairn::agent
