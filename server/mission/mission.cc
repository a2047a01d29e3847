#include "server/mission/mission.h"

#include <spdlog/spdlog.h>

#include <boost/asio/post.hpp>
#include <cmath>
#include <utility>

#include "server/mission/corridors.h"
#include "server/mission/planning.h"

namespace cairn::server {

namespace asio = boost::asio;

namespace {

const char* name_of(proto::CommandState state) {
  switch (state) {
    case proto::CommandState::accepted:
      return "accepted";
    case proto::CommandState::refused:
      return "refused";
    case proto::CommandState::superseded:
      return "superseded";
    case proto::CommandState::arrived:
      return "arrived";
    case proto::CommandState::stopped:
      return "stopped";
    case proto::CommandState::expired:
      return "expired";
    case proto::CommandState::blocked:
      return "blocked";
  }
  return "accepted";
}

const char* name_of(PathStatus status) {
  switch (status) {
    case PathStatus::complete:
      return "complete";
    case PathStatus::partial:
      return "partial";
    case PathStatus::none:
      return "none";
  }
  return "none";
}

std::vector<api::PointJson> to_json_points(const std::vector<Eigen::Vector2d>& points_m) {
  std::vector<api::PointJson> points;
  points.reserve(points_m.size());
  for (const Eigen::Vector2d& p : points_m) points.push_back({p.x(), p.y()});
  return points;
}

/// How a goal's end looks to its task.
std::optional<LegEnd> leg_end(const std::string& state, const std::string& why) {
  if (state == "arrived") return LegEnd::reached;
  if (state == "expired") return LegEnd::out_of_time;
  if (state == "refused" || state == "superseded") return LegEnd::out_of_hand;
  if (state == "stopped")
    return why.starts_with("lost") ? LegEnd::out_of_hand : LegEnd::not_reached;
  return {};
}

}  // namespace

Mission::Mission(Hub::Strand strand, asio::any_io_executor executor, std::shared_ptr<Hub> hub,
                 MissionConfig config)
    : strand_(std::move(strand)),
      executor_(std::move(executor)),
      hub_(std::move(hub)),
      config_(config),
      fields_(config.min_probability),
      timer_(strand_) {}

void Mission::start() {
  running_ = true;
  tick();
}

void Mission::halt() {
  running_ = false;
  timer_.cancel();
}

Result<Robot*> Mission::robot_for(const std::optional<std::string>& name) {
  auto& robots = hub_->robots();
  if (name) {
    Robot* robot = hub_->find(*name);
    if (robot == nullptr || !robot->link) {
      return Error{ErrorCode::not_found,
                   fmt::format("no robot '{}' has connected: see `cairn status`", *name)};
    }
    return robot;
  }
  if (robots.empty()) {
    return Error{ErrorCode::unavailable,
                 "no robot has connected yet: start cairn-agent and look at `cairn status`"};
  }
  if (robots.size() > 1) {
    return Error{ErrorCode::invalid_argument,
                 "several robots are known: say which with --robot (see `cairn status`)"};
  }
  return &robots.begin()->second;
}

Result<Robot*> Mission::placed_robot_for(const std::optional<std::string>& name) {
  Result<Robot*> found = robot_for(name);
  if (found && !(*found)->pose) {
    return Error{
        ErrorCode::unavailable,
        fmt::format("robot '{}' has not told its pose yet: try again in a moment", (*found)->id)};
  }
  return found;
}

void Mission::stop(const api::StopRequest& request, const Reply& reply) {
  Result<Robot*> found = robot_for(request.robot);
  if (!found) return reply(found.error());
  duties_[(*found)->id].tasks.cancel("stopped by the operator");
  Goal goal;
  goal.command.kind = proto::CommandKind::stop;
  goal.command.issuer = "operator";
  goal.expires = Hub::now() + std::chrono::hours(1);
  Planned planned;
  planned.path.status = PathStatus::complete;
  // The robot stops at once; the operator is told when no restart can bring the task back.
  issue((*found)->id, std::move(goal), planned,
        [self = shared_from_this(), id = (*found)->id, reply](Result<api::CommandReply> sent) {
          Duty& duty = self->duties_[id];
          if (!sent || duty.tasks.newest() == nullptr) return reply(std::move(sent));
          self->keep(self->hub_->robots().at(id), duty, [reply, sent](const Status& written) {
            if (!written) return reply(written.error());
            reply(sent);
          });
        });
}

PlanTarget Mission::target_of(const Robot& robot, const Goal& goal) {
  PlanTarget target{robot.site->info().name, robot.site->snapshot(), {}, goal.planner};
  target.request.start_m = {robot.x_m(), robot.y_m()};
  target.request.goal_m = {goal.command.goal_x_mm / 1000.0, goal.command.goal_y_mm / 1000.0};
  target.request.allow_partial = goal.allow_partial;
  return target;
}

void Mission::plan(const Robot& robot, const Goal& goal, std::vector<Eigen::Vector2d> keep_m,
                   OnPlanned done) {
  PlanTarget target = target_of(robot, goal);
  std::optional<ExploreWish> exploring;
  if (const auto duty = duties_.find(robot.id); goal.of_task && duty != duties_.end()) {
    Task* task = duty->second.tasks.current();
    if (task != nullptr && task->kind == TaskKind::explore) exploring = wish_of(robot, *task);
  }
  asio::post(executor_, [self = shared_from_this(), target = std::move(target),
                         keep_m = std::move(keep_m), done = std::move(done),
                         exploring = std::move(exploring)] {
    const MonotonicTime began = Hub::now();
    Planned planned;
    planned.map_version = target.map->version;
    const Status followed = self->fields_.with(target, [&](const KeptField& field) {
      const PlanRequest& request = target.request;
      if (exploring && !still_a_frontier(field.grid(), *exploring, request.goal_m)) {
        planned.seen = true;
      } else if (!keep_m.empty() && path_is_open(field.grid(), rest_of(keep_m, request.start_m))) {
        planned.kept = true;
      } else {
        planned.path = field.plan(target);
      }
    });
    if (!followed) planned.path.why = followed.error().message;
    planned.took = Hub::now() - began;
    asio::post(self->strand_, [done, planned = std::move(planned)] { done(planned); });
  });
}

void Mission::issue(const std::string& id, Goal goal, const Planned& planned, const Reply& reply) {
  if (planned.path.status == PathStatus::none) {
    return reply(Error{ErrorCode::invalid_argument, "no path: " + planned.path.why});
  }
  goal.path_m = planned.path.points_m;
  goal.why = planned.path.why;
  goal.command.map_version = planned.map_version;
  goal.checked_map = planned.map_version;
  std::shared_ptr<Site> site = hub_->robots().at(id).site;
  site->next_command_id([self = shared_from_this(), id, goal = std::move(goal), path = planned.path,
                         reply](Result<std::uint64_t> number) mutable {
    asio::post(self->strand_, [self, id, goal = std::move(goal), path = std::move(path), reply,
                               number = std::move(number)]() mutable {
      if (!number) return reply(number.error());
      Robot* robot = self->hub_->find(id);
      if (robot == nullptr) return;
      goal.command.id = *number;
      Goal& current = self->goals_[id] = std::move(goal);
      self->send(*robot, current);
      api::CommandReply answer;
      answer.command = *number;
      answer.robot = id;
      answer.status = name_of(path.status);
      answer.why = path.why;
      answer.length_m = path.length_m;
      answer.cost_m = path.cost_m;
      answer.path = to_json_points(path.points_m);
      reply(answer);
    });
  });
}

void Mission::send(Robot& robot, Goal& goal) {
  ++goal.command.revision;
  const WirePath wire = to_wire(goal.path_m, robot.site->info().cell_size_mm);
  goal.command.path_cut = wire.cut;
  goal.command.link_timeout_ms = static_cast<std::uint32_t>(
      std::chrono::duration_cast<std::chrono::milliseconds>(config_.link_timeout).count());
  hub_->command(robot, goal.command, wire.bytes, goal.expires - Hub::now());
  offer_corridor(robot, goal, {});
}

void Mission::connected(Robot& robot) {
  const auto found = goals_.find(robot.id);
  if (found == goals_.end()) return;
  if (found->second.active()) send(robot, found->second);
  if (found->second.cancelling) cancel(robot, found->second);
}

void Mission::reported(Robot& robot, const proto::CommandReport& report) {
  const auto found = goals_.find(robot.id);
  if (found == goals_.end() || found->second.command.id != report.command) return;
  Goal& goal = found->second;
  if (report.revision >= goal.command.revision) goal.cancelling = false;
  if (!goal.active() || report.revision < goal.command.revision) return;  // Of an older path.
  goal.state = name_of(report.state);
  goal.why = report.why;
  spdlog::info("robot {}: command {} {}{}{}", robot.id, report.command, goal.state,
               report.why.empty() ? "" : ": ", report.why);
  goal.wants_plan = report.state == proto::CommandState::blocked;
  if (goal.wants_plan) return count_blockade(robot, goal);
  if (const auto how = leg_end(goal.state, goal.why)) leg_ended(robot, goal, *how);
}

void Mission::count_blockade(Robot& robot, Goal& goal) {
  const Eigen::Vector2d place_m(robot.x_m(), robot.y_m());
  const bool same_place = (place_m - goal.blocked_at_m).norm() <= kBlockadeM;
  goal.times_blocked_here = same_place ? goal.times_blocked_here + 1 : 1;
  if (!same_place) goal.blocked_at_m = place_m;
  if (goal.times_blocked_here >= kMaxBlockades) give_up(robot, goal, goal.why);
}

void Mission::check(Robot& robot, Goal& goal) {
  const MonotonicTime now = Hub::now();
  if (now >= goal.expires) {  // The robot's own clock says so too; it may be out of reach.
    goal.state = "expired";
    return leg_ended(robot, goal, LegEnd::out_of_time);
  }
  if (goal.planning || goal.command.kind != proto::CommandKind::go_to || now < goal.next_check) {
    return;
  }
  if (!goal.wants_plan && robot.site->snapshot()->version == goal.checked_map) return;
  goal.planning = true;
  std::vector<Eigen::Vector2d> keep = goal.path_m;
  if (goal.wants_plan) keep.clear();
  plan(robot, goal, std::move(keep),
       [self = shared_from_this(), id = robot.id, command = goal.command.id](const Planned& p) {
         self->replanned(id, command, p);
       });
}

void Mission::replanned(const std::string& id, std::uint64_t command, const Planned& planned) {
  const auto found = goals_.find(id);
  if (found == goals_.end() || found->second.command.id != command) return;
  Goal& goal = found->second;
  goal.planning = false;
  goal.checked_map = planned.map_version;
  const Duration pause = goal.wants_plan ? kLookPeriod : Duration(300'000);
  goal.next_check =
      Hub::now() + std::max(from_seconds(to_seconds(planned.took) / kCheckShare), pause);
  if (!goal.active() || planned.kept) return;
  Robot& robot = hub_->robots().at(id);
  if (planned.seen) return leg_ended(robot, goal, LegEnd::seen);
  if (planned.path.status == PathStatus::none) {
    return give_up(robot, goal, planned.path.why, LegEnd::no_way);
  }
  if (goal.command.revision >= kMaxRevisions) {
    return give_up(robot, goal, fmt::format("{} paths were tried", kMaxRevisions));
  }
  goal.path_m = planned.path.points_m;
  goal.command.map_version = planned.map_version;
  goal.wants_plan = false;
  send(robot, goal);
}

void Mission::cancel(Robot& robot, Goal& goal) {
  proto::Command cancel = goal.command;  // The same command, so that nothing supersedes its story.
  cancel.kind = proto::CommandKind::stop;
  cancel.revision = ++goal.command.revision;
  cancel.path_cut = false;
  goal.cancelling = true;
  hub_->command(robot, cancel, {}, std::chrono::minutes(10));
}

void Mission::give_up(Robot& robot, Goal& goal, const std::string& why, LegEnd how) {
  cancel(robot, goal);
  goal.state = "stopped";
  goal.why = "no way any more: " + why;
  spdlog::info("robot {}: command {} given up: {}", robot.id, goal.command.id, why);
  leg_ended(robot, goal, how);
}

void Mission::tick() {
  if (!running_) return;
  for (auto& [id, goal] : goals_) {
    if (Robot* robot = hub_->find(id); robot != nullptr && goal.active()) check(*robot, goal);
  }
  for (auto& [id, robot] : hub_->robots()) {
    Duty& duty = duties_[id];
    mind(robot, duty);
    keep_what_changed(robot, duty);
  }
  timer_.expires_after(kTick);
  timer_.async_wait([self = shared_from_this()](const boost::system::error_code& error) {
    if (!error) self->tick();
  });
}

std::optional<api::CommandJson> Mission::describe(const std::string& robot) const {
  const auto found = goals_.find(robot);
  if (found == goals_.end()) return std::nullopt;
  const Goal& goal = found->second;
  api::CommandJson json;
  json.id = goal.command.id;
  json.kind = goal.command.kind == proto::CommandKind::go_to ? "goto" : "stop";
  json.state = goal.state;
  json.why = goal.why;
  json.goal = {goal.command.goal_x_mm / 1000.0, goal.command.goal_y_mm / 1000.0};
  if (goal.command.goal_yaw_1e4rad) json.heading_rad = *goal.command.goal_yaw_1e4rad * 1e-4;
  json.revision = goal.command.revision;
  json.path = to_json_points(goal.path_m);
  const Robot* known = hub_->find(robot);
  if (known != nullptr && known->pose && known->pose->command == json.id) {
    json.to_go_m = known->pose->to_go_mm / 1000.0;
  }
  if (goal.active()) json.eta_s = seconds_to_go(robot, nullptr);
  return json;
}

}  // namespace cairn::server
