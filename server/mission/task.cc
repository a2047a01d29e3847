#include "server/mission/task.h"

#include <utility>

namespace cairn::server {

namespace {

void end(Task& task, TaskState state, std::string why) {
  task.state = state;
  task.why = std::move(why);
}

void reach_waypoint(Task& task) {
  ++task.legs;
  if (++task.next < task.waypoints.size()) return;
  if (!task.loop) return end(task, TaskState::done, "");
  task.next = 0;
  task.legs = 0;
  ++task.rounds;
}

}  // namespace

void Task::avoid(const Eigen::Vector2d& place_m) {
  avoided_m.push_back(place_m);
  if (avoided_m.size() > kMaxAvoided) avoided_m.pop_front();
}

void end_leg(Task& task, LegEnd how, const std::string& why, const Eigen::Vector2d& goal_m) {
  task.why.clear();
  if (how == LegEnd::out_of_time) return end(task, TaskState::expired, why);
  if (how == LegEnd::out_of_hand) return end(task, TaskState::failed, why);
  if (task.kind != TaskKind::explore) {
    if (how != LegEnd::reached) return end(task, TaskState::failed, why);
    return reach_waypoint(task);
  }
  if (how != LegEnd::seen) task.avoid(goal_m);
  if (how == LegEnd::no_way) return;  // That is what frontiers are like: nothing failed.
  if (how == LegEnd::not_reached) {
    if (++task.failures >= Task::kMaxFailures) end(task, TaskState::failed, why);
    return;
  }
  task.failures = 0;
  ++task.legs;
}

void TaskQueue::replace(Task task, const std::string& why) {
  cancel(why);
  tasks_.push_back(std::move(task));
}

Status TaskQueue::append(Task task) {
  if (tasks_.size() > kMaxWaiting) {
    return Error{ErrorCode::exhausted,
                 "16 tasks wait for the robot already: let it do some, or stop it"};
  }
  tasks_.push_back(std::move(task));
  return {};
}

void TaskQueue::withdraw(std::uint64_t id) {
  std::erase_if(tasks_, [&](const Task& task) { return task.id == id; });
}

void TaskQueue::cancel(const std::string& why) {
  if (tasks_.empty()) return;
  end(tasks_.front(), TaskState::cancelled, why);
  last_ = std::move(tasks_.front());
  tasks_.clear();
}

Task* TaskQueue::current() { return tasks_.empty() ? nullptr : &tasks_.front(); }

void TaskQueue::settle() {
  while (!tasks_.empty() && tasks_.front().state != TaskState::active) {
    const bool go_on = tasks_.front().state == TaskState::done;
    last_ = std::move(tasks_.front());
    tasks_.pop_front();
    if (go_on || tasks_.empty()) continue;
    last_->why += "; " + std::to_string(tasks_.size()) + " tasks behind it were dropped";
    tasks_.clear();
  }
}

const Task* TaskQueue::newest() const {
  if (!tasks_.empty()) return &tasks_.front();
  return last_ ? &*last_ : nullptr;
}

}  // namespace cairn::server
