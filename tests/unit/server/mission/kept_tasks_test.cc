#include "server/mission/kept_tasks.h"

#include <gtest/gtest.h>

#include <random>

namespace cairn::server {
namespace {

using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;

const ClockPair kBefore{hours(90), 1'800'000'000'000};
/// The next server's: its clock began anew, 10 s passed.
const ClockPair kAfter{seconds(5), 1'800'000'010'000};

Task patrol() {
  Task task;
  task.id = 12;
  task.waypoints = {{{1.5, -2.25}, 0.5}, {{100.125, 7.0}, {}}};
  task.loop = true;
  task.planner.unknown = UnknownGround::allowed;
  task.on_link_loss = proto::OnLinkLoss::retrace;
  task.expires = kBefore.monotonic + minutes(30);
  task.next = 1;
  task.legs = 1;
  task.rounds = 4;
  return task;
}

Task exploration(std::uint64_t id) {
  Task task;
  task.id = id;
  task.kind = TaskKind::explore;
  task.area = AreaM{-5.0, -4.0, 30.5, 20.0};
  task.planner.unknown = UnknownGround::blocked;
  task.expires = kBefore.monotonic + hours(1);
  task.legs = 7;
  task.failures = 2;
  task.avoid({3.25, 4.5});
  return task;
}

KeptDuty duty() {
  Task done = patrol();
  done.id = 11;
  done.loop = false;
  done.state = TaskState::failed;
  done.why = "no path: the goal is on an obstacle";
  return {TaskQueue({exploration(13), patrol()}, done), 14, 0xFFEEDDCCBBAA9988, {-1.5, 2.0}};
}

TEST(KeptTasks, ComeBackAsTheyWereAndExpireWhenTheyWouldHave) {
  PlannerConfig planner;
  planner.unknown_price = 7.0;
  const auto back = decode_duty(encode(duty(), kBefore), kAfter, planner);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->newest_task, 14U);
  EXPECT_EQ(back->boot, 0xFFEEDDCCBBAA9988);
  EXPECT_EQ(back->home_m, Eigen::Vector2d(-1.5, 2.0));
  ASSERT_EQ(back->tasks.all().size(), 2U);
  const Task& explore = back->tasks.all()[0];
  EXPECT_EQ(explore.id, 13U);
  EXPECT_EQ(explore.kind, TaskKind::explore);
  EXPECT_EQ(explore.area->east_m, 30.5);
  EXPECT_EQ(explore.planner.unknown, UnknownGround::blocked);
  EXPECT_EQ(explore.planner.unknown_price, 7.0) << "the rest is as this server plans";
  EXPECT_EQ(explore.legs, 7U);
  EXPECT_EQ(explore.failures, 2);
  ASSERT_EQ(explore.avoided_m.size(), 1U);
  EXPECT_EQ(explore.avoided_m[0], Eigen::Vector2d(3.25, 4.5));
  EXPECT_EQ(explore.expires, kAfter.monotonic + hours(1) - seconds(10));
  const Task& waits = back->tasks.all()[1];
  ASSERT_EQ(waits.waypoints.size(), 2U);
  EXPECT_EQ(waits.waypoints[0].place_m, Eigen::Vector2d(1.5, -2.25));
  EXPECT_NEAR(*waits.waypoints[0].heading_rad, 0.5, 1e-4);
  EXPECT_FALSE(waits.waypoints[1].heading_rad);
  EXPECT_TRUE(waits.loop);
  EXPECT_EQ(waits.next, 1U);
  EXPECT_EQ(waits.rounds, 4U);
  EXPECT_EQ(waits.on_link_loss, proto::OnLinkLoss::retrace);
  ASSERT_TRUE(back->tasks.last());
  EXPECT_EQ(back->tasks.last()->state, TaskState::failed);
  EXPECT_EQ(back->tasks.last()->why, "no path: the goal is on an obstacle");
}

TEST(KeptTasks, ATaskWhoseTimeRanOutMeanwhileIsOver) {
  ClockPair long_after = kAfter;
  long_after.unix_ms += 48LL * 3600 * 1000;
  const auto back = decode_duty(encode(duty(), kBefore), long_after, {});
  EXPECT_LT(back->tasks.all()[0].expires, long_after.monotonic);
}

TEST(KeptTasks, TheMostThereCanBeFitIntoANote) {
  Task longest = exploration(1);
  longest.why = std::string(2000, 'x');
  for (int i = 0; i < 2000; ++i) longest.avoid({i * 1.0, 0.0});
  std::deque<Task> tasks{longest};
  while (tasks.size() < 1 + TaskQueue::kMaxWaiting) {
    tasks.push_back(patrol());
    tasks.back().waypoints.assign(257, {{1, 2}, 3.0});
  }
  const KeptDuty most{TaskQueue(tasks, tasks.back()), 1, 2, {}};
  const std::string bytes = encode(most, kBefore);
  EXPECT_LE(bytes.size(), 65'536U);
  const auto back = decode_duty(bytes, kAfter, {});
  ASSERT_TRUE(back);
  EXPECT_EQ(back->tasks.all().size(), tasks.size());
  EXPECT_EQ(back->tasks.all()[0].avoided_m.size(), Task::kMaxAvoided);
}

TEST(KeptTasks, WhatIsNoTaskIsRefused) {
  const std::string good = encode(duty(), kBefore);
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_FALSE(decode_duty(good.substr(0, size), kAfter, {})) << size;
  }
  EXPECT_FALSE(decode_duty(good + "x", kAfter, {}));
  std::string newer = good;
  newer[0] = 2;
  EXPECT_EQ(decode_duty(newer, kAfter, {}).error().code, ErrorCode::unsupported_version);
}

TEST(KeptTasks, SurviveAnyBytes) {
  std::mt19937 random(7);
  const std::string good = encode(duty(), kBefore);
  for (int i = 0; i < 20'000; ++i) {
    std::string bytes = good;
    for (int k = 0; k < 3; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
    const auto back = decode_duty(bytes, kAfter, {});
    if (!back) continue;
    ASSERT_LE(back->tasks.all().size(), 1 + TaskQueue::kMaxWaiting);
    for (const Task& task : back->tasks.all()) {
      if (task.kind == TaskKind::explore || task.state != TaskState::active) continue;
      ASSERT_LT(task.next, task.waypoints.size());
    }
  }
}

TEST(TaskQueue, ATaskThatCouldNotBeKeptIsWithdrawn) {
  TaskQueue queue({exploration(1), exploration(2), exploration(3)}, {});
  queue.withdraw(2);
  ASSERT_EQ(queue.all().size(), 2U);
  EXPECT_EQ(queue.all()[1].id, 3U);
}

}  // namespace
}  // namespace cairn::server
