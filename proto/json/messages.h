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

struct PointJson {
  double x_m = 0.0;
  double y_m = 0.0;
};

struct LinkJson {
  bool connected = false;
  double silence_s = 0.0;  ///< Since the robot's last frame.
  double round_trip_s = 0.0;
  std::uint64_t bytes_up = 0;    ///< Received from the robot, IP bytes.
  std::uint64_t bytes_down = 0;  ///< Sent to the robot, IP bytes.
  std::uint64_t frames_lost = 0;
  std::uint64_t frames_malformed = 0;
  std::uint32_t backlog_blocks = 0;  ///< Evidence the robot has and the server lacks.
};

struct CommandJson {
  std::uint64_t id = 0;
  std::string kind;   ///< "goto", "stop"
  std::string state;  ///< "sent", "accepted", "refused", "superseded", "arrived", "stopped",
                      ///< "expired", "blocked"
  std::string why;
  PointJson goal;
  double to_go_m = 0.0;
  std::uint32_t revision = 0;   ///< Paths sent for this goal so far.
  std::vector<PointJson> path;  ///< As last sent.
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
  std::string drive;  ///< "idle", "driving", "blocked", "stopped"
  LinkJson link;
  std::optional<CommandJson> command;  ///< The newest command, also after its end.
};

struct SiteJson {
  std::string name;
  int cell_size_mm = 0;
  std::uint64_t map_version = 0;  ///< Grows with every change of the map.
  std::uint64_t tiles = 0;
  std::uint64_t known_cells = 0;
  std::uint64_t memory_bytes = 0;
  std::uint64_t submaps = 0;          ///< Evidence submaps held, all robots.
  std::uint64_t submaps_merged = 0;
  std::uint64_t commits = 0;          ///< Store transactions since the server started.
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
  std::string unknown = "allowed";      ///< "blocked", "allowed"
  std::string on_link_loss = "stop";    ///< "stop", "continue"
  double expires_s = 600.0;             ///< [Limit: 1 … 86400]
  bool allow_partial = false;
};

struct StopRequest {
  std::optional<std::string> robot;
};

struct CommandReply {
  std::uint64_t command = 0;
  std::string robot;
  std::string status;  ///< Of the path: "complete", "partial"
  std::string why;
  double length_m = 0.0;
  double cost_m = 0.0;
  std::vector<PointJson> path;
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

/// Head of a map transfer; `tiles` binary messages follow (API.md).
struct MapReply {
  std::string site;
  int cell_size_mm = 0;
  std::uint64_t map_version = 0;
  std::uint64_t tiles = 0;
  std::int32_t climb_mm = 0;    ///< Limits that the server plans with.
  std::int32_t descend_mm = 0;
  std::vector<RobotJson> robots;
  /// Where each robot of `robots` was while the server watched, newest last, bounded.
  std::vector<std::vector<PointJson>> tracks;
};

}  // namespace cairn::api
