#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <cmath>
#include <utility>

#include "core/common/angle.h"
#include "server/mission/mission.h"
#include "server/mission/planning.h"

/// The part of Mission that strings legs together: tasks and their queue.
namespace cairn::server {

namespace asio = boost::asio;

namespace {

const char* name_of(TaskKind kind) {
  switch (kind) {
    case TaskKind::go_to:
      return "goto";
    case TaskKind::explore:
      return "explore";
    case TaskKind::go_home:
      return "return";
  }
  return "goto";
}

const char* name_of(TaskState state) {
  switch (state) {
    case TaskState::active:
      return "active";
    case TaskState::done:
      return "done";
    case TaskState::failed:
      return "failed";
    case TaskState::cancelled:
      return "cancelled";
    case TaskState::expired:
      return "expired";
  }
  return "failed";
}

proto::OnLinkLoss on_link_loss_of(const std::string& text) {
  if (text == "continue") return proto::OnLinkLoss::proceed;
  return text == "return" ? proto::OnLinkLoss::retrace : proto::OnLinkLoss::stop;
}

UnknownGround unknown_of(const std::string& text) {
  return text == "blocked" ? UnknownGround::blocked : UnknownGround::allowed;
}

constexpr const char* kOthersFirst = "waits for other robots to see what is left";

std::int32_t to_mm(double m) { return static_cast<std::int32_t>(std::lround(m * 1000.0)); }

std::int32_t to_1e4rad(double rad) {
  return static_cast<std::int32_t>(std::lround(wrap_angle(rad) * 1e4));
}

Eigen::Vector2d place_of(const Robot& robot) { return {robot.x_m(), robot.y_m()}; }

double length_m(const std::vector<Eigen::Vector2d>& points_m) {
  double length = 0.0;
  for (std::size_t i = 1; i < points_m.size(); ++i)
    length += (points_m[i] - points_m[i - 1]).norm();
  return length;
}

/// [m] As the crow flies from place to place, after the one that is driven to.
double length_after_next_m(const Task& task) {
  double length = 0.0;
  for (std::size_t i = task.next + 1; i < task.waypoints.size(); ++i) {
    length += (task.waypoints[i].place_m - task.waypoints[i - 1].place_m).norm();
  }
  return length;
}

}  // namespace

// ---- What operators ask for ---------------------------------------------------------------------

Task Mission::new_task(TaskKind kind, const std::string& on_link_loss, double expires_s) {
  Task task;
  task.id = ++last_task_;
  task.kind = kind;
  task.planner = config_.planner;
  task.on_link_loss = on_link_loss_of(on_link_loss);
  task.expires = Hub::now() + from_seconds(expires_s);
  return task;
}

void Mission::go_to(const api::GotoRequest& request, const Reply& reply) {
  Result<Robot*> robot = placed_robot_for(request.robot);
  if (!robot) return reply(robot.error());
  Task task = new_task(TaskKind::go_to, request.on_link_loss, request.expires_s);
  task.planner.unknown = unknown_of(request.unknown);
  task.allow_partial = request.allow_partial;
  task.loop = request.loop;
  task.waypoints.push_back({{request.x_m, request.y_m}, request.heading_rad});
  for (const api::PlaceJson& place : request.then) {
    task.waypoints.push_back({{place.x_m, place.y_m}, place.heading_rad});
  }
  if (task.loop && task.waypoints.size() < 2) {
    return reply(Error{ErrorCode::invalid_argument, "a loop needs two places or more"});
  }
  take(**robot, std::move(task), request.queue, reply);
}

void Mission::explore(const api::ExploreRequest& request, const Reply& reply) {
  Result<Robot*> robot = placed_robot_for(request.robot);
  if (!robot) return reply(robot.error());
  Task task = new_task(TaskKind::explore, request.on_link_loss, request.expires_s);
  task.planner.unknown = UnknownGround::blocked;
  if (request.area) {
    const api::AreaJson& area = *request.area;
    if (area.west_m >= area.east_m || area.south_m >= area.north_m) {
      return reply(Error{ErrorCode::invalid_argument,
                         "area: west must be below east and south below north"});
    }
    task.area = AreaM{area.west_m, area.south_m, area.east_m, area.north_m};
  }
  take(**robot, std::move(task), request.queue, reply);
}

void Mission::go_home(const api::ReturnRequest& request, const Reply& reply) {
  Result<Robot*> robot = placed_robot_for(request.robot);
  if (!robot) return reply(robot.error());
  Duty& duty = duties_[(*robot)->id];
  mind(**robot, duty);  // It may have come this very moment.
  Task task = new_task(TaskKind::go_home, request.on_link_loss, request.expires_s);
  task.planner.unknown = unknown_of(request.unknown);
  task.waypoints = {{duty.home_m, {}}};
  take(**robot, std::move(task), request.queue, reply);
}

void Mission::take(Robot& robot, Task task, bool queue, const Reply& reply) {
  Duty& duty = duties_[robot.id];
  if (queue && duty.tasks.current() != nullptr) {
    api::CommandReply answer;
    answer.robot = robot.id;
    answer.status = "queued";
    answer.task = task.id;
    if (Status queued = duty.tasks.append(std::move(task)); !queued) return reply(queued.error());
    return keep(robot, duty, [self = shared_from_this(), answer, reply](const Status& written) {
      if (written) return reply(answer);
      self->duties_[answer.robot].tasks.withdraw(answer.task);
      reply(written.error());
    });
  }
  // What the robot does now goes on until there is something to put in its place.
  plan_leg(robot, task, [self = shared_from_this(), id = robot.id, task, reply](const Planned& p) {
    Duty& ours = self->duties_[id];
    const bool others_first = p.choice.claimed > 0 && !p.choice.frontier;
    if (p.path.status == PathStatus::none && !others_first) {
      const std::string why = task.kind == TaskKind::explore ? "" : "no path: ";
      return reply(Error{ErrorCode::invalid_argument, why + p.path.why});
    }
    const TaskQueue before = ours.tasks;
    ours.tasks.replace(task, "replaced by another task");
    ours.beginning = true;
    ours.waited = false;
    self->keep(self->hub_->robots().at(id), ours,
               [self, id, task, p, before, reply](const Status& written) {
                 if (written) return self->begin(id, task, p, reply);
                 Duty& duty_now = self->duties_[id];
                 const Task* current = duty_now.tasks.current();
                 if (current != nullptr && current->id == task.id) {
                   duty_now.tasks = before;
                   duty_now.beginning = false;
                 }
                 reply(written.error());
               });
  });
}

void Mission::begin(const std::string& id, const Task& task, const Planned& planned,
                    const Reply& reply) {
  Duty& duty = duties_[id];
  const Task* current = duty.tasks.current();
  if (current == nullptr) duty.beginning = false;
  if (current == nullptr || current->id != task.id) {
    return reply(Error{ErrorCode::conflict, "another command came in its place meanwhile"});
  }
  if (!planned.choice.frontier && planned.choice.claimed > 0) {
    duty.beginning = false;
    api::CommandReply answer;
    answer.robot = id;
    answer.status = "queued";
    answer.why = kOthersFirst;
    answer.task = task.id;
    return reply(answer);
  }
  Goal goal = leg_of(task);
  if (planned.choice.frontier) {
    goal.command.goal_x_mm = to_mm(planned.choice.frontier->place_m.x());
    goal.command.goal_y_mm = to_mm(planned.choice.frontier->place_m.y());
  }
  issue(id, std::move(goal), planned,
        [self = shared_from_this(), id, reply, number = task.id](Result<api::CommandReply> sent) {
          self->leg_issued(id, number, sent ? std::string() : sent.error().message);
          if (sent) sent->task = number;
          reply(std::move(sent));
        });
}

// ---- Legs ---------------------------------------------------------------------------------------

Mission::Goal Mission::leg_of(const Task& task) {
  Goal goal;
  goal.planner = task.planner;
  goal.allow_partial = task.allow_partial;
  goal.expires = task.expires;
  goal.of_task = true;
  goal.command.kind = proto::CommandKind::go_to;
  goal.command.issuer = "operator";
  goal.command.on_link_loss = task.on_link_loss;
  if (task.kind != TaskKind::explore) {
    const Waypoint& waypoint = task.waypoints[task.next];
    goal.command.goal_x_mm = to_mm(waypoint.place_m.x());
    goal.command.goal_y_mm = to_mm(waypoint.place_m.y());
    if (waypoint.heading_rad) goal.command.goal_yaw_1e4rad = to_1e4rad(*waypoint.heading_rad);
  }
  return goal;
}

ExploreWish Mission::wish_of(const Robot& robot, const Task& task) const {
  ExploreWish wish{place_of(robot), task.area, {task.avoided_m.begin(), task.avoided_m.end()}, {}};
  for (const auto& [id, goal] : goals_) {
    const auto other = hub_->robots().find(id);
    const bool elsewhere = other == hub_->robots().end() || other->second.site != robot.site;
    if (id == robot.id || elsewhere || !goal.active() || !goal.of_task) continue;
    wish.claimed_m.emplace_back(goal.command.goal_x_mm / 1000.0, goal.command.goal_y_mm / 1000.0);
  }
  return wish;
}

void Mission::plan_leg(const Robot& robot, const Task& task, OnPlanned done) {
  if (task.kind != TaskKind::explore) {
    Goal goal = leg_of(task);
    goal.of_task = false;  // Nothing to look at yet.
    return plan(robot, goal, {}, std::move(done));
  }
  asio::post(executor_, [self = shared_from_this(), map = robot.site->snapshot(),
                         wish = wish_of(robot, task), planner = task.planner,
                         done = std::move(done)] {
    Planned planned;
    planned.map_version = map->version;
    const auto grid = drivable_grid(*map, {wish.from_m}, planner, self->config_.min_probability);
    if (!grid) {
      planned.choice.shut_in = grid.error().message;
    } else {
      planned.choice = choose_frontier(*grid, wish, planner);
      planned.path = planned.choice.path;
      if (!planned.choice.frontier) planned.path.status = PathStatus::none;
    }
    asio::post(self->strand_, [done, planned = std::move(planned)] { done(planned); });
  });
}

void Mission::go_on(Robot& robot, Duty& duty) {
  Task* task = duty.tasks.current();
  if (task == nullptr || duty.beginning || Hub::now() < duty.not_before) return;
  if (const auto goal = goals_.find(robot.id); goal != goals_.end() && goal->second.active())
    return;
  if (Hub::now() >= task->expires) {
    end_leg(*task, LegEnd::out_of_time, "its time was over", {});
    return duty.tasks.settle();
  }
  duty.beginning = true;
  plan_leg(robot, *task,
           [self = shared_from_this(), id = robot.id, number = task->id](const Planned& p) {
             self->leg_planned(id, number, p);
           });
}

void Mission::leg_planned(const std::string& id, std::uint64_t number, const Planned& planned) {
  Duty& duty = duties_[id];
  Task* task = duty.tasks.current();
  duty.beginning = false;
  if (task == nullptr || task->id != number) return;  // Replaced or stopped meanwhile.
  for (const Eigen::Vector2d& place_m : planned.choice.unreachable_m) task->avoid(place_m);
  if (planned.path.status == PathStatus::none) {
    if (task->kind == TaskKind::explore) return nothing_to_explore(id, duty, *task, planned);
    end_leg(*task, LegEnd::not_reached, "no path: " + planned.path.why, {});
    return duty.tasks.settle();
  }
  duty.waited = false;
  duty.beginning = true;
  Goal goal = leg_of(*task);
  if (planned.choice.frontier) {
    goal.command.goal_x_mm = to_mm(planned.choice.frontier->place_m.x());
    goal.command.goal_y_mm = to_mm(planned.choice.frontier->place_m.y());
  }
  issue(id, std::move(goal), planned,
        [self = shared_from_this(), id, number](const Result<api::CommandReply>& sent) {
          self->leg_issued(id, number, sent ? std::string() : sent.error().message);
        });
}

void Mission::leg_issued(const std::string& id, std::uint64_t number, const std::string& fault) {
  Duty& duty = duties_[id];
  duty.beginning = false;
  Task* task = duty.tasks.current();
  if (fault.empty() || task == nullptr || task->id != number) return;
  end_leg(*task, LegEnd::out_of_hand, fault, {});
  duty.tasks.settle();
}

void Mission::nothing_to_explore(const std::string& id, Duty& duty, Task& task,
                                 const Planned& planned) {
  duty.not_before = Hub::now() + kLookPause;
  if (planned.choice.claimed > 0) {
    task.why = kOthersFirst;
    return;
  }
  if (!std::exchange(duty.waited, true)) return;  // Evidence may still be on its way.
  end_exploring(task, planned.choice);
  duty.tasks.settle();
  // It may still be on its way to a place that has been seen meanwhile.
  const auto goal = goals_.find(id);
  Robot* robot = hub_->find(id);
  if (robot == nullptr || goal == goals_.end() || !robot->pose) return;
  if (robot->pose->command == goal->second.command.id) cancel(*robot, goal->second);
}

void Mission::leg_ended(Robot& robot, const Goal& goal, LegEnd how) {
  if (!goal.of_task) return;
  Duty& duty = duties_[robot.id];
  Task* task = duty.tasks.current();
  if (task == nullptr || duty.beginning) return;  // Its successor is under way.
  const bool exploring = task->kind == TaskKind::explore;
  end_leg(*task, how, goal.why, {goal.command.goal_x_mm / 1000.0, goal.command.goal_y_mm / 1000.0});
  if (task->state != TaskState::active) {
    spdlog::info("robot {}: task {} ({}) {}{}{}", robot.id, task->id, name_of(task->kind),
                 name_of(task->state), task->why.empty() ? "" : ": ", task->why);
  }
  duty.tasks.settle();
  duty.not_before = exploring && how != LegEnd::seen ? Hub::now() + kLookPause : MonotonicTime{};
  if (how != LegEnd::seen) return;
  // The robot drives on towards the place until it gets its next goal.
  if (const auto current = goals_.find(robot.id); current != goals_.end()) {
    current->second.state = "arrived";
    current->second.why = "what was to be seen there has been seen";
  }
  go_on(robot, duty);
}

void Mission::mind(Robot& robot, Duty& duty) {
  if (!robot.pose || !robot.link) return;
  if (!duty.site.empty() && duty.site != robot.site->info().name) {
    duty.tasks.cancel("the robot is on another site now");
    duty.site.clear();
  }
  if (duty.boot != robot.link->boot() && robot.pose_of_session) {
    duty.boot = robot.link->boot();
    duty.home_m = place_of(robot);
    duty.kept_tasks.clear();  // Home goes with them.
  }
  if (robot.pose->drive == proto::DriveState::driving) {
    constexpr double kNewest = 0.02;
    const double speed_m_s = std::abs(robot.pose->speed_mm_s) / 1000.0;
    duty.speed_m_s = std::max(0.05, (1.0 - kNewest) * duty.speed_m_s + kNewest * speed_m_s);
  }
  go_on(robot, duty);
}

// ---- What operators are told --------------------------------------------------------------------

std::optional<double> Mission::seconds_to_go(const std::string& id, const Task* task) const {
  const auto duty = duties_.find(id);
  const auto goal = goals_.find(id);
  const auto robot = hub_->robots().find(id);
  if (duty == duties_.end() || goal == goals_.end() || robot == hub_->robots().end()) return {};
  if (!robot->second.pose) return {};
  const bool told = robot->second.pose->command == goal->second.command.id;
  double to_go_m = told ? robot->second.pose->to_go_mm / 1000.0 : length_m(goal->second.path_m);
  if (task != nullptr) to_go_m += length_after_next_m(*task);
  return to_go_m / duty->second.speed_m_s;
}

std::optional<api::TaskJson> Mission::describe_task(const std::string& robot) const {
  const auto duty = duties_.find(robot);
  const Task* task = duty == duties_.end() ? nullptr : duty->second.tasks.newest();
  if (task == nullptr) return {};
  api::TaskJson json;
  json.id = task->id;
  json.kind = name_of(task->kind);
  json.state = name_of(task->state);
  json.why = task->why;
  json.legs = task->legs;
  json.legs_all = task->waypoints.size();
  json.rounds = task->rounds;
  json.waiting = duty->second.tasks.waiting();
  if (task->state != TaskState::active) return json;
  json.expires_s = std::max(0.0, to_seconds(task->expires - Hub::now()));
  if (task->kind != TaskKind::explore && !task->loop) json.eta_s = seconds_to_go(robot, task);
  return json;
}

}  // namespace cairn::server
