#include "core/pose/dead_reckoning.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/common/angle.h"

namespace cairn {
namespace {

using std::chrono::milliseconds;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

DeadReckoning at_origin() { return DeadReckoning({}, Pose{}); }

/// A robot with perfect instruments: its odometer runs along its own straight heading.
class Drive {
 public:
  explicit Drive(MotionReading first = {}) : now_(first) { reckoning.update(now_); }

  void step(double distance_m, double turn_rate_rad_s, milliseconds dt) {
    now_.stamp += dt;
    now_.odometer_x_m += distance_m;
    now_.gyro_yaw_rate_rad_s = turn_rate_rad_s;
    EXPECT_TRUE(reckoning.update(now_));
  }

  DeadReckoning reckoning = at_origin();

 private:
  MotionReading now_;
};

TEST(DeadReckoning, TwoMetresUpA30DegreeSlopeAreRoot3MetresAheadAndOneUp) {
  DeadReckoning reckoning({}, Pose{.pitch_rad = radians(-30)});
  MotionReading reading{.inclinometer_pitch_rad = radians(-30)};
  reckoning.update(reading);
  reading.stamp = milliseconds(1000);
  reading.odometer_x_m = 2.0;
  ASSERT_TRUE(reckoning.update(reading));
  EXPECT_NEAR(reckoning.pose().x_m, std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(reckoning.pose().y_m, 0.0, 1e-12);
  EXPECT_NEAR(reckoning.pose().z_m, 1.0, 1e-12);
}

TEST(DeadReckoning, TheFirstReadingOnlySetsTheReference) {
  DeadReckoning reckoning = at_origin();
  EXPECT_TRUE(reckoning.update({.odometer_x_m = 3, .odometer_y_m = 4, .gyro_yaw_rate_rad_s = 1}));
  EXPECT_EQ(reckoning.pose().x_m, 0.0);
  EXPECT_EQ(reckoning.pose().yaw_rad, 0.0);
  EXPECT_EQ(reckoning.distance_m(), 0.0);
}

TEST(DeadReckoning, YawComesFromTheGyroAndNotFromTheOdometer) {
  DeadReckoning reckoning = at_origin();
  MotionReading reading{.odometer_yaw_rad = 0.0, .gyro_yaw_rate_rad_s = 0.1};
  reckoning.update(reading);
  reading.stamp = milliseconds(1000);
  reading.odometer_yaw_rad = 1.3;
  reckoning.update(reading);
  EXPECT_NEAR(reckoning.pose().yaw_rad, 0.1, 1e-12);
}

TEST(DeadReckoning, YawIsTheMeanOfTheTwoRatesTimesTheTimeBetween) {
  DeadReckoning reckoning = at_origin();
  reckoning.update({.gyro_yaw_rate_rad_s = 0.2});
  reckoning.update({.stamp = milliseconds(500), .gyro_yaw_rate_rad_s = 0.6});
  EXPECT_NEAR(reckoning.pose().yaw_rad, 0.2, 1e-12);
}

TEST(DeadReckoning, AStepOfTurnAndTravelLeavesInTheDirectionOfItsMiddle) {
  Drive drive(MotionReading{.gyro_yaw_rate_rad_s = radians(60)});
  drive.step(1.0, radians(60), milliseconds(1000));
  EXPECT_NEAR(drive.reckoning.pose().x_m, std::cos(radians(30)), 1e-12);
  EXPECT_NEAR(drive.reckoning.pose().y_m, std::sin(radians(30)), 1e-12);
  EXPECT_NEAR(drive.reckoning.pose().yaw_rad, radians(60), 1e-12);
}

TEST(DeadReckoning, ACircleDrivenInSmallStepsCloses) {
  const double rate = radians(36);
  Drive drive(MotionReading{.gyro_yaw_rate_rad_s = rate});
  for (int i = 0; i < 200; ++i) drive.step(0.05, rate, milliseconds(50));
  EXPECT_NEAR(drive.reckoning.pose().x_m, 0.0, 1e-9);
  EXPECT_NEAR(drive.reckoning.pose().y_m, 0.0, 1e-9);
  EXPECT_NEAR(drive.reckoning.pose().yaw_rad, 0.0, 1e-9);
  EXPECT_NEAR(drive.reckoning.distance_m(), 10.0, 1e-9);
}

TEST(DeadReckoning, MotionAgainstTheOdometersHeadingIsBackward) {
  DeadReckoning reckoning({}, Pose{.yaw_rad = radians(90)});
  // The odometer believes it faces -x, so moving to +x is backing up.
  MotionReading reading{.odometer_yaw_rad = radians(180)};
  reckoning.update(reading);
  reading.stamp = milliseconds(100);
  reading.odometer_x_m = 0.5;
  reckoning.update(reading);
  EXPECT_NEAR(reckoning.pose().x_m, 0.0, 1e-12);
  EXPECT_NEAR(reckoning.pose().y_m, -0.5, 1e-12);
  EXPECT_NEAR(reckoning.distance_m(), 0.5, 1e-12);
}

TEST(DeadReckoning, RefusesReadingsThatAreNotFinite) {
  const double infinite = std::numeric_limits<double>::infinity();
  for (double MotionReading::*member :
       {&MotionReading::odometer_x_m, &MotionReading::odometer_y_m,
        &MotionReading::odometer_yaw_rad, &MotionReading::gyro_yaw_rate_rad_s,
        &MotionReading::inclinometer_roll_rad, &MotionReading::inclinometer_pitch_rad}) {
    for (const double bad : {kNan, infinite, -infinite}) {
      Drive drive;
      MotionReading reading{.stamp = milliseconds(100), .odometer_x_m = 1.0};
      reading.*member = bad;
      EXPECT_FALSE(drive.reckoning.update(reading));
      EXPECT_EQ(drive.reckoning.distance_m(), 0.0);
    }
  }
}

TEST(DeadReckoning, RefusesTimeThatGoesBack) {
  Drive drive;
  drive.step(0.1, 0.0, milliseconds(100));
  EXPECT_FALSE(drive.reckoning.update({.stamp = milliseconds(50), .odometer_x_m = 0.2}));
  EXPECT_NEAR(drive.reckoning.pose().x_m, 0.1, 1e-12);
}

TEST(DeadReckoning, RefusesAnInclinationThatIsNoAngle) {
  Drive drive;
  EXPECT_FALSE(drive.reckoning.update({.stamp = milliseconds(50), .inclinometer_pitch_rad = 4.0}));
}

TEST(DeadReckoning, AnOdometerThatWasResetMovesNothingAndCountsOnFromThere) {
  Drive drive(MotionReading{.odometer_x_m = 100.0});
  EXPECT_FALSE(drive.reckoning.update({.stamp = milliseconds(100)}));
  EXPECT_EQ(drive.reckoning.pose().x_m, 0.0);
  EXPECT_TRUE(drive.reckoning.update({.stamp = milliseconds(200), .odometer_x_m = 0.25}));
  EXPECT_NEAR(drive.reckoning.pose().x_m, 0.25, 1e-12);
}

TEST(DeadReckoning, KeepsTurningThroughAnOdometerReset) {
  DeadReckoning reckoning = at_origin();
  reckoning.update({.odometer_x_m = 100.0, .gyro_yaw_rate_rad_s = 0.5});
  reckoning.update({.stamp = milliseconds(100), .gyro_yaw_rate_rad_s = 0.5});
  reckoning.update({.stamp = milliseconds(200), .gyro_yaw_rate_rad_s = 0.5});
  EXPECT_NEAR(reckoning.pose().yaw_rad, 0.1, 1e-12);
}

TEST(DeadReckoning, AnAbsurdOdometerCannotOverflow) {
  Drive drive(MotionReading{.odometer_x_m = -1e308});
  EXPECT_FALSE(drive.reckoning.update({.stamp = milliseconds(100), .odometer_x_m = 1e308}));
  EXPECT_TRUE(is_finite(drive.reckoning.pose()));
}

TEST(DeadReckoning, ACorrectionReplacesPositionAndYawAndKeepsTheInclination) {
  DeadReckoning reckoning({}, Pose{.roll_rad = 0.1, .pitch_rad = 0.2, .yaw_rad = 0.3});
  const Pose corrected{.x_m = 1, .y_m = 2, .z_m = 3, .roll_rad = 9, .pitch_rad = 9, .yaw_rad = 0.4};
  const Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity() * 0.01;
  reckoning.correct(corrected, covariance);
  EXPECT_EQ(reckoning.pose().x_m, 1.0);
  EXPECT_EQ(reckoning.pose().y_m, 2.0);
  EXPECT_EQ(reckoning.pose().z_m, 3.0);
  EXPECT_EQ(reckoning.pose().yaw_rad, 0.4);
  EXPECT_EQ(reckoning.pose().roll_rad, 0.1);
  EXPECT_EQ(reckoning.pose().pitch_rad, 0.2);
  EXPECT_EQ(reckoning.covariance(), covariance);
}

TEST(DeadReckoningCovariance, GrowsAlongTheWayByTheSlipOfItsLengthHoweverFinelyItIsCut) {
  Drive coarse;
  for (int i = 0; i < 4; ++i) coarse.step(2.5, 0.0, milliseconds(1000));
  Drive fine;
  for (int i = 0; i < 400; ++i) fine.step(0.025, 0.0, milliseconds(10));
  EXPECT_NEAR(std::sqrt(coarse.reckoning.covariance()(0, 0)), 0.2, 1e-9);
  EXPECT_NEAR(std::sqrt(fine.reckoning.covariance()(0, 0)), 0.2, 1e-9);
}

TEST(DeadReckoningCovariance, OfYawIsFiveDegreesAfterALapAsTheThesisMeasured) {
  Drive drive(MotionReading{.gyro_yaw_rate_rad_s = radians(18)});
  for (int i = 0; i < 400; ++i) drive.step(0.1, radians(18), milliseconds(50));
  EXPECT_NEAR(degrees(std::sqrt(drive.reckoning.covariance()(3, 3))), 5.0, 1.0);
}

TEST(DeadReckoningCovariance, AnUncertainYawCarriesTheWaySideways) {
  Drive drive;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  covariance(3, 3) = 0.01 * 0.01;
  drive.reckoning.correct(Pose{}, covariance);
  for (int i = 0; i < 100; ++i) drive.step(0.1, 0.0, milliseconds(1));
  EXPECT_NEAR(std::sqrt(drive.reckoning.covariance()(1, 1)), 10.0 * 0.01, 0.002);
  EXPECT_GT(drive.reckoning.covariance()(1, 3), 0.0);
}

TEST(DeadReckoningCovariance, StandsStillExceptForTheGyroWhenTheRobotDoes) {
  Drive drive;
  for (int i = 0; i < 100; ++i) drive.step(0.0, 0.0, milliseconds(10));
  EXPECT_EQ(drive.reckoning.covariance()(0, 0), 0.0);
  EXPECT_NEAR(std::sqrt(drive.reckoning.covariance()(3, 3)), 0.002, 1e-9);
}

/// The instrument of T3.2: a first-order lag that needs 3 s to settle on a step.
class Inclinometer {
 public:
  double read(double truth_rad, double dt_s) {
    reading_rad_ += (1.0 - std::exp(-dt_s / 1.0)) * (truth_rad - reading_rad_);
    return reading_rad_;
  }

 private:
  double reading_rad_ = 0.0;
};

TEST(SettlingObserver, FindsAStepInLessThanHalfTheTimeTheInstrumentNeedsAndDoesNotOvershoot) {
  constexpr double kDt = 0.05;
  const double step = radians(20);
  Inclinometer instrument;
  SettlingObserver observer(1.0);
  observer.reset(0.0);
  double highest = 0.0;
  for (double t = kDt; t < 6.0; t += kDt) {
    const double reading = instrument.read(step, kDt);
    const double estimate = observer.update(reading, kDt);
    highest = std::max(highest, estimate);
    if (t > 1.35) {
      EXPECT_NEAR(estimate, step, 0.05 * step) << "at " << t << " s";
    }
    if (t < 2.9) {
      EXPECT_LT(reading, 0.95 * step) << "the instrument itself is slower";
    }
  }
  EXPECT_LT(highest, 1.02 * step);
}

TEST(SettlingObserver, DoesNotBlowUpTheNoiseOfTheSensorAt20ReadingsPerSecond) {
  constexpr unsigned kSeed = 3;
  const double sigma = radians(0.2);
  std::mt19937 random(kSeed);
  std::normal_distribution<double> noise(0.0, sigma);
  SettlingObserver observer(1.0);
  observer.reset(0.0);
  double squares = 0.0;
  constexpr int kReadings = 20'000;
  for (int i = 0; i < kReadings; ++i) {
    const double estimate = observer.update(noise(random), 0.05);
    squares += estimate * estimate;
  }
  EXPECT_LT(std::sqrt(squares / kReadings), sigma) << "seed " << kSeed;
}

TEST(SettlingObserver, StaysCalmWhenReadingsAreRare) {
  SettlingObserver observer(1.0);
  observer.reset(0.0);
  EXPECT_NEAR(observer.update(0.1, 60.0), 0.1, 1e-9);
}

TEST(SettlingObserver, WithoutDelayTakesTheReading) {
  SettlingObserver observer(0.0);
  observer.reset(0.0);
  EXPECT_EQ(observer.update(0.25, 0.01), 0.25);
}

TEST(DeadReckoning, ClimbsARampWithTheSlowInclinometerToWithinCentimetres) {
  constexpr double kDt = 0.05;
  constexpr double kStep = 0.5 * kDt;
  Inclinometer instrument;
  DeadReckoning reckoning = at_origin();
  MotionReading reading;
  reckoning.update(reading);
  double true_z_m = 0.0;
  double raw_z_m = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double pitch = i < 40 ? 0.0 : radians(-10);  // Onto the ramp after 1 m.
    reading.stamp += milliseconds(50);
    reading.odometer_x_m += kStep;
    reading.inclinometer_pitch_rad = instrument.read(pitch, kDt);
    ASSERT_TRUE(reckoning.update(reading));
    true_z_m += kStep * -std::sin(pitch);
    raw_z_m += kStep * -std::sin(reading.inclinometer_pitch_rad);
  }
  EXPECT_NEAR(reckoning.pose().z_m, true_z_m, 0.05);
  EXPECT_GT(true_z_m - raw_z_m, 0.08) << "the reading alone must be worse, or this tests nothing";
}

}  // namespace
}  // namespace cairn
