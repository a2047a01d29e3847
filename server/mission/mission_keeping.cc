#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <chrono>
#include <string_view>
#include <utility>

#include "server/mission/mission.h"

/// The part of Mission that keeps tasks in the sites' stores.
namespace cairn::server {

namespace asio = boost::asio;

namespace {

constexpr std::string_view kNotePrefix = "tasks/";

ClockPair clocks_now() {
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  return {Hub::now(), std::chrono::duration_cast<std::chrono::milliseconds>(since_epoch).count()};
}

}  // namespace

void Mission::restore(const Site& site) {
  for (const auto& [name, bytes] : site.notes_at_start()) {
    if (!name.starts_with(kNotePrefix)) continue;
    const std::string robot = name.substr(kNotePrefix.size());
    auto kept = decode_duty(bytes, clocks_now(), config_.planner);
    if (!kept) {
      spdlog::error("site {}: robot {}'s tasks: {}", site.info().name, robot, kept.error().message);
      continue;
    }
    last_task_ = std::max(last_task_, kept->newest_task);
    Duty& duty = duties_[robot];
    if (duty.newest_task > kept->newest_task) continue;  // It has been on another site since.
    duty.site = site.info().name;
    duty.newest_task = kept->newest_task;
    duty.tasks = std::move(kept->tasks);
    duty.boot = kept->boot;
    duty.home_m = kept->home_m;
    duty.kept_tasks = fingerprint(duty.tasks);
    if (const Task* task = duty.tasks.current()) {
      spdlog::info("robot {}: task {} goes on when it is heard, {} wait behind it", robot, task->id,
                   duty.tasks.waiting());
    }
  }
}

void Mission::keep(const Robot& robot, Duty& duty, std::function<void(Status)> done) {
  duty.site = robot.site->info().name;
  duty.keep_after = Hub::now() + kKeepPeriod;
  if (const Task* task = duty.tasks.newest()) {
    duty.newest_task = std::max(duty.newest_task, task->id);
  }
  for (const Task& task : duty.tasks.all()) duty.newest_task = std::max(duty.newest_task, task.id);
  duty.kept_tasks = fingerprint(duty.tasks);
  const KeptDuty kept{duty.tasks, duty.newest_task, duty.boot, duty.home_m};
  robot.site->keep_note(std::string(kNotePrefix) + robot.id, encode(kept, clocks_now()),
                        [self = shared_from_this(), done = std::move(done)](const Status& written) {
                          asio::post(self->strand_, [done, written] { done(written); });
                        });
}

void Mission::keep_what_changed(const Robot& robot, Duty& duty) {
  if (duty.tasks.newest() == nullptr || Hub::now() < duty.keep_after) return;
  if (fingerprint(duty.tasks) == duty.kept_tasks) return;
  keep(robot, duty, [self = shared_from_this(), id = robot.id](const Status& written) {
    if (written) return;
    spdlog::error("robot {}: its tasks could not be kept: {}", id, written.error().message);
    self->duties_[id].kept_tasks.clear();  // Tried again.
  });
}

std::string Mission::fingerprint(const TaskQueue& tasks) {
  // At a fixed moment, so that only changes of the tasks themselves show.
  return encode({tasks, 0, 0, Eigen::Vector2d::Zero()}, {});
}

}  // namespace cairn::server
