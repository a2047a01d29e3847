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

namespace cairn::server {

struct MissionConfig {
  PlannerConfig planner;
  std::uint8_t min_probability = 25;  ///< [1/255] Cells below it count as unknown.
  /// How long a silent link may last before a robot told to stop on link loss stops.
  Duration link_timeout = std::chrono::seconds(5);
};

/// Turns what operators want into commands, and keeps their paths right while the map changes: the
/// rest of the way is checked against each new snapshot and planned anew when it is no longer open
/// or the robot says that it is blocked. Lives on the control strand; planning itself runs on the
/// executor's threads.
class Mission : public std::enable_shared_from_this<Mission> {
 public:
  Mission(Hub::Strand strand, boost::asio::any_io_executor executor, std::shared_ptr<Hub> hub,
          MissionConfig config);

  void go_to(const api::GotoRequest& request, const Service::Reply<api::CommandReply>& reply);
  void stop(const api::StopRequest& request, const Service::Reply<api::CommandReply>& reply);

  void connected(Robot& robot);
  void reported(Robot& robot, const proto::CommandReport& report);
  void start();
  void halt();

  [[nodiscard]] std::optional<api::CommandJson> describe(const std::string& robot) const;

  static constexpr std::chrono::milliseconds kTick{200};
  /// A check of the way may take this share of the time.
  static constexpr double kCheckShare = 0.2;
  /// Paths sent for one goal; beyond it the mission gives up and says so.
  static constexpr std::uint32_t kMaxRevisions = 200;
  /// A robot that reports this often that it is blocked, at one place, has no way on from there.
  static constexpr int kMaxBlockades = 8;
  /// [m] Within it, it is one place.
  static constexpr double kSamePlaceM = 0.5;

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
    [[nodiscard]] bool active() const {
      return state == "sent" || state == "accepted" || state == "blocked";
    }
  };
  struct Planned {
    Path path;
    bool kept = false;  ///< The old path is still open; `path` is not set.
    std::uint64_t map_version = 0;
    Duration took{};
  };
  using OnPlanned = std::function<void(const Planned&)>;

  Result<Robot*> robot_for(const std::optional<std::string>& name);
  /// Plans on the executor; `keep_m` is the present path, kept when the rest of it is open.
  void plan(const Robot& robot, const Goal& goal, std::vector<Eigen::Vector2d> keep_m,
            OnPlanned done);
  void issue(const std::string& robot, Goal goal, const Planned& planned,
             const Service::Reply<api::CommandReply>& reply);
  void send(Robot& robot, Goal& goal);
  void check(Robot& robot, Goal& goal);
  void replanned(const std::string& robot, std::uint64_t command, const Planned& planned);
  void count_blockade(Robot& robot, Goal& goal);
  void cancel(Robot& robot, Goal& goal);
  void give_up(Robot& robot, Goal& goal, const std::string& why);
  void tick();

  Hub::Strand strand_;
  boost::asio::any_io_executor executor_;
  std::shared_ptr<Hub> hub_;
  MissionConfig config_;
  boost::asio::steady_timer timer_;
  std::map<std::string, Goal> goals_;  ///< By robot; bounded by Hub::kMaxRobots.
  bool running_ = false;
};

}  // namespace cairn::server
