#include "tests/bench/solo_robot.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>
#include <vector>

#include "core/planner/corridor.h"
#include "server/mission/planning.h"
#include "server/world/placing.h"

namespace cairn::bench {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(50);
constexpr Duration kLookPeriod = std::chrono::seconds(1);
constexpr int kMostPaths = 20;
constexpr std::uint8_t kHalfWidth = 12;  ///< [cells] Of the corridor around its paths.

std::int32_t to_mm(double m) { return static_cast<std::int32_t>(std::lround(m * 1000.0)); }

/// Where anything is known, and around the robot.
struct Extent {
  CellIndex lowest{std::numeric_limits<std::int32_t>::max(),
                   std::numeric_limits<std::int32_t>::max()};
  CellIndex highest{std::numeric_limits<std::int32_t>::min(),
                    std::numeric_limits<std::int32_t>::min()};

  void include(CellIndex cell) {
    lowest = {std::min(lowest.x, cell.x), std::min(lowest.y, cell.y)};
    highest = {std::max(highest.x, cell.x), std::max(highest.y, cell.y)};
  }
  void include(const HeightMap& map, CellIndex origin) {
    for (const auto& [key, tile] : map.tiles()) {
      const CellIndex corner{origin.x + key.tx * Tile::kSize, origin.y + key.ty * Tile::kSize};
      include(corner);
      include({corner.x + Tile::kSize - 1, corner.y + Tile::kSize - 1});
    }
  }
};

}  // namespace

SoloRobot::SoloRobot(std::unique_ptr<agent::Input> input, const HeightMap* given)
    : input_(std::move(input)),
      mapper_(agent::MapperConfig{}, input_->lasers(), input_->start(), 1, evidence_) {
  if (given == nullptr) {
    closure_ = std::make_unique<Closure>();
    return;
  }
  std::vector<agent::GivenTile> tiles;
  for (const auto& [key, tile] : given->tiles()) tiles.push_back({key, *tile, 0});
  mapper_.take_tiles(tiles);
}

DrivableGrid SoloRobot::ground() const {
  const HeightMap& replica = mapper_.replica().now();
  Extent extent;
  extent.include(replica.cell_at(mapper_.pose().x_m, mapper_.pose().y_m));
  extent.include(replica, {0, 0});
  if (const Submap* open = mapper_.open_submap()) {
    extent.include(open->surface, {open->T_site_submap.x_mm / mapper_.cell_size_mm(),
                                   open->T_site_submap.y_mm / mapper_.cell_size_mm()});
  }
  auto grid = empty_grid(extent.lowest, extent.highest, mapper_.cell_size_mm()).value();
  agent::copy_known([this](CellIndex cell) { return mapper_.cell(cell); },
                    mapper_.sensor_model().min_probability, grid);
  return make_drivable(std::move(grid), planner());
}

bool SoloRobot::send_path(const Eigen::Vector2d& goal_m, Trip& trip) {
  const Pose& pose = mapper_.pose();
  const DrivableGrid known = ground();
  const Path path = plan(known, {.start_m = {pose.x_m, pose.y_m}, .goal_m = goal_m}, planner());
  trip.why = path.why;
  if (path.status != PathStatus::complete) return false;
  path_m_ = path.points_m;
  if (trip.paths++ == 0) trip.planned_m = path.length_m;
  proto::RobotLink::Order order;
  order.command.id = command_;
  order.command.revision = static_cast<std::uint32_t>(trip.paths);
  order.command.kind = proto::CommandKind::go_to;
  order.command.issuer = "bench";
  order.command.expires_clock_ms = std::numeric_limits<std::uint64_t>::max();
  order.command.goal_x_mm = to_mm(goal_m.x());
  order.command.goal_y_mm = to_mm(goal_m.y());
  constexpr std::int32_t kMostLeg = 512;
  order.path =
      encode_path(subdivided(quantise(path.points_m, mapper_.cell_size_mm()).value(), kMostLeg));
  driver_.take(order, pose, now_);
  give_corridor(order, known, goal_m);
  return true;
}

void SoloRobot::give_corridor(const proto::RobotLink::Order& order, const DrivableGrid& known,
                              const Eigen::Vector2d& goal_m) {
  constexpr std::size_t kMostPoints = 12;
  const CodedPath path = decode_path(order.path).value();
  const CellIndex goal = quantise({goal_m}, mapper_.cell_size_mm())->points.front();
  const auto field = compute_field(known, {goal.x >> 2, goal.y >> 2});
  for (std::size_t first = 0; field && first + 1 < path.points.size();) {
    const std::size_t count = std::min(kMostPoints, path.points.size() - first);
    const auto begin = path.points.begin() + static_cast<std::ptrdiff_t>(first);
    auto corridor = Corridor::along(
        {path.cell_size_mm, {begin, begin + static_cast<std::ptrdiff_t>(count)}}, kHalfWidth);
    if (corridor) {
      corridor->fill(known, *field);
      proto::CorridorPart part;
      part.command = order.command.id;
      part.revision = order.command.revision;
      part.first = static_cast<std::uint16_t>(first);
      part.count = static_cast<std::uint16_t>(count);
      part.half_width = kHalfWidth;
      part.directions = corridor->encode();
      driver_.take(part, mapper_.cell_size_mm());
    }
    first += count - 1;
  }
}

void SoloRobot::step() {
  now_ += kStep;
  const auto readings = input_->advance(now_).value();
  for (const agent::Reading& reading : readings) {
    if (const auto* motion = std::get_if<MotionReading>(&reading)) mapper_.take_motion(*motion);
    if (const auto* scan = std::get_if<Scan>(&reading)) mapper_.take_scan(*scan);
  }
  if (closure_) straighten();
  driver_.set_localization(mapper_.localization(), mapper_.localization_why());
  input_->drive(driver_.step(
      mapper_.pose(), [this](CellIndex cell) { return mapper_.cell(cell); }, mapper_.cell_size_mm(),
      mapper_.sensor_model().min_probability, now_, Duration{}));
}

/// As a server's graph keeper does, at once.
void SoloRobot::straighten() {
  const Submap* const open = mapper_.open_submap();
  if (open == nullptr || open->id.sequence <= closed_ + 1) return;
  const std::uint32_t newest = open->id.sequence - 1;
  std::vector<std::pair<std::uint32_t, SubmapPose>> moves;
  bool worth_moving = false;
  while (closed_ < newest) {
    const Submap* const closed = mapper_.replica().find(++closed_);
    if (closed != nullptr) (void)closure_->add(*closed);
  }
  for (std::uint32_t sequence = 1; sequence <= newest; ++sequence) {
    const Submap* const closed = mapper_.replica().find(sequence);
    if (closed == nullptr || !closure_->holds(closed->id)) continue;
    const SubmapPose& lies = closed->T_site_submap;
    const SubmapPose place = closure_->place(closed->id);
    if (place != lies) moves.emplace_back(sequence, place);
    worth_moving = worth_moving || server::worth_moving(lies, place);
  }
  if (worth_moving) mapper_.move_submaps(moves);
}

void SoloRobot::follow_reports(const Eigen::Vector2d& goal_m, bool watched, Trip& trip) {
  for (const proto::CommandReport& report : driver_.take_reports()) {
    const bool of_this_trip = report.command == command_;
    if (!of_this_trip || report.state == proto::CommandState::accepted) continue;
    if (report.state == proto::CommandState::blocked) {
      if (trip.paths >= kMostPaths) {
        ended_ = true;
      } else if (!send_path(goal_m, trip) && watched) {
        trip.no_way = true;
        give_up(trip);
      }  // Without a way now there may be one later.
      trip.why = report.why + (trip.why.empty() ? "" : "; " + trip.why);
      continue;
    }
    ended_ = true;
    trip.arrived = report.state == proto::CommandState::arrived;
    trip.why = report.why;
  }
}

void SoloRobot::give_up(Trip& trip) {
  ended_ = true;
  proto::RobotLink::Order order;
  order.command.id = command_;
  order.command.revision = static_cast<std::uint32_t>(++trip.paths);
  order.command.kind = proto::CommandKind::stop;
  order.command.issuer = "bench";
  order.command.expires_clock_ms = std::numeric_limits<std::uint64_t>::max();
  driver_.take(order, mapper_.pose(), now_);
}

void SoloRobot::look(const Eigen::Vector2d& goal_m, const Enough& enough, Trip& trip) {
  const DrivableGrid known = ground();
  if (enough(known)) {
    trip.enough = ended_ = true;
    return;
  }
  const Eigen::Vector2d here_m(mapper_.pose().x_m, mapper_.pose().y_m);
  if (server::path_is_open(known, server::rest_of(path_m_, here_m))) return;
  if (trip.paths < kMostPaths && send_path(goal_m, trip)) return;
  trip.no_way = trip.paths < kMostPaths;
  give_up(trip);
}

void SoloRobot::wait(Duration time) {
  for (const MonotonicTime end = now_ + time; now_ < end;) step();
}

SoloRobot::Trip SoloRobot::go_to(const Eigen::Vector2d& goal_m, Duration limit,
                                 const Enough& enough) {
  Trip trip;
  ++command_;
  ended_ = !send_path(goal_m, trip);
  const MonotonicTime begun = now_;
  MonotonicTime next_look = now_ + kLookPeriod;
  Pose last = truth().T_site_robot;
  while (!ended_ && now_ - begun < limit) {
    step();
    follow_reports(goal_m, enough != nullptr, trip);
    if (enough && !ended_ && now_ >= next_look) {
      look(goal_m, enough, trip);
      next_look = now_ + kLookPeriod;
    }
    const Pose& here = truth().T_site_robot;
    trip.driven_m += std::hypot(here.x_m - last.x_m, here.y_m - last.y_m);
    last = here;
  }
  trip.seconds = to_seconds(now_ - begun);
  return trip;
}

}  // namespace cairn::bench
