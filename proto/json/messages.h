#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/common/result.h"

/// The words of the operator's API, as they stand in JSON (API.md tells who sends each and gives an
/// example). Metres, radians and seconds as doubles; every key has its unit as suffix.
namespace cairn::api {

/// [m] Coordinates beyond this from the site's origin are refused.
inline constexpr double kMaxCoordinateM = 100'000.0;
inline constexpr std::size_t kMaxNameChars = 32;  ///< Robot ids and site names: [a-z0-9_-]+
inline constexpr std::size_t kMaxPathPoints = 4096;
inline constexpr std::size_t kMaxWaypoints = 256;
inline constexpr std::size_t kMaxTrackPoints = 100'000;  ///< Per robot.
inline constexpr std::size_t kMaxSites = 256;
inline constexpr std::size_t kMaxRobots = 1024;
inline constexpr int kMinWatchPeriodMs = 100;
inline constexpr int kMaxWatchPeriodMs = 10'000;

struct PointJson {
  double x_m = 0.0;
  double y_m = 0.0;
};

/// Where a robot is sent.
struct PlaceJson {
  double x_m = 0.0;
  double y_m = 0.0;
  std::optional<double> heading_rad{};  ///< To turn to there, 0 = east; none: any. [Limit: ±2π]
};

/// IP bytes by what they were for.
struct TrafficJson {
  std::uint64_t control_bytes = 0;  ///< Commands, reports, acknowledgements, set-up.
  std::uint64_t pose_bytes = 0;
  std::uint64_t map_bytes = 0;
};

/// What the robot keeps on its disk of the evidence that the server does not hold.
struct SpoolJson {
  std::string state;          ///< "ok", "failed" (the disk takes no more)
  std::uint64_t submaps = 0;  ///< Not held by the server in full, on disk or in memory.
  std::uint64_t bytes = 0;    ///< On disk.
  std::uint64_t thinned = 0;  ///< Submaps of which the layer seen through had to go.
  std::uint64_t dropped = 0;  ///< Submaps that had to go whole.
};

struct LinkJson {
  bool connected = false;
  double silence_s = 0.0;  ///< Since the robot's last frame.
  double round_trip_s = 0.0;
  std::uint64_t bytes_up = 0;     ///< Received from the robot, IP bytes.
  std::uint64_t bytes_down = 0;   ///< Sent to the robot, IP bytes.
  std::uint64_t frames_lost = 0;  ///< Of the robot's: never came.
  std::uint64_t frames_malformed = 0;
  std::uint32_t backlog_blocks = 0;    ///< Evidence the robot has and the server lacks.
  std::uint64_t frames_down_lost = 0;  ///< Of the server's, that asked for an answer.
  double loss_up = 0.0;                ///< [0 … 1] Share of `frames_lost`.
  double loss_down = 0.0;              ///< [0 … 1] Lately.
  double budget_down_bit_s = 0.0;      ///< What the server allows itself towards the robot.
  double queue_s = 0.0;                ///< Estimated wait on the way down beyond an idle link's.
  std::uint64_t unacknowledged_bytes = 0;  ///< Sent to the robot, no answer yet.
  TrafficJson up{};
  TrafficJson down{};
  std::optional<SpoolJson> spool{};  ///< None: the robot keeps no spool.
};

struct CommandJson {
  std::uint64_t id = 0;
  std::string kind;   ///< "goto", "stop"
  std::string state;  ///< "sent", "accepted", "refused", "superseded", "arrived", "stopped",
                      ///< "expired", "blocked"
  std::string why;
  PointJson goal;
  double to_go_m = 0.0;
  std::uint32_t revision = 0;           ///< Paths sent for this goal so far.
  std::vector<PointJson> path;          ///< As last sent.
  std::optional<double> eta_s{};        ///< Until the goal, at the speed the robot drove lately.
  std::optional<double> heading_rad{};  ///< To turn to at the goal; none: any.
};

/// What a robot is to do in all, of which a command is one leg.
struct TaskJson {
  std::uint64_t id = 0;           ///< Counts the tasks that this server was given since it started.
  std::string kind;               ///< "goto", "explore", "return"
  std::string state;              ///< "active", "done", "failed", "cancelled", "expired"
  std::string why;                ///< Also while active: what it waits for.
  std::uint64_t legs = 0;         ///< Reached so far: waypoints or frontiers.
  std::uint64_t legs_all = 0;     ///< Of one round; 0: nobody knows.
  std::uint64_t rounds = 0;       ///< Of a loop, finished.
  std::uint64_t waiting = 0;      ///< Tasks behind it in the queue.
  double expires_s = 0.0;         ///< From now; 0 at its end.
  std::optional<double> eta_s{};  ///< Until its end; not for loops and exploring.
};

struct AreaJson {
  double west_m = 0.0;
  double south_m = 0.0;
  double east_m = 0.0;
  double north_m = 0.0;
};

struct RobotJson {
  std::string id;
  std::string site;
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double yaw_rad = 0.0;
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
  double sigma_m = 0.0;
  double speed_m_s = 0.0;
  double pose_age_s = 0.0;
  std::string drive;         ///< "idle", "driving", "blocked", "stopped"
  std::string localization;  ///< "localized", "unsure", "lost"
  LinkJson link;
  std::optional<CommandJson> command;  ///< The newest command, also after its end.
  std::optional<TaskJson> task{};      ///< The newest task, also after its end.
};

struct SiteJson {
  std::string name;
  int cell_size_mm = 0;
  std::uint64_t map_version = 0;  ///< Grows with every change of the map.
  std::uint64_t tiles = 0;
  std::uint64_t known_cells = 0;
  std::uint64_t memory_bytes = 0;
  std::uint64_t submaps = 0;  ///< Evidence submaps held, all robots.
  std::uint64_t submaps_merged = 0;
  std::uint64_t commits = 0;  ///< Store transactions since the server started.
};

struct StatusReply {
  std::string version;
  double uptime_s = 0.0;
  std::vector<SiteJson> sites;
  std::vector<RobotJson> robots;
};

struct FoundRequest {
  std::string site;
  int cell_size_mm = 125;
};

struct GotoRequest {
  std::optional<std::string> robot;  ///< May be left out when there is one.
  double x_m = 0.0;
  double y_m = 0.0;
  std::string unknown = "allowed";    ///< "blocked", "allowed"
  std::string on_link_loss = "stop";  ///< "stop", "continue", "return"
  double expires_s = 600.0;           ///< [Limit: 1 … 86400] Of all of it.
  bool allow_partial = false;
  std::vector<PlaceJson> then{};        ///< Places to go to after that. [Limit: ≤ kMaxWaypoints]
  bool loop = false;                    ///< Round and round until it expires.
  bool queue = false;                   ///< After what the robot does now, instead of in its place.
  std::optional<double> heading_rad{};  ///< At (x_m, y_m), as PlaceJson's.
};

struct ExploreRequest {
  std::optional<std::string> robot;
  std::optional<AreaJson> area{};  ///< Only there.
  std::string on_link_loss = "return";
  double expires_s = 3600.0;
  bool queue = false;
};

/// To where the robot was when this server first met it.
struct ReturnRequest {
  std::optional<std::string> robot;
  std::string unknown = "allowed";
  std::string on_link_loss = "continue";
  double expires_s = 600.0;
  bool queue = false;
};

struct StopRequest {
  std::optional<std::string> robot;
};

struct CommandReply {
  std::uint64_t command = 0;
  std::string robot;
  std::string status;  ///< Of the path: "complete", "partial"; "queued": not begun yet.
  std::string why;
  double length_m = 0.0;
  double cost_m = 0.0;
  std::vector<PointJson> path;
  std::uint64_t task = 0;  ///< 0: none (a stop).
};

struct PlanRequestJson {
  std::optional<std::string> site;  ///< May be left out when there is one.
  PointJson from;
  PointJson to;
  std::string unknown = "blocked";
  bool allow_partial = false;
};

struct PlanReply {
  std::string status;  ///< "complete", "partial", "none"
  std::string why;
  double length_m = 0.0;
  double cost_m = 0.0;
  std::uint64_t map_version = 0;
  double seconds = 0.0;
  std::vector<PointJson> path;
};

struct MapRequest {
  std::optional<std::string> site;  ///< May be left out when there is one.
};

struct WatchRequest {
  int period_ms = 1000;  ///< [Limit: kMinWatchPeriodMs … kMaxWatchPeriodMs]
};

/// For methods without parameters and answers without content.
struct Empty {};

/// Head of a map transfer; `tiles` binary messages follow (API.md).
struct MapReply {
  std::string site;
  int cell_size_mm = 0;
  std::uint64_t map_version = 0;
  std::uint64_t tiles = 0;
  std::int32_t climb_mm = 0;  ///< Limits that the server plans with.
  std::int32_t descend_mm = 0;
  std::vector<RobotJson> robots;
  /// Where each robot of `robots` was while the server watched, newest last, bounded.
  std::vector<std::vector<PointJson>> tracks;
};

/// The message as JSON. Numbers must be finite: JSON has no other.
void to_json(nlohmann::json& json, const PointJson& message);
void to_json(nlohmann::json& json, const PlaceJson& message);
void to_json(nlohmann::json& json, const TrafficJson& message);
void to_json(nlohmann::json& json, const SpoolJson& message);
void to_json(nlohmann::json& json, const LinkJson& message);
void to_json(nlohmann::json& json, const CommandJson& message);
void to_json(nlohmann::json& json, const TaskJson& message);
void to_json(nlohmann::json& json, const AreaJson& message);
void to_json(nlohmann::json& json, const RobotJson& message);
void to_json(nlohmann::json& json, const SiteJson& message);
void to_json(nlohmann::json& json, const StatusReply& message);
void to_json(nlohmann::json& json, const FoundRequest& message);
void to_json(nlohmann::json& json, const GotoRequest& message);
void to_json(nlohmann::json& json, const ExploreRequest& message);
void to_json(nlohmann::json& json, const ReturnRequest& message);
void to_json(nlohmann::json& json, const StopRequest& message);
void to_json(nlohmann::json& json, const CommandReply& message);
void to_json(nlohmann::json& json, const PlanRequestJson& message);
void to_json(nlohmann::json& json, const PlanReply& message);
void to_json(nlohmann::json& json, const MapRequest& message);
void to_json(nlohmann::json& json, const WatchRequest& message);
void to_json(nlohmann::json& json, const Empty& message);
void to_json(nlohmann::json& json, const MapReply& message);

/// The message that `json` holds, for each struct above: `auto request =
/// from_json<GotoRequest>(j)`. Strict: an unknown or missing key, a wrong type and a value out of
/// its limits give invalid_argument with the key's path and what is expected there ("from.x_m:
/// expected a number from -100000 to 100000"). Keys of requests that have a default may be left
/// out.
template <class T>
[[nodiscard]] Result<T> from_json(const nlohmann::json& json);

}  // namespace cairn::api
