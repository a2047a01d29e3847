#include "robot_agent/input/world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robot_agent/input/vehicle.h"

namespace cairn::agent {
namespace {

class EveryWorld : public testing::TestWithParam<const char*> {};

TEST_P(EveryWorld, StartsAtHeightZeroWhereARobotCanTurnAndSetOff) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const auto world = make_world(GetParam(), seed);
    ASSERT_TRUE(world) << world.error().message;
    const Vehicle vehicle({}, world->surface, world->start);
    EXPECT_NEAR(vehicle.pose().z_m, 0.0, 0.05) << "seed " << seed;
    for (double yaw = -3.0; yaw <= 3.0; yaw += 0.5) {
      EXPECT_TRUE(vehicle.stands_free(world->start.x_m, world->start.y_m, yaw)) << "seed " << seed;
    }
  }
}

TEST_P(EveryWorld, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const auto one = make_world(GetParam(), 5);
  const auto same = make_world(GetParam(), 5);
  const auto other = make_world(GetParam(), 6);
  ASSERT_TRUE(one && same && other);
  int differences = 0;
  for (int row = 0; row < one->surface.rows(); row += 3) {
    for (int column = 0; column < one->surface.columns(); column += 3) {
      ASSERT_EQ(one->surface.at(column, row), same->surface.at(column, row));
      differences += one->surface.at(column, row) != other->surface.at(column, row) ? 1 : 0;
    }
  }
  EXPECT_GT(differences, 1000);
}

INSTANTIATE_TEST_SUITE_P(Worlds, EveryWorld, testing::Values("room", "ramp", "block", "hill"),
                         [](const auto& name) { return std::string(name.param); });

TEST(Room, LeavesALapOfThirtyTwoMetresFree) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const auto room = make_world("room", seed);
    ASSERT_TRUE(room);
    const Vehicle vehicle({}, room->surface, room->start);
    for (double s = 2.5; s <= 10.5; s += 0.1) {
      EXPECT_TRUE(vehicle.stands_free(s, 2.5, 0.0)) << "seed " << seed;
      EXPECT_TRUE(vehicle.stands_free(10.5, s, 1.57)) << "seed " << seed;
      EXPECT_TRUE(vehicle.stands_free(s, 10.5, 3.14)) << "seed " << seed;
      EXPECT_TRUE(vehicle.stands_free(2.5, s, -1.57)) << "seed " << seed;
    }
  }
}

TEST(Room, HasWallsAllAround) {
  const auto room = make_world("room", 1);
  ASSERT_TRUE(room);
  for (double s = 0.0; s <= 13.0; s += 0.05) {
    EXPECT_GT(room->surface.height_m(s, -0.1), 2.4);
    EXPECT_GT(room->surface.height_m(13.1, s), 2.4);
  }
}

TEST(Ramp, CanBeDrivenUpToAPlatformOfOneMetreThatEndsSheer) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto world = make_world("ramp", seed);
    ASSERT_TRUE(world);
    Vehicle vehicle({}, world->surface, world->start);
    const auto drive_until_x = [&](double x_m) {
      for (int tick = 0; tick < 6000 && vehicle.pose().x_m < x_m; ++tick) {
        const double off = 9.5 - vehicle.pose().y_m;
        vehicle.step({0.6, std::clamp(off, -0.5, 0.5) - 2.0 * vehicle.pose().yaw_rad}, 0.01);
      }
    };
    drive_until_x(24.0);
    EXPECT_NEAR(vehicle.pose().z_m, 1.0, 0.03) << "seed " << seed;
    EXPECT_EQ(vehicle.collisions(), 0) << "seed " << seed;
    drive_until_x(27.0);
    EXPECT_EQ(vehicle.collisions(), 1) << "seed " << seed;
    EXPECT_LT(vehicle.pose().x_m, 26.5) << "seed " << seed;
  }
}

TEST(Block, HasKerbsTooHighToClimbExceptAtCrossings) {
  const auto world = make_world("block", 1);
  ASSERT_TRUE(world);
  const auto rise = [&](double y) {
    return world->surface.height_m(18.4, y) - world->surface.height_m(18.58, y);
  };
  EXPECT_GT(rise(0.0), 0.1);
  EXPECT_LT(rise(-14.0), 0.09);
}

TEST(Hill, SlopesLessThanFifteenDegreesInMostPlaces) {
  const auto world = make_world("hill", 1);
  ASSERT_TRUE(world);
  int gentle = 0;
  int all = 0;
  for (double x = -48; x < 48; x += 1.0) {
    for (double y = -48; y < 48; y += 1.0) {
      const Vehicle vehicle({}, world->surface, {.x_m = x, .y_m = y});
      const Pose& pose = vehicle.pose();
      gentle += std::hypot(pose.roll_rad, pose.pitch_rad) < 0.26 ? 1 : 0;
      ++all;
    }
  }
  EXPECT_GT(gentle, 0.85 * all);
  EXPECT_LT(gentle, all);
}

TEST(World, TellsWhichNamesItKnows) {
  const auto world = make_world("moon", 1);
  ASSERT_FALSE(world);
  EXPECT_EQ(world.error().code, ErrorCode::not_found);
  EXPECT_NE(world.error().message.find("room, ramp, block, hill, dem:FILE"), std::string::npos)
      << world.error().message;
}

TEST(HeightRaster, IsBilinearInsideAndAWallOutside) {
  HeightRaster raster(2.0, 2, 2, 10.0, 20.0);
  raster.at(1, 0) = 1.0F;
  raster.at(1, 1) = 3.0F;
  EXPECT_DOUBLE_EQ(raster.height_m(11.0, 21.0), 1.0);
  EXPECT_DOUBLE_EQ(raster.height_m(12.0, 22.0), 3.0);
  EXPECT_EQ(raster.height_m(12.01, 21.0), HeightRaster::kOutside);
  EXPECT_EQ(raster.height_m(std::nan(""), 21.0), HeightRaster::kOutside);
}

}  // namespace
}  // namespace cairn::agent
