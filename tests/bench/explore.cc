// A robot explores room, ramp and block (or --world NAME) from nothing: the agent's map making and
// driving in the simulator's time, frontiers and tasks as the server's mission has them. The share
// mapped of what can be reached, contacts, and the way against that of a greedy robot that knows
// the world. Reachable is, on the true ground, where a vehicle gets to that needs 0.2 m more room
// around it than ours: cells that the grid or a reading's noise might close are nobody's fault.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "robot_agent/input/simulator.h"
#include "server/mission/exploring.h"
#include "server/mission/task.h"
#include "tests/bench/explore_oracle.h"
#include "tests/bench/report.h"
#include "tests/bench/solo_robot.h"

namespace cairn::bench {
namespace {

constexpr int kCellMm = 125;
constexpr double kRoomM = 0.7;
constexpr double kShare = 0.99;
constexpr Duration kLegLimit = std::chrono::minutes(6);
constexpr Duration kLimit = std::chrono::hours(2);
constexpr Duration kLookPause = std::chrono::milliseconds(1500);

struct Exploration {
  std::string end;  ///< Of the task.
  int legs = 0;
  double seconds = 0.0;
  double driven_m = 0.0;
  double share = 0.0;
  int collisions = 0;
  std::vector<Eigen::Vector2d> places_m;
};

/// What a mission does for a task of this kind, with the robot beside it.
class Explorer {
 public:
  explicit Explorer(SoloRobot& robot) : robot_(robot) { task_.kind = server::TaskKind::explore; }

  Exploration run() {
    const MonotonicTime begun = robot_.now();
    bool waited = false;
    while (task_.state == server::TaskState::active && robot_.now() - begun < kLimit) {
      const auto choice = server::choose_frontier(robot_.ground(), wish(), SoloRobot::planner());
      for (const Eigen::Vector2d& place_m : choice.unreachable_m) task_.avoid(place_m);
      if (choice.frontier) {
        waited = false;
        drive_to(choice.frontier->place_m);
      } else if (std::exchange(waited, true)) {
        server::end_exploring(task_, choice);
      } else {
        robot_.wait(kLookPause);
      }
    }
    done_.end = task_.state == server::TaskState::done     ? "done"
                : task_.state == server::TaskState::active ? "out of time"
                                                           : "failed: " + task_.why;
    done_.seconds = to_seconds(robot_.now() - begun);
    return done_;
  }

 private:
  [[nodiscard]] server::ExploreWish wish() const {
    const Pose& pose = robot_.mapper().pose();
    return {{pose.x_m, pose.y_m}, {}, {task_.avoided_m.begin(), task_.avoided_m.end()}, {}};
  }

  void drive_to(const Eigen::Vector2d& place_m) {
    const SoloRobot::Trip trip = robot_.go_to(place_m, kLegLimit, [&](const DrivableGrid& known) {
      const Pose& truth = robot_.truth().T_site_robot;
      done_.places_m.emplace_back(truth.x_m, truth.y_m);
      return !server::still_a_frontier(known, wish(), place_m);
    });
    using server::LegEnd;
    const LegEnd how = trip.enough    ? LegEnd::seen
                       : trip.arrived ? LegEnd::reached
                       : trip.no_way  ? LegEnd::no_way
                                      : LegEnd::not_reached;
    server::end_leg(task_, how, trip.why, place_m);
    done_.driven_m += trip.driven_m;
    ++done_.legs;
    if (!trip.enough) robot_.wait(kLookPause);
  }

  SoloRobot& robot_;
  server::Task task_;
  Exploration done_;
};

/// The robot's map, what of the reachable it does not know, its way and the oracle's.
void draw(const SoloRobot& robot, const DrivableGrid& ground,
          const std::vector<std::uint8_t>& reachable, const Exploration& done,
          const OracleDrive& oracle, const std::string& file) {
  constexpr int kPixels = 4;
  const HeightGrid& heights = ground.heights;
  cv::Mat picture(heights.height, heights.width, CV_8UC3, cv::Scalar(60, 40, 40));
  for (int y = 0; y < heights.height; ++y) {
    for (int x = 0; x < heights.width; ++x) {
      const CellIndex index{heights.origin.x + x, heights.origin.y + y};
      const Cell cell = robot.mapper().cell(index);
      auto& pixel = picture.at<cv::Vec3b>(heights.height - 1 - y, x);
      if (cell.probability >= robot.mapper().sensor_model().min_probability) {
        const auto grey = static_cast<std::uint8_t>(std::clamp(90 + cell.height_mm / 10, 0, 255));
        pixel = {grey, grey, grey};
      } else if (reachable[heights.at(index)] != 0) {
        pixel = {40, 40, 255};
      }
    }
  }
  cv::resize(picture, picture, {}, kPixels, kPixels, cv::INTER_NEAREST);
  const auto line = [&](const std::vector<Eigen::Vector2d>& places_m, const cv::Scalar& colour) {
    std::vector<cv::Point> points;
    for (const Eigen::Vector2d& place_m : places_m) {
      const Eigen::Vector2d cells = place_m * (1000.0 / kCellMm);
      points.emplace_back(
          static_cast<int>((cells.x() - heights.origin.x) * kPixels),
          static_cast<int>((heights.height - (cells.y() - heights.origin.y)) * kPixels));
    }
    cv::polylines(picture, points, false, colour, 1, cv::LINE_AA);
  };
  line(oracle.places_m, {60, 220, 60});
  line(done.places_m, {255, 160, 40});
  if (!cv::imwrite(file, picture)) std::cerr << "cannot write " << file << '\n';
}

struct Totals {
  int runs = 0;
  int done = 0;
  int collisions = 0;
  int unmapped = 0;  ///< Runs that mapped less than kShare.
  double least_share = 1.0;
  double shares = 0.0;
  double driven_m = 0.0;
  double oracle_m = 0.0;
  double worst_ratio = 0.0;
};

void explore(const std::string& name, std::uint64_t seed, const std::string& png, Totals& totals) {
  const agent::World world = agent::make_world(name, seed).value();
  const DrivableGrid ground = true_ground(world, kCellMm, kRoomM);
  const auto reachable = reachable_cells(ground, {world.start.x_m, world.start.y_m});
  const OracleDrive oracle = drive_greedily(world, ground, kShare);
  agent::SimulatorConfig config;
  config.world = name;
  config.seed = seed;
  SoloRobot robot(agent::make_simulator(config, world).value(), nullptr);
  Exploration done = Explorer(robot).run();
  const auto known = [&](CellIndex cell) {
    return robot.mapper().cell(cell).probability >= robot.mapper().sensor_model().min_probability;
  };
  done.share = share_known(ground, reachable, known);
  done.collisions = robot.truth().collisions;
  const double ratio = done.driven_m / std::max(1.0, oracle.driven_m);
  std::cout << name << " seed " << seed << ": " << done.end << ", " << 100 * done.share
            << " % mapped, " << done.collisions << " collisions, " << done.driven_m << " m in "
            << done.seconds << " s and " << done.legs << " legs; the oracle " << oracle.driven_m
            << " m for " << 100 * oracle.share << " %: " << ratio << std::endl;
  ++totals.runs;
  totals.done += done.end == "done" ? 1 : 0;
  totals.collisions += done.collisions;
  totals.unmapped += done.share < kShare ? 1 : 0;
  totals.least_share = std::min(totals.least_share, done.share);
  totals.shares += done.share;
  totals.driven_m += done.driven_m;
  totals.oracle_m += oracle.driven_m;
  totals.worst_ratio = std::max(totals.worst_ratio, ratio);
  if (!png.empty()) draw(robot, ground, reachable, done, oracle, png);
}

void add(Report& report, const std::string& world, const Totals& totals) {
  const double runs = totals.runs;
  report.add({"mapped of what is reachable, " + world, 100 * totals.shares / runs, "%",
              Better::higher, 99.0});
  report.add({"the least of them, " + world, 100 * totals.least_share, "%", Better::higher, 99.0});
  report.add({"collisions, " + world, 1.0 * totals.collisions, "", Better::lower, 0.0});
  report.add({"way of a greedy oracle's, " + world,
              totals.driven_m / std::max(1.0, totals.oracle_m), "x", Better::lower, 1.5});
  report.add({"the farthest of them, " + world, totals.worst_ratio, "x"});
  report.add(
      {"ended by themselves, " + world, 100.0 * totals.done / runs, "%", Better::higher, 100.0});
}

struct Options {
  std::vector<std::string> worlds{"room", "ramp", "block"};
  std::uint64_t first = 1;
  int seeds = 20;
  std::string png = "explore.png";
};

int run(const Options& options) {
  Report report("explore");
  for (const std::string& world : options.worlds) {
    Totals totals;
    for (int i = 0; i < options.seeds; ++i) {
      const bool drawn = i == 0 && world == options.worlds.back();
      explore(world, options.first + static_cast<std::uint64_t>(i), drawn ? options.png : "",
              totals);
    }
    add(report, world, totals);
  }
  report.print(std::cout);
  return 0;
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) {
  cairn::bench::Options options;
  bool usable = argc % 2 == 1;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string option = argv[i];
    if (option == "--world") {
      options.worlds = {argv[i + 1]};
    } else if (option == "--seeds") {
      options.seeds = std::atoi(argv[i + 1]);
    } else if (option == "--seed") {
      options.first = std::strtoull(argv[i + 1], nullptr, 10);
    } else if (option == "--png") {
      options.png = argv[i + 1];
    } else {
      usable = false;
    }
  }
  if (!usable || options.seeds < 1 || options.seeds > 10'000) {
    std::cerr << "usage: " << argv[0]
              << " [--world NAME] [--seeds N] [--seed FIRST] [--png FILE], N from 1 to 10,000\n";
    return 2;
  }
  if (const auto made = cairn::agent::make_world(options.worlds.front(), 1); !made) {
    std::cerr << made.error().message << '\n';
    return 1;
  }
  return cairn::bench::run(options);
}
