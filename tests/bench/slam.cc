// A recorded log through the robot's map maker and the pose graph over its submaps, measured by the
// Freiburg benchmark's relations.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/localization/match_raster.h"
#include "robot_agent/input/carmen_line.h"
#include "robot_agent/input/carmen_log.h"
#include "robot_agent/input/log_lines.h"
#include "robot_agent/pipeline/mapper.h"
#include "robot_agent/pipeline/submap_frame.h"
#include "tests/bench/closure.h"
#include "tests/bench/relations.h"
#include "tests/bench/report.h"
#include "tests/support/data_folder.h"

namespace cairn::bench {
namespace {

struct Options {
  std::string log;
  std::string relations;
  int cell_mm = 50;
  double until_s = 1e9;  ///< [s] Of the log.
};

/// Where the robot was by one submap.
struct Place {
  MonotonicTime stamp{};
  std::uint32_t sequence = 0;
  Pose T_submap_robot;
  Pose T_dead_reckoning;
};

struct Run {
  std::vector<Place> places;
  std::map<std::uint32_t, Submap> submaps;
  double cpu_s = 0.0;
  double graph_cpu_s = 0.0;
  double log_s = 0.0;
};

/// The logger's clock at the log's first reading.
Result<double> first_stamp_s(const std::string& path) {
  auto lines = agent::LogLines::open(path);
  if (!lines) return lines.error();
  while (true) {
    auto line = lines->next();
    if (!line) return line.error();
    if (!line->has_value()) return Error{ErrorCode::corrupt, path + ": no reading"};
    const auto message = agent::parse_carmen_line(**line);
    if (message && message->has_value()) return (**message).stamp_s;
  }
}

/// The agent's mapping without its link.
class Replay {
 public:
  Replay(const agent::Input& input, const agent::MapperConfig& config)
      : mapper_(config, input.lasers(), input.start(), 1, evidence_),
        alone_(config.dead_reckoning, input.start()) {}

  void take(const agent::Reading& reading) {
    const std::clock_t start = std::clock();
    const auto* motion = std::get_if<MotionReading>(&reading);
    if (motion != nullptr) mapper_.take_motion(*motion);
    if (const auto* scan = std::get_if<Scan>(&reading)) mapper_.take_scan(*scan);
    cpu_ += std::clock() - start;
    if (motion != nullptr) alone_.update(*motion);
    note(std::visit([](const auto& each) { return each.stamp; }, reading));
  }

  Run finish() {
    const std::clock_t start = std::clock();
    mapper_.finish();
    cpu_ += std::clock() - start;
    const std::uint32_t last = run_.places.empty() ? 0 : run_.places.back().sequence;
    for (std::uint32_t sequence = 1; sequence <= last; ++sequence) {
      const Submap* submap = mapper_.replica().find(sequence);
      if (submap != nullptr) run_.submaps.emplace(sequence, *submap);
    }
    run_.cpu_s = static_cast<double>(cpu_) / CLOCKS_PER_SEC;
    if (!run_.places.empty()) run_.log_s = to_seconds(run_.places.back().stamp);
    std::cout << "corrections " << mapper_.corrections_accepted() << ", refused "
              << mapper_.corrections_refused() << ", submaps " << run_.submaps.size() << ", "
              << mapper_.distance_m() << " m, lost readings " << lost_ << std::endl;
    return std::move(run_);
  }

 private:
  void note(MonotonicTime stamp) {
    const Submap* open = mapper_.open_submap();
    if (open == nullptr) {
      ++lost_;
      return;
    }
    // Of readings with one stamp the last one knows best.
    if (!run_.places.empty() && run_.places.back().stamp == stamp) run_.places.pop_back();
    run_.places.push_back({stamp, open->id.sequence,
                           agent::from_to(agent::pose_of(open->T_site_submap), mapper_.pose()),
                           alone_.pose()});
  }

  proto::EvidenceSender evidence_;
  agent::Mapper mapper_;
  DeadReckoning alone_;
  Run run_;
  std::clock_t cpu_ = 0;
  int lost_ = 0;
};

Result<Run> replay(const Options& options) {
  auto input = agent::open_carmen_log(options.log, {});
  if (!input) return input.error();
  agent::MapperConfig config;
  config.cell_size_mm = options.cell_mm;
  config.kept_bytes = std::size_t{8} << 30;
  Replay replay(**input, config);
  while (!(*input)->finished()) {
    const auto next = (*input)->next_stamp();
    if (!next || to_seconds(*next) > options.until_s) break;
    auto readings = (*input)->advance(*next);
    if (!readings) return readings.error();
    for (const agent::Reading& reading : *readings) replay.take(reading);
  }
  return replay.finish();
}

std::vector<Stamped> track(const Run& run, double first_s) {
  std::vector<Stamped> poses;
  for (const Place& place : run.places) {
    const auto submap = run.submaps.find(place.sequence);
    if (submap == run.submaps.end()) continue;
    poses.push_back(
        {first_s + to_seconds(place.stamp),
         agent::compose(agent::pose_of(submap->second.T_site_submap), place.T_submap_robot)});
  }
  return poses;
}

std::vector<Stamped> raw_track(const Run& run, double first_s) {
  std::vector<Stamped> poses;
  for (const Place& place : run.places) {
    poses.push_back({first_s + to_seconds(place.stamp), place.T_dead_reckoning});
  }
  return poses;
}

Status close_loops(Run& run) {
  const std::clock_t start = std::clock();
  Closure closure;
  for (const auto& [sequence, submap] : run.submaps) {
    if (Status added = closure.add(submap); !added) return added;
  }
  for (auto& [sequence, submap] : run.submaps) submap.T_site_submap = closure.place(submap.id);
  run.graph_cpu_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  std::cout << "pose graph: " << closure.compared() << " pairs compared, " << closure.loops()
            << " loops\n";
  return {};
}

/// Free ground light, obstacles black, the robot's way blue.
Status draw(const Run& run, const std::vector<Stamped>& poses, int cell_mm,
            const std::string& file) {
  HeightMap site(cell_mm);
  for (const auto& [sequence, submap] : run.submaps) (void)fold(site, submap, SensorModel{});
  const auto box = known_box(site);
  if (!box) return Error{ErrorCode::invalid_argument, "an empty map cannot be drawn"};
  const int width = box->highest.x - box->lowest.x + 1;
  const int height = box->highest.y - box->lowest.y + 1;
  if (std::max(width, height) > 16'384) return Error{ErrorCode::exhausted, "too large to draw"};
  cv::Mat picture(height, width, CV_8UC3, cv::Scalar(190, 180, 170));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Cell cell = site.cell({box->lowest.x + x, box->lowest.y + y});
      if (!cell.known()) continue;
      const std::uint8_t grey = cell.height_mm > 150 ? 0 : 250;
      picture.at<cv::Vec3b>(height - 1 - y, x) = {grey, grey, grey};
    }
  }
  const auto pixel = [&](const Pose& pose) {
    const CellIndex at = site.cell_at(pose.x_m, pose.y_m);
    return cv::Point(at.x - box->lowest.x, height - 1 - (at.y - box->lowest.y));
  };
  for (std::size_t i = 1; i < poses.size(); ++i) {
    cv::line(picture, pixel(poses[i - 1].T_site_robot), pixel(poses[i].T_site_robot),
             {220, 100, 30}, 1, cv::LINE_AA);
  }
  std::filesystem::create_directories(std::filesystem::path(file).parent_path());
  if (!cv::imwrite(file, picture)) return Error{ErrorCode::io, "cannot write " + file};
  std::cout << "drawn in " << file << '\n';
  return {};
}

void print(const char* what, const RelationErrors& errors) {
  std::cout << what << ": translation " << errors.translation_m.mean << " ± "
            << errors.translation_m.sigma << " m, squared " << errors.translation_m2.mean << " ± "
            << errors.translation_m2.sigma << " m²; rotation " << errors.rotation_deg.mean << " ± "
            << errors.rotation_deg.sigma << "°, squared " << errors.rotation_deg2.mean << " ± "
            << errors.rotation_deg2.sigma << "°² (" << errors.relations << " relations, "
            << errors.missing << " missing)\n";
}

int run(const Options& options) {
  const auto relations = read_relations(options.relations);
  const auto first_s = first_stamp_s(options.log);
  auto run = replay(options);
  for (const Error* error : {relations ? nullptr : &relations.error(),
                             first_s ? nullptr : &first_s.error(), run ? nullptr : &run.error()}) {
    if (error == nullptr) continue;
    std::cerr << error->message << '\n';
    return 1;
  }
  const RelationErrors raw = relation_errors(*relations, raw_track(*run, *first_s));
  const RelationErrors robot = relation_errors(*relations, track(*run, *first_s));
  print("odometry", raw);
  print("robot   ", robot);
  std::cout << std::flush;
  if (const Status closed = close_loops(*run); !closed) {
    std::cerr << closed.error().message << '\n';
    return 1;
  }
  const auto poses = track(*run, *first_s);
  const RelationErrors errors = relation_errors(*relations, poses);
  print("graph   ", errors);
  const Status drawn = draw(*run, poses, options.cell_mm, "out/slam.png");
  if (!drawn) std::cerr << drawn.error().message << '\n';

  Report report("slam");
  report.add(
      {.name = "translation of a relation, mean",
       .value = errors.translation_m.mean,
       .unit = "m",
       .goal = 0.05,
       .peers = {{"odometry", raw.translation_m.mean}, {"robot alone", robot.translation_m.mean}}});
  report.add(
      {.name = "rotation of a relation, mean",
       .value = errors.rotation_deg.mean,
       .unit = "°",
       .peers = {{"odometry", raw.rotation_deg.mean}, {"robot alone", robot.rotation_deg.mean}}});
  report.add({.name = "relations without a pose",
              .value = static_cast<double>(errors.missing),
              .goal = 0.0});
  report.add({.name = "cell", .value = static_cast<double>(options.cell_mm), .unit = "mm"});
  report.add(
      {.name = "processor time per log time", .value = run->cpu_s / run->log_s, .unit = "s/s"});
  report.add({.name = "the same of the pose graph",
              .value = run->graph_cpu_s / run->log_s,
              .unit = "s/s"});
  report.print(std::cout);
  return 0;
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) {
  cairn::bench::Options options;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--cell") == 0 && i + 1 < argc) {
      options.cell_mm = std::atoi(argv[++i]);
    } else if (std::strcmp(argv[i], "--until") == 0 && i + 1 < argc) {
      options.until_s = std::atof(argv[++i]);
    } else {
      files.emplace_back(argv[i]);
    }
  }
  if ((files.size() != 0 && files.size() != 2) || options.cell_mm < 10 || options.cell_mm > 1000) {
    std::cerr << "usage: " << argv[0] << " [LOG RELATIONS] [--cell MM] [--until SECONDS]\n";
    return 2;
  }
  const auto logs = cairn::test::data_folder() / "logs";
  options.log = files.empty() ? (logs / "intel.clf.bz2").string() : files[0];
  options.relations = files.empty() ? (logs / "intel.relations").string() : files[1];
  if (files.empty() && !std::filesystem::exists(options.log)) {
    std::cout << "skipped: no log; give LOG and RELATIONS as arguments, or the folder that holds "
                 "logs/intel.clf.bz2 in CAIRN_DATA\n";
    return 0;
  }
  return cairn::bench::run(options);
}
