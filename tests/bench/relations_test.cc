#include "tests/bench/relations.h"

#include <gtest/gtest.h>

#include "core/common/angle.h"

namespace cairn::bench {
namespace {

std::vector<Stamped> quarter_turn() {
  return {{10.0, {}}, {11.0, {.x_m = 2.0, .yaw_rad = radians(90.0)}}};
}

TEST(Relations, FindNothingWrongWithATrackThatFits) {
  const auto errors = relation_errors({{10.0, 11.0, {.x_m = 2.0, .yaw_rad = radians(90.0)}},
                                       {11.0, 10.0, {.y_m = 2.0, .yaw_rad = radians(-90.0)}}},
                                      quarter_turn());
  EXPECT_EQ(errors.relations, 2U);
  EXPECT_NEAR(errors.translation_m.mean, 0.0, 1e-9);
  EXPECT_NEAR(errors.rotation_deg.mean, 0.0, 1e-9);
}

TEST(Relations, MeasureMeanAndSpreadOfTheErrorAndItsSquare) {
  const auto errors =
      relation_errors({{10.0, 11.0, {.x_m = 2.0, .yaw_rad = radians(80.0)}},
                       {10.0, 11.0, {.x_m = 2.3, .y_m = 0.4, .yaw_rad = radians(90.0)}}},
                      quarter_turn());
  EXPECT_NEAR(errors.translation_m.mean, 0.25, 1e-9);
  EXPECT_NEAR(errors.translation_m.sigma, 0.25, 1e-9);
  EXPECT_NEAR(errors.translation_m2.mean, 0.125, 1e-9);
  EXPECT_NEAR(errors.rotation_deg.mean, 5.0, 1e-9);
  EXPECT_NEAR(errors.rotation_deg2.mean, 50.0, 1e-7);
}

TEST(Relations, CountWhatTheTrackDoesNotHold) {
  const auto errors = relation_errors({{10.0, 12.0, {}}}, quarter_turn());
  EXPECT_EQ(errors.missing, 1U);
  EXPECT_EQ(errors.relations, 0U);
}

TEST(Relations, AreNotReadFromAFileThatIsNotThere) {
  EXPECT_EQ(read_relations("/no/such/file").error().code, ErrorCode::not_found);
}

}  // namespace
}  // namespace cairn::bench
