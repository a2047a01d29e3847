#include "robot_agent/input/carmen_log.h"

#include <boost/iostreams/filter/bzip2.hpp>
#include <boost/iostreams/filter/gzip.hpp>
#include <boost/iostreams/filtering_stream.hpp>
#include <cmath>
#include <sstream>

#include "core/common/angle.h"
#include "tests/support/data_folder.h"
#include "tests/unit/robot_agent/input/scratch_folder.h"

namespace cairn::agent {
namespace {

// Three beams, robot at (x, 0).
std::string flaser(double x_m, double yaw_rad, double stamp_s) {
  std::ostringstream line;
  line.precision(15);
  line << "FLASER 3 1.5 2.5 81.83 9 9 9 " << x_m << " 0 " << yaw_rad << " " << stamp_s << " host "
       << stamp_s << "\n";
  return line.str();
}

std::string odom(double x_m, double yaw_rad, double stamp_s) {
  std::ostringstream line;
  line.precision(15);
  line << "ODOM " << x_m << " 0 " << yaw_rad << " 0 0 0 " << stamp_s << " host " << stamp_s << "\n";
  return line.str();
}

template <class Compressor>
std::string packed(const std::string& text) {
  std::ostringstream out;
  {
    boost::iostreams::filtering_ostream stream;
    stream.push(Compressor());
    stream.push(out);
    stream << text;
  }
  return out.str();
}

struct Replay {
  std::vector<MotionReading> motions;
  std::vector<Scan> scans;
  std::vector<LaserSpec> lasers;
  std::string error;
};

void collect(std::vector<Reading> readings, Replay& replay) {
  for (Reading& reading : readings) {
    if (auto* scan = std::get_if<Scan>(&reading)) {
      replay.scans.push_back(std::move(*scan));
    } else {
      replay.motions.push_back(std::get<MotionReading>(reading));
    }
  }
}

Replay replay(const std::string& path, const LogConfig& config = {}) {
  Replay replay;
  auto log = open_carmen_log(path, config);
  if (!log) {
    replay.error = log.error().message;
    return replay;
  }
  replay.lasers = (*log)->lasers();
  while (!(*log)->finished()) {
    auto readings = (*log)->advance(*(*log)->next_stamp());
    if (!readings) {
      replay.error = readings.error().message;
      return replay;
    }
    collect(std::move(*readings), replay);
  }
  return replay;
}

const std::string kShort = "# comment\nPARAM a b\n" + odom(0.0, 0.1, 100.0) +
                           flaser(0.5, 0.2, 100.5) + "SYNC x\n" + odom(1.0, 0.4, 101.0);

void expect_short(const Replay& log) {
  EXPECT_EQ(log.error, "");
  ASSERT_EQ(log.scans.size(), 1U);
  EXPECT_EQ(log.scans[0].stamp, from_seconds(0.5));
  EXPECT_EQ(log.scans[0].range_m, (std::vector<float>{1.5F, 2.5F, 81.83F}));
  ASSERT_FALSE(log.motions.empty());
  EXPECT_EQ(log.motions.front().stamp, MonotonicTime{0});
  EXPECT_DOUBLE_EQ(log.motions.back().odometer_x_m, 1.0);
  EXPECT_EQ(log.motions.back().stamp, from_seconds(1.0));
}

class CarmenLogTest : public ScratchFolder {
 protected:
  std::string error_of(const std::string& text) { return replay(write("x.log", text)).error; }
};

TEST_F(CarmenLogTest, ReplaysOdometryAndScansFromTimeZero) {
  const Replay log = replay(write("a.log", kShort));
  expect_short(log);
  ASSERT_EQ(log.lasers.size(), 1U);
  EXPECT_TRUE(log.lasers[0].ground_along_beam);
  EXPECT_EQ(log.lasers[0].beam_count, 3);
  EXPECT_EQ(log.lasers[0].max_range_m, 30.0);
  EXPECT_DOUBLE_EQ(log.lasers[0].T_robot_sensor.z_m, 0.30);
  EXPECT_NEAR(degrees(log.lasers[0].first_angle_rad), -90.0, 1e-9);
  EXPECT_NEAR(degrees(log.lasers[0].step_rad), 90.0, 1e-9);
}

TEST_F(CarmenLogTest, UnpacksGzipAndBzip2WhateverTheFileIsCalled) {
  expect_short(replay(write("a.log", packed<boost::iostreams::gzip_compressor>(kShort))));
  expect_short(replay(write("b.log", packed<boost::iostreams::bzip2_compressor>(kShort))));
}

TEST_F(CarmenLogTest, GivesAGyroThatAddsUpToTheOdometersHeading) {
  // Pairs of readings close together and apart, two with the same stamp.
  const std::string text = flaser(0, 0.0, 10.0) + odom(0, 0.1, 10.001) + odom(0, 0.3, 10.2) +
                           odom(0, 0.35, 10.2) + odom(0, 0.4, 10.201) + odom(0, -3.0, 11.0) +
                           odom(0, 3.1, 11.2) + odom(0, 3.0, 11.9);
  const Replay log = replay(write("a.log", text));
  ASSERT_EQ(log.error, "");
  double trapezoid = 0.0;
  double rectangle = 0.0;
  for (std::size_t i = 1; i < log.motions.size(); ++i) {
    const double dt = to_seconds(log.motions[i].stamp - log.motions[i - 1].stamp);
    const double rate = log.motions[i].gyro_yaw_rate_rad_s;
    trapezoid += 0.5 * dt * (rate + log.motions[i - 1].gyro_yaw_rate_rad_s);
    rectangle += dt * rate;
  }
  EXPECT_NEAR(wrap_angle(trapezoid - 3.0), 0.0, 1e-6);
  EXPECT_NEAR(wrap_angle(rectangle - 3.0), 0.0, 1e-6);
}

TEST_F(CarmenLogTest, PutsReadingsThatAreALittleLateInOrder) {
  const Replay log = replay(
      write("a.log", odom(0, 0, 10.0) + odom(2, 0, 10.2) + flaser(1, 0, 10.1) + odom(3, 0, 10.3)));
  ASSERT_EQ(log.error, "");
  double last_x = -1.0;
  for (const MotionReading& motion : log.motions) {
    EXPECT_GE(motion.odometer_x_m, last_x);
    last_x = motion.odometer_x_m;
  }
  EXPECT_EQ(log.scans.at(0).stamp, from_seconds(0.1));
}

TEST_F(CarmenLogTest, KnowsTheAnglesOfCommonLasers) {
  for (const auto& [beams, step_deg] : {std::pair{180, 1.0}, {181, 1.0}, {360, 0.5}, {361, 0.5}}) {
    std::string line = "FLASER " + std::to_string(beams);
    for (int i = 0; i < beams; ++i) {
      line += " 1.0";
    }
    const Replay log = replay(write("a.log", line + " 0 0 0 0 0 0 5 host 5\n"));
    ASSERT_EQ(log.error, "");
    EXPECT_NEAR(degrees(log.lasers.at(0).step_rad), step_deg, 1e-9) << beams;
  }
}

TEST_F(CarmenLogTest, ReadsTheNewerLaserMessage) {
  const Replay log = replay(write("a.log",
                                  "ROBOTLASER1 0 -1.5 3.0 0.75 50.0 0.1 1 5 1 2 3 4 5 2 7 8 1 2 3 "
                                  "4 5 0.6 0 0 0 0 0 100.0 host 0.5\n"));
  ASSERT_EQ(log.error, "");
  EXPECT_EQ(log.scans.at(0).range_m.size(), 5U);
  EXPECT_DOUBLE_EQ(log.lasers.at(0).first_angle_rad, -1.5);
  EXPECT_DOUBLE_EQ(log.lasers.at(0).step_rad, 0.75);
  EXPECT_DOUBLE_EQ(log.motions.at(0).odometer_x_m, 4.0);
  EXPECT_DOUBLE_EQ(log.motions.at(0).odometer_yaw_rad, 0.6);
}

TEST_F(CarmenLogTest, NamesTheLineAndWhatIsWrongWithIt) {
  const std::string good = flaser(0, 0, 1);
  const auto expect_fault = [&](const std::string& bad, const std::string& what) {
    const std::string error = error_of(good + bad);
    EXPECT_NE(error.find("line 2"), std::string::npos) << error;
    EXPECT_NE(error.find(what), std::string::npos) << error;
  };
  expect_fault("FLASER 3 1 nan 1 0 0 0 0 0 0 2 h 2\n", "range 2 is not a number");
  expect_fault("FLASER 3 1 -1 1 0 0 0 0 0 0 2 h 2\n", "range 2 is negative");
  expect_fault("FLASER 3 1 2x 1 0 0 0 0 0 0 2 h 2\n", "range 2 is not a number");
  expect_fault("FLASER 3 1 1 1 0 0 0 1e9 0 0 2 h 2\n", "odometry x is out of all bounds");
  expect_fault("FLASER 9 1 1 1 0 0 0 0 0 0 2 h 2\n", "too short for 9 readings");
  expect_fault("FLASER 3 1 1 1 1 0 0 0 0 0 0 2 h 2\n", "more words");
  expect_fault("FLASER 2 1 1 0 0 0 0 0 0 2 h 2\n", "another laser");
  expect_fault("FLASER 999999 1 1\n", "must be from 1 to 4096");
  expect_fault("ODOM 0 nan 0 0 0 0 2 h 2\n", "odometry y is not a number");
  expect_fault("ODOM 0 0 0 0 0 0 1e300 h 2\n", "timestamp");
  expect_fault("ODOM 0 0\n", "missing");
  expect_fault("ODOM 0 0 0 0 0 0 2 h 2 more\n", "more words");
  expect_fault("ODOM 0 0 0 0", "the file is cut off");
  expect_fault(std::string(300'000, 'x') + "\n", "256 kB");
}

TEST_F(CarmenLogTest, ReplaysWhatComesBeforeABadLineOfALongLog) {
  std::string text;
  for (int i = 0; i < 1000; ++i) {
    text += flaser(0.01 * i, 0, 0.1 * i);
  }
  const Replay log = replay(write("a.log", text + "ODOM x\n"));
  EXPECT_EQ(log.scans.size(), 1000U);
  EXPECT_NE(log.error.find("line 1001"), std::string::npos) << log.error;
}

TEST_F(CarmenLogTest, NoticesAPackedLogThatIsCutOff) {
  std::string text;
  for (int i = 0; i < 5000; ++i) {
    text += flaser(std::sin(i), std::cos(0.1 * i), 0.1 * i);
  }
  for (const std::string& whole : {packed<boost::iostreams::gzip_compressor>(text),
                                   packed<boost::iostreams::bzip2_compressor>(text)}) {
    for (const std::size_t size : {whole.size() / 2, whole.size() - 3, std::size_t{20}}) {
      const Replay log = replay(write("a.log", whole.substr(0, size)));
      EXPECT_NE(log.error.find("damaged or cut off"), std::string::npos)
          << log.error << " after " << log.scans.size() << " scans";
    }
  }
}

TEST_F(CarmenLogTest, RefusesWhatIsNoLog) {
  EXPECT_NE(replay(path("none.log")).error.find("there is no log file"), std::string::npos);
  EXPECT_NE(error_of("").find("no FLASER"), std::string::npos);
  EXPECT_NE(error_of("hello\nworld\n").find("no FLASER"), std::string::npos);
  EXPECT_NE(replay(write("a.log", kShort), {.max_range_m = 0.0}).error.find("max_range_m"),
            std::string::npos);
}

TEST_F(CarmenLogTest, CannotDriveAndKnowsNoTruth) {
  const auto log = open_carmen_log(write("a.log", kShort), {});
  ASSERT_TRUE(log);
  EXPECT_FALSE((*log)->can_drive());
  EXPECT_FALSE((*log)->truth().has_value());
}

class RealLog : public testing::Test {
 protected:
  void SetUp() override {
    if (test::data_folder().empty()) {
      GTEST_SKIP() << "skipped: no folder of real data (set CAIRN_DATA)";
    }
  }
  static Replay replay_file(const std::string& name) {
    return replay((test::data_folder() / "logs" / name).string());
  }
};

TEST_F(RealLog, IntelReplaysWhole) {
  const Replay log = replay_file("intel.clf.bz2");
  EXPECT_EQ(log.error, "");
  EXPECT_EQ(log.scans.size(), 13'631U);
  EXPECT_EQ(log.lasers.at(0).beam_count, 180);
  EXPECT_NEAR(to_seconds(log.motions.back().stamp), 2691.0, 1.0);
}

TEST_F(RealLog, LogsWithoutUsableStampsReplayWholeInFileOrder) {
  EXPECT_EQ(replay_file("freiburg-campus-corrected.log.gz").scans.size(), 2008U);
  EXPECT_EQ(replay_file("orebro-corrected.log.gz").scans.size(), 237U);
}

TEST_F(RealLog, TheNewerLaserMessageReplaysWhole) {
  const Replay log = replay_file("intel-lab.flirt-corrected.log.gz");
  EXPECT_EQ(log.error, "");
  EXPECT_EQ(log.scans.size(), 2672U);
}

}  // namespace
}  // namespace cairn::agent
