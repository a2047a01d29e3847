// How fast a short-term map is tried at every place of the window, against OpenCV's template
// matching of the same maps, and the wide search by branch and bound against trying everything.

#include "core/localization/registration.h"

#include <iostream>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "core/common/angle.h"
#include "core/localization/problem.h"
#include "core/localization/wide_search.h"
#include "robot_agent/input/world.h"
#include "tests/bench/cpu_time.h"
#include "tests/bench/report.h"
#include "tests/bench/timing.h"
#include "tests/bench/world_height.h"
#include "tests/support/sampled_ground.h"

namespace cairn::bench {
namespace {

constexpr int kCellMm = 125;
constexpr int kRuns = 7;

struct Maps {
  HeightMap long_term;
  HeightMap short_term;
  RegistrationPrior prior;
};

/// The robot stands at the world's start, but believes to be somewhere near.
Maps maps_of(const agent::World& world) {
  std::mt19937_64 random(5);
  const WorldHeight height(world.surface);
  const Pose origin;
  const Pose robot{world.start.x_m, world.start.y_m, 0.02, 0.0, 0.0, radians(3.2)};
  Maps maps{
      test::sampled_map(height, origin, {.half_cells = 240, .noise_m = 0.02}, kCellMm, random),
      test::sampled_map(height, robot,
                        {.hits_per_cell = 3, .noise_m = 0.03, .known_share = 0.7, .fan = true},
                        kCellMm, random),
      {}};
  maps.prior.T_site_submap = {robot.x_m - 0.31, robot.y_m + 0.22, 0.0, 0.0, 0.0, 0.0};
  return maps;
}

/// A turned map and the part of the long-term map under all its shifts, as images.
struct Images {
  cv::Mat picture, mask, ground;
};

Images images_of(const MatchProblem& problem, int yaw) {
  const TurnedMap turned = turn(problem.short_term, problem.turning, problem.yaw_rad(yaw));
  const int width = problem.long_term.width;
  const int height = problem.long_term.height;
  cv::Mat picture = cv::Mat::zeros(height, width, CV_32F);
  cv::Mat mask = cv::Mat::zeros(height, width, CV_32F);
  std::vector<cv::Point> known;
  for (std::size_t i = 0; i < turned.height_mm.size(); ++i) {
    if (turned.height_mm[i] == kUnknownInShort) continue;
    const auto at = static_cast<int>(turned.at[i / TurnedMap::kBlock] + i % TurnedMap::kBlock);
    known.emplace_back(at % width, at / width);
    picture.at<float>(known.back()) = static_cast<float>(turned.height_mm[i]);
    mask.at<float>(known.back()) = 1.0F;
  }
  const cv::Rect box = cv::boundingRect(known);
  cv::Mat ground(box.height + 2 * problem.reach, box.width + 2 * problem.reach, CV_32F);
  for (int y = 0; y < ground.rows; ++y) {
    for (int x = 0; x < ground.cols; ++x) {
      const bool is_known = problem.long_term.known(box.x + x, box.y + y);
      ground.at<float>(y, x) =
          is_known ? static_cast<float>(problem.long_term.at(box.x + x, box.y + y)) : 0.0F;
    }
  }
  return {picture(box).clone(), mask(box).clone(), ground};
}

double opencv_s(const MatchProblem& problem) {
  cv::setNumThreads(1);
  std::vector<Images> images;
  for (int yaw = 0; yaw < problem.yaws(); ++yaw) images.push_back(images_of(problem, yaw));
  return least_cpu_s(3, [&] {
    for (const Images& i : images) {
      cv::Mat scores;
      cv::matchTemplate(i.ground, i.picture, scores, cv::TM_SQDIFF, i.mask);
      keep(scores);
    }
  });
}

double search_s(const MatchProblem& problem, const MatchKernels& kernels, int runs = kRuns) {
  return least_cpu_s(runs, [&] { keep(search_all(problem, kernels)); });
}

bool same_winner(const MatchProblem& problem, const MatchKernels& kernels) {
  const MatchVolume reference = search_all(problem, portable_kernels());
  return search_all(problem, kernels).sums == reference.sums;
}

void add_narrow(const Maps& maps, Report& report) {
  const SearchWindow window{.reach_m = 1.0, .yaw_rad = radians(10.0), .yaw_step_rad = radians(0.5)};
  const MatchProblem problem =
      make_problem(maps.short_term, maps.prior, maps.long_term, window, RegistrationConfig{});
  const double opencv = opencv_s(problem);
  Figure time{"every place, ±1 m, ±10°, " + std::string(fastest_kernels().name),
              search_s(problem, fastest_kernels()) * 1e3, "ms"};
  time.peers["OpenCV matchTemplate, masked"] = opencv * 1e3;
  bool same = true;
  for (const MatchKernels* kernels : usable_kernels()) {
    time.peers[kernels->name] = search_s(problem, *kernels, 3) * 1e3;
    same = same && same_winner(problem, *kernels);
  }
  report.add({"times faster than OpenCV", opencv * 1e3 / time.value, "x", Better::higher, 10.0});
  report.add(time);
  report.add({"same sums as the portable search", same ? 1.0 : 0.0, "", Better::higher, 1.0});
  report.add(
      {"whole registration",
       1e3 *
           least_cpu_s(
               kRuns, [&] { keep(register_map(maps.short_term, maps.prior, maps.long_term, {})); }),
       "ms"});
}

void add_wide(const Maps& maps, const std::string& where, std::optional<double> goal,
              Report& report) {
  const RegistrationConfig config;
  const SearchWindow narrow{.reach_m = 1.0, .yaw_rad = radians(10.0), .yaw_step_rad = radians(0.5)};
  const SearchWindow wide{.reach_m = 4.0, .yaw_rad = radians(30.0), .yaw_step_rad = radians(0.5)};
  const MatchProblem small =
      make_problem(maps.short_term, maps.prior, maps.long_term, narrow, config);
  const MatchProblem large =
      make_problem(maps.short_term, maps.prior, maps.long_term, wide, config);
  WideMatch match;
  const double wide_s = least_cpu_s(3, [&] {
    match = search_wide(large, fastest_kernels(), std::numeric_limits<double>::infinity(), {});
  });
  const MatchVolume volume = search_all(large, fastest_kernels());
  const std::vector<Candidate> best = basins(volume, 1);
  const bool exact = match.best && !best.empty() && match.best->sum == best.front().sum;
  report.add({"±4 m, ±30° over the narrow search, " + where,
              wide_s / search_s(small, fastest_kernels()),
              "x",
              Better::lower,
              goal,
              {{"trying every place",
                search_s(large, fastest_kernels(), 1) / search_s(small, fastest_kernels())}}});
  report.add({"exact, " + where, exact ? 1.0 : 0.0, "", Better::higher, 1.0});
}

int run() {
  Report report("registration");
  const auto room = agent::make_world("room", 7);
  const auto hill = agent::make_world("hill", 7);
  if (!room || !hill) return 1;
  const Maps indoors = maps_of(*room);
  const Maps outdoors = maps_of(*hill);
  add_narrow(outdoors, report);
  add_wide(outdoors, "outdoors", 8.0, report);
  add_wide(indoors, "in a room", std::nullopt, report);
  report.print(std::cout);
  return 0;
}

}  // namespace
}  // namespace cairn::bench

int main() { return cairn::bench::run(); }
