#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/planner/plan.h"
#include "proto/codec/records.h"
#include "server/api/service.h"
#include "server/link/hub.h"
#include "server/mission/exploring.h"
#include "server/mission/kept_fields.h"
#include "server/mission/kept_tasks.h"
#include "server/mission/task.h"

namespace cairn::server {

struct MissionConfig {
  PlannerConfig planner;
  std::uint8_t min_probability = 25;  ///< [1/255] Cells below it count as unknown.
  /// How long a silent link may last before a robot told to stop on link loss stops.
  Duration link_timeout = std::chrono::seconds(5);
};

/// Turns what operators want into commands. A *task* (go to these places, explore, return) is a row
/// of legs; each leg is one *goal*, a command to the robot whose path is kept right while the map
/// changes: the rest of the way is checked against each new snapshot and planned anew when it is no
/// longer open or the robot says that it is blocked. When a leg ends the task's next one begins.
/// Lives on the control strand; planning itself runs on the executor's threads. Tasks are
/// kept in their site's store: what an operator was told is accepted outlives the server, and goes
/// on when the robot is heard again. A robot finishes the leg it drives without it.
class Mission : public std::enable_shared_from_this<Mission> {
 public:
  Mission(Hub::Strand strand, boost::asio::any_io_executor executor, std::shared_ptr<Hub> hub,
          MissionConfig config);

  void go_to(const api::GotoRequest& request, const Service::Reply<api::CommandReply>& reply);
  void explore(const api::ExploreRequest& request, const Service::Reply<api::CommandReply>& reply);
  void go_home(const api::ReturnRequest& request, const Service::Reply<api::CommandReply>& reply);
  void stop(const api::StopRequest& request, const Service::Reply<api::CommandReply>& reply);

  void connected(Robot& robot);
  void reported(Robot& robot, const proto::CommandReport& report);
  void asked(Robot& robot, const proto::CorridorRequest& request);
  /// Takes up what the site's store keeps of robots' tasks. Before start.
  void restore(const Site& site);
  void start();
  void halt();

  /// The fields that its goals are planned with, for others who plan.
  [[nodiscard]] KeptFields& fields() { return fields_; }

  [[nodiscard]] std::optional<api::CommandJson> describe(const std::string& robot) const;
  [[nodiscard]] std::optional<api::TaskJson> describe_task(const std::string& robot) const;

  static constexpr std::chrono::milliseconds kTick{200};
  /// A check of the way may take this share of the time.
  static constexpr double kCheckShare = 0.2;
  /// Paths sent for one goal; beyond it the mission gives up and says so.
  static constexpr std::uint32_t kMaxRevisions = 200;
  /// A robot that reports this often that it is blocked, at one place, has no way on from there.
  static constexpr int kMaxBlockades = 8;
  /// [m] Within it, it is one place.
  static constexpr double kBlockadeM = 0.5;
  /// An exploring robot's newest evidence is waited for so long before it is sent on, or nothing
  /// more to explore is believed.
  static constexpr Duration kLookPause = std::chrono::milliseconds(1500);
  /// Whether there is still something new at a frontier is looked at this often.
  static constexpr Duration kLookPeriod = std::chrono::seconds(1);
  /// How tasks get on is written this often at most.
  static constexpr Duration kKeepPeriod = std::chrono::seconds(1);
  /// A robot is given more of its field this often at most.
  static constexpr Duration kCorridorPeriod = std::chrono::seconds(1);
  /// [m/s] Taken for a robot whose speed is not known yet.
  static constexpr double kUsualSpeed = 0.4;

 private:
  struct Goal {
    proto::Command command;
    std::string state = "sent";
    std::string why;
    PlannerConfig planner;
    bool allow_partial = false;
    MonotonicTime expires{};
    std::vector<Eigen::Vector2d> path_m;
    bool planning = false;    ///< A plan is being made on another thread.
    bool cancelling = false;  ///< Given up; the robot may not know yet.
    bool wants_plan = false;  ///< The robot is blocked.
    Eigen::Vector2d blocked_at_m = Eigen::Vector2d::Constant(1e9);
    int times_blocked_here = 0;
    std::uint64_t checked_map = 0;  ///< Snapshot version that the path was last checked on.
    MonotonicTime next_check{};
    bool corridor_busy = false;  ///< One is being made on another thread.
    MonotonicTime next_corridor{};
    bool of_task = false;  ///< A leg; its task wants to know how it ended.
    [[nodiscard]] bool active() const {
      return state == "sent" || state == "accepted" || state == "blocked";
    }
  };
  struct Planned {
    Path path;
    bool kept = false;  ///< The old path is still open; `path` is not set.
    bool seen = false;  ///< Exploring: there is nothing new at the goal any more.
    std::uint64_t map_version = 0;
    Duration took{};
    FrontierChoice choice;  ///< When one was asked for.
  };
  using OnPlanned = std::function<void(const Planned&)>;
  using Reply = Service::Reply<api::CommandReply>;
  /// What the mission knows of a robot besides its goal.
  struct Duty {
    TaskQueue tasks;
    bool beginning = false;  ///< A leg of the first task is being planned or numbered.
    bool waited = false;     ///< Nothing was found to explore, once already.
    MonotonicTime not_before{};
    std::uint64_t boot = 0;
    Eigen::Vector2d home_m = Eigen::Vector2d::Zero();  ///< Where the boot was first seen.
    double speed_m_s = kUsualSpeed;                    ///< Lately, while driving.
    std::string site;                                  ///< Whose store keeps it; empty: none yet.
    std::uint64_t newest_task = 0;                     ///< It ever had.
    std::string kept_tasks;  ///< What the store was last told, see fingerprint.
    MonotonicTime keep_after{};
  };

  Result<Robot*> robot_for(const std::optional<std::string>& name);
  /// The same, and it has told its pose.
  Result<Robot*> placed_robot_for(const std::optional<std::string>& name);
  [[nodiscard]] static PlanTarget target_of(const Robot& robot, const Goal& goal);
  /// Plans on the executor; `keep_m` is the present path, kept when the rest of it is open.
  void plan(const Robot& robot, const Goal& goal, std::vector<Eigen::Vector2d> keep_m,
            OnPlanned done);
  void issue(const std::string& robot, Goal goal, const Planned& planned, const Reply& reply);
  void send(Robot& robot, Goal& goal);
  void check(Robot& robot, Goal& goal);
  void replanned(const std::string& robot, std::uint64_t command, const Planned& planned);
  void count_blockade(Robot& robot, Goal& goal);
  void cancel(Robot& robot, Goal& goal);
  void give_up(Robot& robot, Goal& goal, const std::string& why, LegEnd how = LegEnd::not_reached);
  void tick();

  // What outlives the server (mission_keeping.cc).
  /// `done` is called when it is durable, or could not be made so.
  void keep(const Robot& robot, Duty& duty, std::function<void(Status)> done);
  void keep_what_changed(const Robot& robot, Duty& duty);
  [[nodiscard]] static std::string fingerprint(const TaskQueue& tasks);

  // The field around a goal's way (mission_corridors.cc).
  /// Along the goal's path; for a robot that asks, from where it is.
  void offer_corridor(const Robot& robot, Goal& goal,
                      const std::optional<proto::CorridorRequest>& request);
  void corridor_made(const std::string& robot, std::uint64_t command,
                     std::vector<proto::CorridorPart> parts);

  // Tasks (mission_tasks.cc).
  [[nodiscard]] Task new_task(TaskKind kind, const std::string& on_link_loss, double expires_s);
  /// Begins a task in place of what the robot does, or queues it.
  void take(Robot& robot, Task task, bool queue, const Reply& reply);
  [[nodiscard]] static Goal leg_of(const Task& task);
  [[nodiscard]] ExploreWish wish_of(const Robot& robot, const Task& task) const;
  void plan_leg(const Robot& robot, const Task& task, OnPlanned done);
  /// The robot's first task begins: its first leg was planned, and it is kept.
  void begin(const std::string& robot, const Task& task, const Planned& planned,
             const Reply& reply);
  /// The next leg of the robot's first task, when it is time.
  void go_on(Robot& robot, Duty& duty);
  void leg_planned(const std::string& robot, std::uint64_t task, const Planned& planned);
  void leg_issued(const std::string& robot, std::uint64_t task, const std::string& fault);
  void nothing_to_explore(const std::string& robot, Duty& duty, Task& task, const Planned& planned);
  void leg_ended(Robot& robot, const Goal& goal, LegEnd how);
  void mind(Robot& robot, Duty& duty);
  [[nodiscard]] std::optional<double> seconds_to_go(const std::string& robot,
                                                    const Task* task) const;

  Hub::Strand strand_;
  boost::asio::any_io_executor executor_;
  std::shared_ptr<Hub> hub_;
  MissionConfig config_;
  KeptFields fields_;
  boost::asio::steady_timer timer_;
  std::map<std::string, Goal> goals_;   ///< By robot; bounded by Hub::kMaxRobots.
  std::map<std::string, Duty> duties_;  ///< As goals_.
  std::uint64_t last_task_ = 0;
  bool running_ = false;
};

}  // namespace cairn::server
