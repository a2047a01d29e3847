#include "server/mission/task.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cairn::server {
namespace {

using testing::HasSubstr;

const Eigen::Vector2d kThere(3.0, 4.0);

Task patrol(bool loop) {
  Task task;
  task.id = 1;
  task.waypoints = {{{1, 0}, {}}, {{2, 0}, {}}, {{3, 0}, {}}};
  task.loop = loop;
  return task;
}

Task explore() {
  Task task;
  task.kind = TaskKind::explore;
  return task;
}

void reach(Task& task, int legs) {
  for (int i = 0; i < legs; ++i) end_leg(task, LegEnd::reached, "", kThere);
}

TEST(Task, IsDoneWhenAllPlacesWereReached) {
  Task task = patrol(false);
  reach(task, 2);
  EXPECT_EQ(task.state, TaskState::active);
  EXPECT_EQ(task.next, 2U);
  reach(task, 1);
  EXPECT_EQ(task.state, TaskState::done);
  EXPECT_EQ(task.legs, 3U);
}

TEST(Task, ALoopBeginsAgain) {
  Task task = patrol(true);
  reach(task, 7);
  EXPECT_EQ(task.state, TaskState::active);
  EXPECT_EQ(task.rounds, 2U);
  EXPECT_EQ(task.next, 1U);
  end_leg(task, LegEnd::out_of_time, "its time was over", kThere);
  EXPECT_EQ(task.state, TaskState::expired);
}

TEST(Task, APlaceThatIsNotReachedFailsIt) {
  Task task = patrol(false);
  end_leg(task, LegEnd::not_reached, "no way", kThere);
  EXPECT_EQ(task.state, TaskState::failed);
  EXPECT_EQ(task.why, "no way");
}

TEST(Task, ExploringRemembersWhatItCouldNotReachAndGoesOn) {
  Task task = explore();
  end_leg(task, LegEnd::not_reached, "no way", kThere);
  EXPECT_EQ(task.state, TaskState::active);
  EXPECT_THAT(task.avoided_m, testing::ElementsAre(kThere));
  reach(task, 1);
  EXPECT_EQ(task.failures, 0);
}

TEST(Task, ExploringForgetsAPlaceThatWasSeenFromAfar) {
  Task task = explore();
  end_leg(task, LegEnd::seen, "", kThere);
  EXPECT_TRUE(task.avoided_m.empty());
  EXPECT_EQ(task.legs, 1U);
}

TEST(Task, ExploringGivesUpWhenNothingWorks) {
  Task task = explore();
  for (int i = 0; i < Task::kMaxFailures; ++i) end_leg(task, LegEnd::not_reached, "stuck", kThere);
  EXPECT_EQ(task.state, TaskState::failed);
  Task lost = explore();
  end_leg(lost, LegEnd::out_of_hand, "lost", kThere);
  EXPECT_EQ(lost.state, TaskState::failed);
}

TEST(Task, RemembersABoundedNumberOfPlaces) {
  Task task = explore();
  for (std::size_t i = 0; i < Task::kMaxAvoided + 10; ++i) task.avoid(kThere);
  EXPECT_EQ(task.avoided_m.size(), Task::kMaxAvoided);
}

Task numbered(std::uint64_t id) {
  Task task = patrol(false);
  task.id = id;
  return task;
}

TEST(TaskQueue, CarriesOutOneAfterTheOther) {
  TaskQueue queue;
  ASSERT_TRUE(queue.append(numbered(1)));
  ASSERT_TRUE(queue.append(numbered(2)));
  EXPECT_EQ(queue.waiting(), 1U);
  reach(*queue.current(), 3);
  queue.settle();
  ASSERT_NE(queue.current(), nullptr);
  EXPECT_EQ(queue.current()->id, 2U);
  reach(*queue.current(), 3);
  queue.settle();
  EXPECT_EQ(queue.current(), nullptr);
  EXPECT_EQ(queue.newest()->id, 2U);
  EXPECT_EQ(queue.newest()->state, TaskState::done);
}

TEST(TaskQueue, DropsWhatWaitsBehindAFailure) {
  TaskQueue queue;
  ASSERT_TRUE(queue.append(numbered(1)));
  ASSERT_TRUE(queue.append(numbered(2)));
  end_leg(*queue.current(), LegEnd::not_reached, "no way", kThere);
  queue.settle();
  EXPECT_EQ(queue.current(), nullptr);
  EXPECT_THAT(queue.newest()->why, HasSubstr("no way; 1 tasks behind it were dropped"));
}

TEST(EndLeg, FrontiersThatTurnOutToHaveNoWayAreNoFailuresOfExploring) {
  Task task;
  task.kind = TaskKind::explore;
  for (int i = 0; i < 10 * Task::kMaxFailures; ++i) {
    end_leg(task, LegEnd::no_way, "beside an obstacle", {1.0 * i, 0.0});
  }
  EXPECT_EQ(task.state, TaskState::active);
  EXPECT_EQ(task.avoided_m.size(), 10U * Task::kMaxFailures);
  for (int i = 0; i < Task::kMaxFailures; ++i) {
    end_leg(task, LegEnd::not_reached, "blocked", {1.0 * i, 5.0});
  }
  EXPECT_EQ(task.state, TaskState::failed);
}

TEST(EndLeg, NoWayFailsATaskThatWantedToGetThere) {
  Task task;
  task.waypoints = {{{1.0, 2.0}, {}}};
  end_leg(task, LegEnd::no_way, "a wall", {1.0, 2.0});
  EXPECT_EQ(task.state, TaskState::failed);
}

TEST(TaskQueue, ANewTaskTakesThePlaceOfAll) {
  TaskQueue queue;
  ASSERT_TRUE(queue.append(numbered(1)));
  ASSERT_TRUE(queue.append(numbered(2)));
  queue.replace(numbered(3), "replaced");
  EXPECT_EQ(queue.current()->id, 3U);
  EXPECT_EQ(queue.waiting(), 0U);
  queue.cancel("stopped");
  EXPECT_EQ(queue.newest()->state, TaskState::cancelled);
  EXPECT_EQ(queue.newest()->why, "stopped");
}

TEST(TaskQueue, IsBounded) {
  TaskQueue queue;
  for (std::size_t i = 0; i <= TaskQueue::kMaxWaiting; ++i) ASSERT_TRUE(queue.append(numbered(i)));
  EXPECT_EQ(queue.append(numbered(99)).error().code, ErrorCode::exhausted);
  EXPECT_EQ(TaskQueue().newest(), nullptr);
}

}  // namespace
}  // namespace cairn::server
