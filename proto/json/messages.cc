#include "proto/json/messages.h"

#include <array>
#include <numbers>
#include <string_view>

#include "proto/json/fields.h"

namespace cairn::api {

namespace {

using namespace std::string_view_literals;

constexpr std::array kUnknown = {"blocked"sv, "allowed"sv};
constexpr std::array kOnLinkLoss = {"stop"sv, "continue"sv, "return"sv};
constexpr std::array kKinds = {"goto"sv, "stop"sv};
constexpr std::array kTaskKinds = {"goto"sv, "explore"sv, "return"sv};
constexpr std::array kTaskStates = {"active"sv, "done"sv, "failed"sv, "cancelled"sv, "expired"sv};
constexpr std::array kStates = {"sent"sv,    "accepted"sv, "refused"sv, "superseded"sv,
                                "arrived"sv, "stopped"sv,  "expired"sv, "blocked"sv};
constexpr std::array kLocalizations = {"localized"sv, "unsure"sv, "lost"sv};
constexpr std::array kSpoolStates = {"ok"sv, "failed"sv};
constexpr std::array kDrives = {"idle"sv, "driving"sv, "blocked"sv, "stopped"sv};
constexpr std::array kPathStatuses = {"complete"sv, "partial"sv, "none"sv};

constexpr Rule kCoordinate{.lowest = -kMaxCoordinateM, .highest = kMaxCoordinateM};
constexpr Rule kAngle{.lowest = -2.0 * std::numbers::pi, .highest = 2.0 * std::numbers::pi};
constexpr Rule kNotNegative{.lowest = 0.0};
constexpr Rule kCount{.lowest = 0.0};
constexpr Rule kShare{.lowest = 0.0, .highest = 1.0};
constexpr Rule kName{.max_size = kMaxNameChars, .name = true};
constexpr Rule kText{.max_size = 1024};
constexpr Rule kExpiry{.lowest = 1.0, .highest = 86'400.0};
constexpr Rule kCellSize{.lowest = 10.0, .highest = 2000.0};

Rule one_of(std::span<const std::string_view> choices) { return Rule{.choices = choices}; }
Rule list_of(std::size_t max_size) { return Rule{.max_size = max_size}; }

}  // namespace

// One description per message: a visitor reads or writes it. `M` is the message, const or not.

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, PointJson>
void describe(V& v, M& m) {
  v.required("x_m", m.x_m, kCoordinate);
  v.required("y_m", m.y_m, kCoordinate);
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, PlaceJson>
void describe(V& v, M& m) {
  v.required("x_m", m.x_m, kCoordinate);
  v.required("y_m", m.y_m, kCoordinate);
  v.optional("heading_rad", m.heading_rad, kAngle);
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, TrafficJson>
void describe(V& v, M& m) {
  v.required("control_bytes", m.control_bytes, kCount);
  v.required("pose_bytes", m.pose_bytes, kCount);
  v.required("map_bytes", m.map_bytes, kCount);
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, SpoolJson>
void describe(V& v, M& m) {
  v.required("state", m.state, one_of(kSpoolStates));
  v.required("submaps", m.submaps, kCount);
  v.required("bytes", m.bytes, kCount);
  v.required("thinned", m.thinned, kCount);
  v.required("dropped", m.dropped, kCount);
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, LinkJson>
void describe(V& v, M& m) {
  v.required("connected", m.connected);
  v.required("silence_s", m.silence_s, kNotNegative);
  v.required("round_trip_s", m.round_trip_s, kNotNegative);
  v.required("bytes_up", m.bytes_up, kCount);
  v.required("bytes_down", m.bytes_down, kCount);
  v.required("frames_lost", m.frames_lost, kCount);
  v.required("frames_down_lost", m.frames_down_lost, kCount);
  v.required("loss_up", m.loss_up, kShare);
  v.required("loss_down", m.loss_down, kShare);
  v.required("budget_down_bit_s", m.budget_down_bit_s, kNotNegative);
  v.required("queue_s", m.queue_s, kNotNegative);
  v.required("unacknowledged_bytes", m.unacknowledged_bytes, kCount);
  v.required("up", m.up);
  v.required("down", m.down);
  v.required("frames_malformed", m.frames_malformed, kCount);
  v.required("backlog_blocks", m.backlog_blocks, kCount);
  v.optional("spool", m.spool);
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, CommandJson>
void describe(V& v, M& m) {
  v.required("id", m.id, kCount);
  v.required("kind", m.kind, one_of(kKinds));
  v.required("state", m.state, one_of(kStates));
  v.required("why", m.why, kText);
  v.required("goal", m.goal);
  v.required("to_go_m", m.to_go_m, kNotNegative);
  v.required("revision", m.revision, kCount);
  v.required("path", m.path, list_of(kMaxPathPoints));
  v.optional("eta_s", m.eta_s, kNotNegative);
  v.optional("heading_rad", m.heading_rad, kAngle);
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, TaskJson>
void describe(V& v, M& m) {
  v.required("id", m.id, kCount);
  v.required("kind", m.kind, one_of(kTaskKinds));
  v.required("state", m.state, one_of(kTaskStates));
  v.required("why", m.why, kText);
  v.required("legs", m.legs, kCount);
  v.required("legs_all", m.legs_all, kCount);
  v.required("rounds", m.rounds, kCount);
  v.required("waiting", m.waiting, kCount);
  v.required("expires_s", m.expires_s, kNotNegative);
  v.optional("eta_s", m.eta_s, kNotNegative);
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, AreaJson>
void describe(V& v, M& m) {
  v.required("west_m", m.west_m, kCoordinate);
  v.required("south_m", m.south_m, kCoordinate);
  v.required("east_m", m.east_m, kCoordinate);
  v.required("north_m", m.north_m, kCoordinate);
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, RobotJson>
void describe(V& v, M& m) {
  v.required("id", m.id, kName);
  v.required("site", m.site, kName);
  v.required("x_m", m.x_m, kCoordinate);
  v.required("y_m", m.y_m, kCoordinate);
  v.required("z_m", m.z_m, kCoordinate);
  v.required("yaw_rad", m.yaw_rad, kAngle);
  v.required("roll_rad", m.roll_rad, kAngle);
  v.required("pitch_rad", m.pitch_rad, kAngle);
  v.required("sigma_m", m.sigma_m, kNotNegative);
  v.required("speed_m_s", m.speed_m_s);
  v.required("pose_age_s", m.pose_age_s, kNotNegative);
  v.required("drive", m.drive, one_of(kDrives));
  v.required("localization", m.localization, one_of(kLocalizations));
  v.required("link", m.link);
  v.optional("command", m.command);
  v.optional("task", m.task);
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, SiteJson>
void describe(V& v, M& m) {
  v.required("name", m.name, kName);
  v.required("cell_size_mm", m.cell_size_mm, kCellSize);
  v.required("map_version", m.map_version, kCount);
  v.required("tiles", m.tiles, kCount);
  v.required("known_cells", m.known_cells, kCount);
  v.required("memory_bytes", m.memory_bytes, kCount);
  v.required("submaps", m.submaps, kCount);
  v.required("submaps_merged", m.submaps_merged, kCount);
  v.required("commits", m.commits, kCount);
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, StatusReply>
void describe(V& v, M& m) {
  v.required("version", m.version, kText);
  v.required("uptime_s", m.uptime_s, kNotNegative);
  v.required("sites", m.sites, list_of(kMaxSites));
  v.required("robots", m.robots, list_of(kMaxRobots));
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, FoundRequest>
void describe(V& v, M& m) {
  v.required("site", m.site, kName);
  v.defaulted("cell_size_mm", m.cell_size_mm, kCellSize);
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, GotoRequest>
void describe(V& v, M& m) {
  v.optional("robot", m.robot, kName);
  v.required("x_m", m.x_m, kCoordinate);
  v.required("y_m", m.y_m, kCoordinate);
  v.optional("heading_rad", m.heading_rad, kAngle);
  v.defaulted("unknown", m.unknown, one_of(kUnknown));
  v.defaulted("on_link_loss", m.on_link_loss, one_of(kOnLinkLoss));
  v.defaulted("expires_s", m.expires_s, kExpiry);
  v.defaulted("allow_partial", m.allow_partial);
  v.defaulted("then", m.then, list_of(kMaxWaypoints));
  v.defaulted("loop", m.loop);
  v.defaulted("queue", m.queue);
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, ExploreRequest>
void describe(V& v, M& m) {
  v.optional("robot", m.robot, kName);
  v.optional("area", m.area);
  v.defaulted("on_link_loss", m.on_link_loss, one_of(kOnLinkLoss));
  v.defaulted("expires_s", m.expires_s, kExpiry);
  v.defaulted("queue", m.queue);
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, ReturnRequest>
void describe(V& v, M& m) {
  v.optional("robot", m.robot, kName);
  v.defaulted("unknown", m.unknown, one_of(kUnknown));
  v.defaulted("on_link_loss", m.on_link_loss, one_of(kOnLinkLoss));
  v.defaulted("expires_s", m.expires_s, kExpiry);
  v.defaulted("queue", m.queue);
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, StopRequest>
void describe(V& v, M& m) { v.optional("robot", m.robot, kName); }

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, CommandReply>
void describe(V& v, M& m) {
  v.required("command", m.command, kCount);
  v.required("robot", m.robot, kName);
  v.required("status", m.status, kText);
  v.required("why", m.why, kText);
  v.required("length_m", m.length_m, kNotNegative);
  v.required("cost_m", m.cost_m, kNotNegative);
  v.required("path", m.path, list_of(kMaxPathPoints));
  v.defaulted("task", m.task, kCount);
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, PlanRequestJson>
void describe(V& v, M& m) {
  v.optional("site", m.site, kName);
  v.required("from", m.from);
  v.required("to", m.to);
  v.defaulted("unknown", m.unknown, one_of(kUnknown));
  v.defaulted("allow_partial", m.allow_partial);
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, PlanReply>
void describe(V& v, M& m) {
  v.required("status", m.status, one_of(kPathStatuses));
  v.required("why", m.why, kText);
  v.required("length_m", m.length_m, kNotNegative);
  v.required("cost_m", m.cost_m, kNotNegative);
  v.required("map_version", m.map_version, kCount);
  v.required("seconds", m.seconds, kNotNegative);
  v.required("path", m.path, list_of(kMaxPathPoints));
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, MapRequest>
void describe(V& v, M& m) { v.optional("site", m.site, kName); }

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, WatchRequest>
void describe(V& v, M& m) {
  v.defaulted("period_ms", m.period_ms,
              Rule{.lowest = kMinWatchPeriodMs, .highest = kMaxWatchPeriodMs});
}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, Empty>
void describe(V& /*v*/, M& /*m*/) {}

template <class V, class M>
requires std::same_as<std::remove_const_t<M>, MapReply>
void describe(V& v, M& m) {
  v.required("site", m.site, kName);
  v.required("cell_size_mm", m.cell_size_mm, kCellSize);
  v.required("map_version", m.map_version, kCount);
  v.required("tiles", m.tiles, kCount);
  v.required("climb_mm", m.climb_mm, kCount);
  v.required("descend_mm", m.descend_mm, kCount);
  v.required("robots", m.robots, list_of(kMaxRobots));
  v.required("tracks", m.tracks, list_of(kMaxTrackPoints));
}

template <class T>
Result<T> from_json(const nlohmann::json& json) {
  T message;
  std::string fault;
  FieldReader reader(json, "", fault);
  describe(reader, message);
  reader.refuse_unknown_keys();
  if (!fault.empty()) return Error{ErrorCode::invalid_argument, fault};
  return message;
}

template <class T>
static void write(nlohmann::json& json, const T& message) {
  FieldWriter writer(json);
  describe(writer, message);
}

#define CAIRN_MESSAGE(T)                                                         \
  void to_json(nlohmann::json& json, const T& message) { write(json, message); } \
  template Result<T> from_json<T>(const nlohmann::json& json);

CAIRN_MESSAGE(PointJson)
CAIRN_MESSAGE(PlaceJson)
CAIRN_MESSAGE(TrafficJson)
CAIRN_MESSAGE(SpoolJson)
CAIRN_MESSAGE(LinkJson)
CAIRN_MESSAGE(CommandJson)
CAIRN_MESSAGE(TaskJson)
CAIRN_MESSAGE(AreaJson)
CAIRN_MESSAGE(RobotJson)
CAIRN_MESSAGE(SiteJson)
CAIRN_MESSAGE(StatusReply)
CAIRN_MESSAGE(FoundRequest)
CAIRN_MESSAGE(GotoRequest)
CAIRN_MESSAGE(ExploreRequest)
CAIRN_MESSAGE(ReturnRequest)
CAIRN_MESSAGE(StopRequest)
CAIRN_MESSAGE(CommandReply)
CAIRN_MESSAGE(PlanRequestJson)
CAIRN_MESSAGE(PlanReply)
CAIRN_MESSAGE(MapRequest)
CAIRN_MESSAGE(WatchRequest)
CAIRN_MESSAGE(Empty)
CAIRN_MESSAGE(MapReply)

#undef CAIRN_MESSAGE

}  // namespace cairn::api
