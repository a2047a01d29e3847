#include "core/graph/pose_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <random>

#include "core/graph/normal_equations.h"
#include "tests/unit/core/graph/synthetic_laps.h"

namespace cairn {
namespace {

using test::Spread;
using testing::HasSubstr;

constexpr Spread kOdometer{.x_m = 0.05, .y_m = 0.05, .z_m = 0.03, .yaw_rad = 0.02};
constexpr Spread kLoop{.x_m = 0.02, .y_m = 0.02, .z_m = 0.02, .yaw_rad = 0.004};

OptimisedGraph optimised(const PoseGraph& graph) {
  Result<OptimisedGraph> answer = optimise(graph, {});
  EXPECT_TRUE(answer.has_value()) << (answer ? "" : answer.error().message);
  return answer ? *answer : OptimisedGraph{};
}

TEST(LevelPose, InverseAndProductAreThoseOfRigidMotions) {
  const LevelPose a{1.0, -2.0, 0.5, 2.0};
  const LevelPose b{-3.0, 0.7, 0.1, -2.9};
  EXPECT_LT(difference(a * inverse(a), {}).norm(), 1e-12);
  EXPECT_LT(difference(a * between(a, b), b).norm(), 1e-12);
}

TEST(LevelPose, CovarianceFollowsTheDerivatives) {
  const LevelPose a{1.0, -2.0, 0.5, 2.0};
  const LevelPose b{-3.0, 0.7, 0.1, -2.9};
  constexpr double kStep = 1e-6;
  Eigen::Matrix4d by_a;
  Eigen::Matrix4d by_b;
  Eigen::Matrix4d of_inverse;
  for (int i = 0; i < 4; ++i) {
    Eigen::Vector4d d = Eigen::Vector4d::Zero();
    d[i] = kStep;
    const LevelPose off{d[0], d[1], d[2], d[3]};
    by_a.col(i) = difference(test::disturbed(a, off) * b, a * b) / kStep;
    by_b.col(i) = difference(a * test::disturbed(b, off), a * b) / kStep;
    of_inverse.col(i) = difference(inverse(test::disturbed(a, off)), inverse(a)) / kStep;
  }
  const Eigen::Matrix4d cov_a = Eigen::Vector4d(1.0, 2.0, 3.0, 0.5).asDiagonal();
  const Eigen::Matrix4d cov_b = Eigen::Vector4d(0.3, 0.1, 0.7, 0.2).asDiagonal();
  const Eigen::Matrix4d both = by_a * cov_a * by_a.transpose() + by_b * cov_b * by_b.transpose();
  EXPECT_LT((compounded(a, cov_a, b, cov_b) - both).norm(), 1e-4);
  EXPECT_LT((inverted(a, cov_a) - of_inverse * cov_a * of_inverse.transpose()).norm(), 1e-4);
}

TEST(PoseGraph, ItsDerivativesAreThoseOfTheResidual) {
  const GraphConstraint c{0, 1, {0.5, 0.2, -0.1, 1.0}};
  const LevelPose from{1.0, 2.0, 3.0, 0.7};
  const LevelPose to{-2.0, 2.5, 1.0, -1.9};
  const LinearConstraint linear = linearised(c, from, to);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 4; ++i) {
    Eigen::Vector4d d = Eigen::Vector4d::Zero();
    d[i] = kStep;
    const LevelPose off{d[0], d[1], d[2], d[3]};
    const auto slope = [&](const LevelPose& a, const LevelPose& b) {
      return Eigen::Vector4d((linearised(c, a, b).residual - linear.residual) / kStep);
    };
    EXPECT_LT((slope(test::disturbed(from, off), to) - linear.by_from.col(i)).norm(), 1e-5);
    EXPECT_LT((slope(from, test::disturbed(to, off)) - linear.by_to.col(i)).norm(), 1e-5);
  }
}

TEST(PoseGraph, ALapThatDriftedClosesToTheNoiseOfItsLoops) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::mt19937_64 random(seed);
    const auto truth = test::square_laps(2, 10);
    PoseGraph graph = test::drifting_chain(truth, kOdometer, random);
    for (std::size_t i = 0; i < 40; i += 2) {
      test::add_loop(graph, truth, i, i + 40, kLoop, random);
    }
    const double before = test::rms_m(graph.nodes, truth);
    const OptimisedGraph answer = optimised(graph);
    EXPECT_TRUE(answer.converged);
    EXPECT_THAT(answer.switched_off, testing::Each(false)) << "seed " << seed;
    EXPECT_LT(test::rms_m(answer.nodes, truth), 0.6 * before) << "seed " << seed;
    for (std::size_t i = 0; i < 40; i += 2) {
      const Eigen::Vector4d off = difference(between(answer.nodes[i], answer.nodes[i + 40]),
                                             between(truth[i], truth[i + 40]));
      EXPECT_LT(off.head<3>().norm(), 0.08) << "seed " << seed;
    }
    // 79 + 20 constraints of 4 numbers tell 79 nodes: χ² is about 80.
    EXPECT_LT(answer.chi2, 150.0) << "seed " << seed;
  }
}

TEST(PoseGraph, ExactMeasurementsGiveTheExactPoses) {
  std::mt19937_64 random(1);
  const auto truth = test::square_laps(1, 8);
  PoseGraph graph = test::drifting_chain(truth, kOdometer, random);
  for (std::size_t i = 1; i < truth.size(); ++i) {
    graph.constraints[i - 1].T_from_to = between(truth[i - 1], truth[i]);
  }
  graph.constraints.push_back({31, 0, between(truth[31], truth[0]), kLoop.information(), true});
  EXPECT_LT(test::rms_m(optimised(graph).nodes, truth), 1e-6);
}

/// An eight: two squares that meet in one corner, driven twice.
std::vector<LevelPose> eights() {
  std::vector<LevelPose> truth{{}};
  for (int i = 1; i < 128; ++i) {
    const bool left = (i - 1) / 32 % 2 == 0;
    const double turn = (i % 8 == 0 && i % 32 != 0) ? std::numbers::pi / 2 : 0.0;
    truth.push_back(truth.back() * LevelPose{4.0, 0.0, 0.0, left ? turn : -turn});
    if (i % 32 == 0) truth.back().yaw_rad = 0.0;
  }
  return truth;
}

TEST(PoseGraph, AnEightIsTiedTogetherWhereItCrosses) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::mt19937_64 random(seed);
    const auto truth = eights();
    PoseGraph graph = test::drifting_chain(truth, kOdometer, random);
    for (const std::size_t to : {32U, 64U, 96U}) {
      test::add_loop(graph, truth, 0, to, kLoop, random);
    }
    for (std::size_t i = 4; i < 64; i += 6) {
      test::add_loop(graph, truth, i, i + 64, kLoop, random);
    }
    const double before = test::rms_m(graph.nodes, truth);
    const OptimisedGraph answer = optimised(graph);
    EXPECT_THAT(answer.switched_off, testing::Each(false)) << "seed " << seed;
    EXPECT_LT(test::rms_m(answer.nodes, truth), 0.5 * before) << "seed " << seed;
    for (const std::size_t i : {32U, 64U, 96U}) {
      EXPECT_LT(difference(answer.nodes[i], truth[i]).head<3>().norm(), 0.08) << "seed " << seed;
    }
  }
}

TEST(PoseGraph, WrongLoopsAreSwitchedOffAndBendNothing) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::mt19937_64 random(seed);
    const auto truth = test::square_laps(3, 10);
    PoseGraph right = test::drifting_chain(truth, kOdometer, random);
    for (std::size_t i = 0; i < 80; i += 2) {
      test::add_loop(right, truth, i, i + 40, kLoop, random);
    }
    PoseGraph mixed = right;
    std::uniform_int_distribution<std::size_t> node(0, truth.size() - 1);
    std::uniform_real_distribution<double> way(-8.0, 8.0);
    for (int i = 0; i < 10; ++i) {  // 20 % of 50.
      const std::size_t from = node(random);
      const std::size_t to = (from + 7 + node(random) % 100) % truth.size();
      const double x = way(random);
      const double y = way(random);
      mixed.constraints.push_back(
          {from, to, {x, y, 0.0, way(random) / 4.0}, kLoop.information(), true});
    }
    const OptimisedGraph clean = optimised(right);
    const OptimisedGraph robust = optimised(mixed);
    for (std::size_t k = 0; k < mixed.constraints.size(); ++k) {
      const bool wrong = k >= right.constraints.size();
      EXPECT_EQ(robust.switched_off[k], wrong) << "constraint " << k << ", seed " << seed;
    }
    EXPECT_LT(test::rms_m(robust.nodes, clean.nodes), 1e-3) << "seed " << seed;
  }
}

TEST(PoseGraph, ALoopInACorridorPullsAcrossAndNotAlong) {
  PoseGraph graph;
  for (int i = 0; i < 20; ++i) graph.nodes.push_back({1.0 * i, 0.0, 0.0, 0.0});
  graph.fixed.assign(20, false);
  graph.fixed[0] = true;
  for (std::size_t i = 1; i < 20; ++i) {
    graph.constraints.push_back({i - 1, i, {1.0, 0.0, 0.0, 0.0}, kOdometer.information()});
  }
  Eigen::Matrix4d across = kLoop.information();
  across.row(0).setZero();
  across.col(0).setZero();
  graph.constraints.push_back({0, 19, {22.0, 0.3, 0.0, 0.0}, across, true});
  const OptimisedGraph answer = optimised(graph);
  EXPECT_NEAR(answer.nodes[19].y_m, 0.3, 0.02);
  EXPECT_NEAR(answer.nodes[19].x_m, 19.0, 0.05);
}

TEST(PoseGraph, HeightThatDriftedOnARampLapComesBack) {
  std::mt19937_64 random(3);
  const auto truth = test::square_laps(2, 10, 0.4);
  PoseGraph graph = test::drifting_chain(truth, {0.02, 0.02, 0.1, 0.002}, random);
  for (std::size_t i = 0; i < 40; i += 4) {
    test::add_loop(graph, truth, i, i + 40, kLoop, random);
  }
  const OptimisedGraph answer = optimised(graph);
  double worst_m = 0.0;
  for (std::size_t i = 0; i < 40; i += 4) {
    const double z_m = answer.nodes[i + 40].z_m - answer.nodes[i].z_m;
    worst_m = std::max(worst_m, std::abs(z_m - (truth[i + 40].z_m - truth[i].z_m)));
  }
  EXPECT_LT(worst_m, 0.05);
}

TEST(PoseGraph, WhatNothingMeasuredDoesNotMove) {
  PoseGraph graph;
  graph.nodes = {{}, {5.0, 1.0, 0.0, 0.0}};
  graph.fixed = {true, false};
  Eigen::Matrix4d only_y = Eigen::Matrix4d::Zero();
  only_y(1, 1) = 100.0;
  graph.constraints.push_back({0, 1, {9.0, 0.0, 3.0, 1.0}, only_y});
  const OptimisedGraph answer = optimised(graph);
  EXPECT_LT(difference(answer.nodes[1], {5.0, 0.0, 0.0, 0.0}).norm(), 1e-4);
}

TEST(PoseGraph, OfFixedNodesAloneStaysAsItIs) {
  PoseGraph graph;
  graph.nodes = {{}, {5.0, 1.0, 0.0, 0.0}};
  graph.fixed = {true, true};
  graph.constraints.push_back({0, 1, {4.0, 0.0, 0.0, 0.0}});
  EXPECT_EQ(optimised(graph).nodes, graph.nodes);
}

TEST(PoseGraph, RefusesWhatItCannotUse) {
  std::mt19937_64 random(1);
  const auto truth = test::square_laps(1, 4);
  const PoseGraph sound = test::drifting_chain(truth, kOdometer, random);
  const auto message = [](const PoseGraph& graph) {
    const auto answer = optimise(graph, {});
    return answer ? "accepted" : answer.error().message;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  PoseGraph graph = sound;
  graph.nodes[3].z_m = nan;
  EXPECT_THAT(message(graph), HasSubstr("node 3 is not finite"));
  graph = sound;
  graph.constraints[5].T_from_to.yaw_rad = nan;
  EXPECT_THAT(message(graph), HasSubstr("constraint 5 is not finite"));
  graph = sound;
  graph.constraints[2].information(1, 1) = -4.0;
  EXPECT_THAT(message(graph), HasSubstr("positive semidefinite"));
  graph = sound;
  graph.constraints[2].information(1, 2) = 4.0;
  EXPECT_THAT(message(graph), HasSubstr("symmetric"));
  graph = sound;
  graph.constraints[2].to = 99;
  EXPECT_THAT(message(graph), HasSubstr("does not tie two nodes"));
  graph = sound;
  graph.constraints[7].robust = true;  // A loop alone may be switched off.
  EXPECT_THAT(message(graph), HasSubstr("node 8 is not tied"));
  graph = sound;
  graph.fixed[0] = false;
  EXPECT_THAT(message(graph), HasSubstr("node 0 is not tied"));
}

/// A random walk over a city of streets, with loops where it comes back.
PoseGraph city(std::mt19937_64& random, std::vector<LevelPose>& truth) {
  truth = test::square_laps(25, 50);
  PoseGraph graph = test::drifting_chain(truth, {0.02, 0.02, 0.01, 0.002}, random);
  std::uniform_int_distribution<std::size_t> node(0, truth.size() - 1);
  std::uniform_int_distribution<std::size_t> lap(1, 24);
  while (graph.constraints.size() < 10'000) {
    const std::size_t from = node(random);
    const std::size_t to = from + 200 * lap(random);
    if (to < truth.size()) test::add_loop(graph, truth, from, to, kLoop, random);
  }
  return graph;
}

TEST(PoseGraph, FiveThousandNodesAreOptimisedTwiceTheSame) {
  std::mt19937_64 random(1);
  std::vector<LevelPose> truth;
  const PoseGraph graph = city(random, truth);
  const auto begin = std::chrono::steady_clock::now();
  const OptimisedGraph answer = optimised(graph);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  std::cout << truth.size() << " nodes, " << graph.constraints.size()
            << " constraints: " << took.count() << " s, " << answer.iterations << " iterations\n";
  EXPECT_TRUE(answer.converged);
  EXPECT_LT(test::rms_m(answer.nodes, truth), 0.5);
  EXPECT_EQ(optimised(graph).nodes, answer.nodes);
}

}  // namespace
}  // namespace cairn
