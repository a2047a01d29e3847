#include "core/graph/submap_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/unit/core/graph/synthetic_laps.h"
#include "tests/unit/core/localization/test_ground.h"

namespace cairn {
namespace {

using test::Spread;
using testing::HasSubstr;

template <class Ground>
std::shared_ptr<const HeightMap> seen_from(const Ground& ground, const LevelPose& T_site_submap,
                                           std::mt19937_64& random) {
  return std::make_shared<HeightMap>(
      test::sampled_map(ground, upright(T_site_submap),
                        {.half_cells = 36, .hits_per_cell = 6, .noise_m = 0.02, .known_share = 0.8},
                        test::kCellMm, random));
}

/// A drive and what its odometer believes.
struct Drive {
  std::vector<LevelPose> truth;
  std::vector<SubmapNode> nodes;
};

template <class Ground>
Drive drive(const Ground& ground, const std::vector<LevelPose>& truth, const Spread& odometer,
            unsigned seed) {
  std::mt19937_64 random(seed);
  Drive drive{truth, {}};
  LevelPose believed = truth.front();
  for (std::size_t i = 0; i < truth.size(); ++i) {
    SubmapNode node;
    node.id = {7, static_cast<std::uint32_t>(i)};
    if (i > 0) {
      const LevelPose T = test::disturbed(between(truth[i - 1], truth[i]), odometer.drawn(random));
      node.link = ChainLink{drive.nodes.back().id, T, odometer.information().inverse()};
      believed = believed * T;
    }
    node.T_site_submap = believed;
    node.surface = seen_from(ground, truth[i], random);
    drive.nodes.push_back(node);
  }
  return drive;
}

void settle(SubmapGraph& graph) {
  for (bool done = false; !done;) {
    const LoopSearch search = graph.find_loops(10);
    done = search.done;
    if (search.accepted == 0) continue;
    const auto moved = graph.optimise();
    ASSERT_TRUE(moved.has_value()) << moved.error().message;
  }
}

SubmapGraph graph_of(const Drive& drive, const SubmapGraphConfig& config = {}) {
  SubmapGraph graph(config);
  for (const SubmapNode& node : drive.nodes) {
    const Status added = graph.add_submap(node);
    EXPECT_TRUE(added.has_value()) << (added ? "" : added.error().message);
    settle(graph);
  }
  return graph;
}

std::vector<LevelPose> places(const SubmapGraph& graph, const Drive& drive) {
  std::vector<LevelPose> places;
  for (const SubmapNode& node : drive.nodes) places.push_back(*graph.place(node.id));
  return places;
}

constexpr Spread kOdometer{.x_m = 0.06, .y_m = 0.06, .z_m = 0.03, .yaw_rad = 0.02};

/// One lap of 20 submaps around a square and a quarter of the next.
std::vector<LevelPose> lap_and_a_quarter() {
  std::vector<LevelPose> truth = test::square_laps(2, 5);
  truth.resize(26);
  return truth;
}

class SubmapGraphLap : public testing::Test {
 protected:
  static const Drive& lap() {
    static const Drive drive_once = drive(test::RichGround{}, lap_and_a_quarter(), kOdometer, 5);
    return drive_once;
  }
};

TEST_F(SubmapGraphLap, ComesBackToWhereItBegan) {
  std::vector<LevelPose> believed;
  for (const SubmapNode& node : lap().nodes) believed.push_back(node.T_site_submap);
  const SubmapGraph graph = graph_of(lap());
  const std::vector<LevelPose> found = places(graph, lap());
  EXPECT_GT(test::rms_m(believed, lap().truth), 0.4);
  EXPECT_LT(test::rms_m(found, lap().truth), 0.15);
  for (std::size_t i = 0; i < 6; ++i) {  // The second time round.
    const auto off =
        difference(between(found[i], found[i + 20]), between(lap().truth[i], lap().truth[i + 20]));
    EXPECT_LT(off.head<3>().norm(), 0.08) << i;
    EXPECT_LT(std::abs(off[3]), 0.01) << i;
  }
  EXPECT_EQ(found.front(), lap().truth.front());
}

TEST_F(SubmapGraphLap, GivesTheSameAnswerToTheSameCalls) {
  EXPECT_EQ(places(graph_of(lap()), lap()), places(graph_of(lap()), lap()));
}

TEST_F(SubmapGraphLap, IsThereAgainAfterARestartWithoutSearching) {
  SubmapGraph before = graph_of(lap());
  ASSERT_TRUE(before.optimise().has_value());
  SubmapGraph after;
  for (const SubmapNode& node : lap().nodes) ASSERT_TRUE(after.add_submap(node));
  ASSERT_TRUE(after.restore(before.found()));
  EXPECT_EQ(after.edges().size(), before.edges().size());
  EXPECT_EQ(after.found().tried, before.found().tried);
  EXPECT_EQ(places(after, lap()), places(before, lap()));
  EXPECT_EQ(after.find_loops(1000).registrations, 0);
  ASSERT_TRUE(before.optimise().has_value());
  ASSERT_TRUE(after.optimise().has_value());
  EXPECT_EQ(places(after, lap()), places(before, lap()));
}

TEST_F(SubmapGraphLap, ReportsOnlyWhatMoved) {
  SubmapGraph graph;
  for (const SubmapNode& node : lap().nodes) ASSERT_TRUE(graph.add_submap(node));
  EXPECT_THAT(*graph.optimise(), testing::IsEmpty());
  while (graph.find_loops(20).accepted == 0) {
  }
  const auto moved = graph.optimise();
  ASSERT_TRUE(moved.has_value());
  EXPECT_FALSE(moved->empty());
  for (const SubmapPlace& place : *moved) EXPECT_EQ(graph.place(place.id), place.T_site_submap);
  EXPECT_THAT(*graph.optimise(), testing::IsEmpty());
}

TEST_F(SubmapGraphLap, HoldsABoldLoopBackUntilAnotherOneAgrees) {
  SubmapGraphConfig config;
  config.self_evident_m = 0.0;
  SubmapGraph graph(config);
  ASSERT_TRUE(graph.add_submap(lap().nodes[0]));
  ASSERT_TRUE(graph.add_submap(lap().nodes[1]));
  settle(graph);
  ASSERT_EQ(graph.edges().size(), 2U);
  EXPECT_EQ(graph.edges()[1].status, EdgeStatus::held_back);
}

TEST(SubmapGraph, TiesAnotherRobotByWhatBothSaw) {
  std::mt19937_64 random(2);
  const LevelPose first{0.0, 0.0, 0.0, 0.3};
  const LevelPose second{1.5, -1.0, 0.1, 1.0};
  SubmapGraph graph;
  ASSERT_TRUE(graph.add_submap({.id = {1, 0},
                                .T_site_submap = first,
                                .surface = seen_from(test::RichGround{}, first, random),
                                .link = std::nullopt}));
  SubmapNode other{.id = {2, 0},
                   .T_site_submap = test::disturbed(second, {0.4, -0.3, 0.1, 0.08}),
                   .surface = seen_from(test::RichGround{}, second, random),
                   .link = std::nullopt};
  other.prior_covariance = Spread{0.4, 0.4, 0.2, 0.08}.information().inverse();
  ASSERT_TRUE(graph.add_submap(other));
  settle(graph);
  EXPECT_LT(difference(*graph.place({2, 0}), second).head<3>().norm(), 0.04);
}

TEST(SubmapGraph, TiesNothingAlongACorridor) {
  const std::vector<LevelPose> truth{{0.0, 0.0, 0.0, 0.0}, {3.0, 0.0, 0.0, 0.0}};
  Drive straight = drive(test::Corridor{}, truth, {0.001, 0.001, 0.001, 0.001}, 1);
  SubmapNode& node = straight.nodes[1];
  node.link->T_previous_submap = {3.3, 0.2, 0.0, 0.03};
  node.link->covariance = Spread{0.3, 0.2, 0.1, 0.05}.information().inverse();
  SubmapGraph graph = graph_of(straight);
  const LevelPose place = *graph.place(node.id);
  EXPECT_NEAR(place.y_m, 0.0, 0.05);
  EXPECT_NEAR(place.x_m, 3.3, 0.1);
  EXPECT_NEAR(place.yaw_rad, 0.0, 0.05);  // What the rival takes away may cost the heading.
}

TEST(SubmapGraph, RefusesWhatItCannotUse) {
  std::mt19937_64 random(1);
  SubmapNode node{.id = {1, 0},
                  .T_site_submap = {},
                  .surface = seen_from(test::FlatGround{}, {}, random),
                  .link = std::nullopt};
  SubmapGraph graph;
  ASSERT_TRUE(graph.add_submap(node));
  const auto message = [&](const SubmapNode& bad) {
    const Status added = graph.add_submap(bad);
    return added ? std::string("accepted") : added.error().message;
  };
  EXPECT_THAT(message(node), HasSubstr("known already"));
  node.id.sequence = 1;
  SubmapNode bad = node;
  bad.T_site_submap.y_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(message(bad), HasSubstr("not finite"));
  bad = node;
  bad.link = ChainLink{{9, 9}, {}};
  EXPECT_THAT(message(bad), HasSubstr("unknown submap"));
  bad.link = ChainLink{{1, 0}, {}, -Eigen::Matrix4d::Identity()};
  EXPECT_THAT(message(bad), HasSubstr("positive definite"));
  bad = node;
  bad.surface = nullptr;
  EXPECT_THAT(message(bad), HasSubstr("no surface"));
  bad.surface = std::make_shared<HeightMap>(250);
  EXPECT_THAT(message(bad), HasSubstr("cell size"));
  EXPECT_EQ(graph.size(), 1U);
  SubmapPlace lost{{1, 0}, {0.0, 0.0, std::numeric_limits<double>::infinity(), 0.0}};
  EXPECT_FALSE(graph.restore({.loops = {}, .tried = {}, .places = {lost}}).has_value());
}

TEST(SubmapGraph, OfOneSubmapAndOfNoneHasNothingToDo) {
  SubmapGraph graph;
  EXPECT_TRUE(graph.optimise()->empty());
  EXPECT_TRUE(graph.find_loops(10).done);
  ASSERT_TRUE(graph.add_submap({.id = {1, 0},
                                .T_site_submap = {3.0, 2.0, 1.0, 0.5},
                                .surface = std::make_shared<HeightMap>(test::kCellMm),
                                .link = std::nullopt}));
  EXPECT_TRUE(graph.find_loops(10).done);
  EXPECT_TRUE(graph.optimise()->empty());
}

}  // namespace
}  // namespace cairn
