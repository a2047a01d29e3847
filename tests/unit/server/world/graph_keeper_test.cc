#include "server/world/graph_keeper.h"

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <random>

#include "server/world/placing.h"
#include "tests/unit/core/graph/synthetic_laps.h"
#include "tests/unit/core/localization/test_ground.h"

namespace cairn::server {
namespace {

/// A lap and a quarter around a square of varied ground, as a robot with a poor odometer merges it.
class GraphKeeperTest : public ::testing::Test {
 protected:
  boost::asio::io_context context;
  std::vector<LevelPose> truth = test::square_laps(2, 5);
  std::vector<MergedSubmap> merged;
  std::vector<GraphFindings> told;
  Status answer;

  GraphKeeperTest() {
    truth.resize(26);
    std::mt19937_64 random(5);
    LevelPose believed = truth.front();
    for (std::size_t i = 0; i < truth.size(); ++i) {
      MergedSubmap submap;
      submap.id = {7, static_cast<std::uint32_t>(i + 1)};
      if (i > 0) {
        const LevelPose drift{0.03, -0.02, 0.01, 0.015};
        const LevelPose T = test::disturbed(between(truth[i - 1], truth[i]), drift);
        believed = believed * T;
        submap.link = SubmapLink{to_submap_pose(T), 60, 30, 200};
      }
      submap.T_site_submap = to_submap_pose(believed);
      submap.surface = std::make_shared<HeightMap>(test::sampled_map(
          test::RichGround{}, upright(truth[i]),
          {.half_cells = 36, .hits_per_cell = 6, .noise_m = 0.02, .known_share = 0.8},
          test::kCellMm, random));
      merged.push_back(std::move(submap));
    }
  }
  std::shared_ptr<GraphKeeper> keeper() {
    return std::make_shared<GraphKeeper>(
        context.get_executor(), [this](GraphFindings findings, const GraphKeeper::Told& reply) {
          told.push_back(std::move(findings));
          reply(answer);
        });
  }
  /// Runs until the keeper has nothing to do but to wait.
  void settle() {
    while (context.run_one_for(std::chrono::milliseconds(500)) > 0) {
    }
    context.restart();
  }
  /// [m] The worst place, with the told moves carried out.
  [[nodiscard]] double worst_m() const {
    std::map<SubmapId, SubmapPose> places;
    for (const MergedSubmap& submap : merged) places[submap.id] = submap.T_site_submap;
    for (const GraphFindings& findings : told) {
      for (const auto& [id, pose] : findings.moves) places[id] = pose;
    }
    double worst = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const Eigen::Vector4d off = difference(to_level(places.at(merged[i].id)), truth[i]);
      worst = std::max(worst, off.head<3>().norm());
    }
    return worst;
  }
};

TEST_F(GraphKeeperTest, TellsWhereSubmapsLieOnceALoopIsFound) {
  const double before_m = worst_m();
  ASSERT_GT(before_m, 0.8);
  const auto keeps = keeper();
  keeps->take(merged);
  keeps->resume({});
  settle();
  ASSERT_FALSE(told.empty());
  EXPECT_LT(worst_m(), 0.25 * before_m);
  EXPECT_FALSE(told.front().loops.empty());
}

TEST_F(GraphKeeperTest, LooksForNothingAgainThatItHadFoundBeforeARestart) {
  const auto keeps = keeper();
  keeps->take(merged);
  keeps->resume({});
  settle();
  ASSERT_FALSE(told.empty());
  GraphFindings found = told.back();
  for (const auto& [id, pose] : found.moves) merged.at(id.sequence - 1).T_site_submap = pose;
  found.moves.clear();
  for (const MergedSubmap& submap : merged)
    found.moves.emplace_back(submap.id, submap.T_site_submap);
  told.clear();
  const auto after = keeper();
  after->take(merged);
  after->resume(found);
  settle();
  EXPECT_TRUE(told.empty());
}

TEST_F(GraphKeeperTest, MovesAreToldAgainWhenTheyCouldNotBeCarriedOut) {
  answer = Error{ErrorCode::io, "the disk is full"};
  const auto keeps = keeper();
  keeps->take(std::vector<MergedSubmap>(merged.begin(), merged.end() - 1));
  keeps->resume({});
  settle();
  ASSERT_FALSE(told.empty());
  const std::size_t moves = told.back().moves.size();
  ASSERT_GT(moves, 0U);
  answer = {};
  keeps->take({merged.back()});
  context.run_for(GraphKeeper::kMovePeriod + std::chrono::seconds(1));
  EXPECT_GE(told.back().moves.size(), moves);
}

}  // namespace
}  // namespace cairn::server
