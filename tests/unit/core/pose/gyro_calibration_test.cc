#include "core/pose/gyro_calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/pose/dead_reckoning.h"

namespace cairn {
namespace {

constexpr double kScale = 0.012;
constexpr double kBiasRadS = 0.0006;
constexpr double kStepS = 0.05;

/// A gyro with this scale, bias and walk.
class Gyro {
 public:
  double read(double rate_rad_s, double dt_s) {
    return (1.0 + kScale) * rate_rad_s + kBiasRadS + 0.0009 / std::sqrt(dt_s) * noise_(random_);
  }

 private:
  std::mt19937_64 random_{7};
  std::normal_distribution<double> noise_;
};

TEST(GyroCalibration, LearnsTheBiasWhileTheWheelsStand) {
  Gyro gyro;
  GyroCalibration calibration({});
  for (int i = 0; i < 1200; ++i) EXPECT_TRUE(calibration.stood(gyro.read(0.0, kStepS), kStepS));
  EXPECT_NEAR(calibration.bias_rad_s(), kBiasRadS, 0.00025);
  EXPECT_EQ(calibration.scale(), 0.0);
}

TEST(GyroCalibration, LearnsScaleAndBiasFromTurnsThatTheSurroundingsTell) {
  Gyro gyro;
  GyroCalibration calibration({});
  const double before_rad = calibration.sigma_rad(3.0, 10.0);
  for (int i = 0; i < 40; ++i) {
    const double rate_rad_s = i % 3 == 0 ? 0.3 : i % 3 == 1 ? -0.1 : 0.0;
    const double turned_rad = calibration.rate_rad_s(gyro.read(rate_rad_s, 10.0)) * 10.0;
    EXPECT_TRUE(calibration.missed(rate_rad_s * 10.0 - turned_rad, turned_rad, 10.0, 0.003));
  }
  EXPECT_NEAR(calibration.scale(), kScale, 0.0015);
  EXPECT_NEAR(calibration.bias_rad_s(), kBiasRadS, 0.00015);
  EXPECT_LT(calibration.sigma_rad(3.0, 10.0), 0.3 * before_rad);
}

TEST(GyroCalibration, DoesNotLearnFromARobotThatIsTurnedByHand) {
  GyroCalibration calibration({});
  EXPECT_FALSE(calibration.stood(0.2, kStepS));
  EXPECT_FALSE(calibration.missed(0.5, 1.0, 10.0, 0.003));
  EXPECT_EQ(calibration.scale(), 0.0);
  EXPECT_EQ(calibration.bias_rad_s(), 0.0);
}

TEST(GyroCalibration, KnowsNoLessAfterYearsThanBeforehand) {
  GyroCalibration calibration({});
  const double before_rad = calibration.sigma_rad(1.0, 1.0);
  calibration.pass(1e12);
  EXPECT_EQ(calibration.sigma_rad(1.0, 1.0), before_rad);
}

TEST(GyroCalibration, StaysWithinItsBoundsWhateverItIsTaught) {
  GyroCalibrationConfig unsure;
  unsure.scale_sigma = 10.0;
  GyroCalibration calibration(unsure);
  EXPECT_TRUE(calibration.missed(3.0, 3.0, 1.0, 0.003));
  EXPECT_EQ(calibration.scale(), -GyroCalibration::kMaxScale);
  EXPECT_TRUE(std::isfinite(calibration.rate_rad_s(1.0)));
}

TEST(GyroCalibration, KeepsTheHeadingOfARobotThatStands) {
  Gyro gyro;
  DeadReckoning dead_reckoning({}, {});
  MotionReading reading;
  const auto stand = [&](int readings) {
    for (int i = 0; i < readings; ++i) {
      reading.stamp += std::chrono::milliseconds(50);
      reading.gyro_yaw_rate_rad_s = gyro.read(0.0, kStepS);
      ASSERT_TRUE(dead_reckoning.update(reading));
    }
  };
  stand(2400);
  const double before_rad = dead_reckoning.pose().yaw_rad;
  stand(1200);
  // Left to itself the bias turns it by 0.036 rad within this minute, the walk by 0.007.
  EXPECT_NEAR(dead_reckoning.pose().yaw_rad, before_rad, 0.02);
}

}  // namespace
}  // namespace cairn
