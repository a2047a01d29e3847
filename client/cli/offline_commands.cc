#include "client/cli/offline_commands.h"

#include <chrono>
#include <string>
#include <utility>

#include "client/cli/format.h"
#include "client/cli/map_picture.h"
#include "client/cli/offline_format.h"
#include "client/offline/export.h"
#include "client/offline/import.h"
#include "client/offline/scenarios.h"
#include "core/planner/plan.h"
#include "proto/json/envelope.h"
#include "server/mission/planning.h"

namespace cairn::cli {

namespace {

/// Writes an answer as JSON or as text for people.
int answer(bool json, const Terminal& terminal, const nlohmann::json& message,
           const std::string& text) {
  terminal.out << (json ? api::to_text(message) + '\n' : text);
  return kExitOk;
}

PlannerConfig planner_of(const VehicleLimits& limits, const std::string& unknown) {
  PlannerConfig config;
  config.limits = limits;
  config.unknown = unknown == "allowed" ? UnknownGround::allowed : UnknownGround::blocked;
  return config;
}

/// The map as a server would send it.
Result<SiteMap> map_of(const offline::OpenSite& site, const VehicleLimits& limits) {
  const auto snapshot = site.world->snapshot();
  if (snapshot->tiles.size() > kMaxDrawnTiles) {
    return Error{ErrorCode::exhausted, "the site has " + std::to_string(snapshot->tiles.size()) +
                                           " tiles, more than the " +
                                           std::to_string(kMaxDrawnTiles) + " that are drawn"};
  }
  SiteMap map;
  map.head.site = site.world->site().name;
  map.head.cell_size_mm = snapshot->cell_size_mm;
  map.head.map_version = snapshot->version;
  map.head.tiles = snapshot->tiles.size();
  map.head.climb_mm = limits.climb_mm;
  map.head.descend_mm = limits.descend_mm;
  map.tiles.reserve(snapshot->tiles.size());
  for (const auto& [key, tile] : snapshot->tiles) map.tiles.emplace_back(key, tile->unpack());
  return map;
}

Result<cv::Size> draw(const offline::OpenSite& site, const VehicleLimits& limits,
                      const PictureOptions& options, const std::string& file) {
  const auto map = map_of(site, limits);
  if (!map) return map.error();
  const auto picture = draw_map(*map, options);
  if (!picture) return picture.error();
  if (const auto written = write_png(*picture, file); !written) return written.error();
  return picture->size();
}

api::PlanReply reply_of(const Path& path, std::uint64_t map_version, double seconds) {
  static constexpr const char* kStatus[] = {"complete", "partial", "none"};
  api::PlanReply reply;
  reply.status = kStatus[static_cast<std::size_t>(path.status)];
  reply.why = path.why;
  reply.length_m = path.length_m;
  reply.cost_m = path.cost_m;
  reply.map_version = map_version;
  reply.seconds = seconds;
  for (const Eigen::Vector2d& point : path.points_m) reply.path.push_back({point.x(), point.y()});
  return reply;
}

Result<api::PlanReply> plan_on(const offline::OpenSite& site, const PlanOnStoreCommand& command) {
  const auto began = std::chrono::steady_clock::now();
  const auto& asked = command.plan.request;
  const PlannerConfig config = planner_of(command.limits, asked.unknown);
  PlanRequest request;
  request.start_m = {asked.from.x_m, asked.from.y_m};
  request.goal_m = {asked.to.x_m, asked.to.y_m};
  request.allow_partial = asked.allow_partial;
  const auto map = site.world->snapshot();
  const auto grid = server::drivable_grid(*map, {request.start_m, request.goal_m}, config,
                                          SensorModel{}.min_probability);
  if (!grid) return grid.error();
  const Path path = plan(*grid, request, config);
  const auto spent = std::chrono::steady_clock::now() - began;
  return reply_of(path, map->version, std::chrono::duration<double>(spent).count());
}

}  // namespace

Result<int> run(const ImportCommand& command, bool json, const Terminal& terminal) {
  const auto report = offline::import_map(command.request);
  if (!report) return report.error();
  return answer(json, terminal, import_json(*report), import_text(*report, command.request));
}

Result<int> run(const ExportCommand& command, bool json, const Terminal& terminal) {
  const auto site = offline::open_site(command.store);
  if (!site) return site.error();
  const auto report = offline::export_map(*site, command.file, command.limits);
  if (!report) return report.error();
  return answer(json, terminal, export_json(*report, command.file),
                export_text(*report, command.file));
}

Result<int> run(const InfoCommand& command, bool json, const Terminal& terminal) {
  const auto site = offline::open_site(command.store);
  if (!site) return site.error();
  const offline::SiteFacts facts = offline::facts_of(*site);
  return answer(json, terminal, facts_json(facts), facts_text(facts));
}

Result<int> run(const DrawStoreCommand& command, bool json, const Terminal& terminal) {
  const auto site = offline::open_site(command.store);
  if (!site) return site.error();
  const auto size =
      draw(*site, VehicleLimits{}, {.scale = command.scale, .path = {}, .goal = {}}, command.png);
  if (!size) return size.error();
  return answer(json, terminal,
                {{"png", command.png}, {"width", size->width}, {"height", size->height}},
                "drew " + command.png + ": " + std::to_string(size->width) + " x " +
                    std::to_string(size->height) + " pixels\n");
}

Result<int> run(const PlanOnStoreCommand& command, bool json, const Terminal& terminal) {
  const auto site = offline::open_site(command.store);
  if (!site) return site.error();
  const auto reply = plan_on(*site, command);
  if (!reply) return reply.error();
  answer(json, terminal, nlohmann::json(*reply), plan_text(*reply));
  if (!command.plan.png.empty()) {
    const PictureOptions options{.scale = 0, .path = reply->path, .goal = command.plan.request.to};
    if (const auto drawn = draw(*site, command.limits, options, command.plan.png); !drawn) {
      return drawn.error();
    }
  }
  return reply->status == "none" ? kExitFailed : kExitOk;
}

Result<int> run(const ScenariosCommand& command, bool json, const Terminal& terminal) {
  const auto scenarios = offline::read_scenarios(command.file);
  if (!scenarios) return scenarios.error();
  const auto site = offline::open_site(command.store);
  if (!site) return site.error();
  const auto report =
      offline::run_scenarios(*site, *scenarios, planner_of(command.limits, command.unknown));
  if (!report) return report.error();
  answer(json, terminal, scenarios_json(*report), scenarios_text(*report));
  return report->good() ? kExitOk : kExitFailed;
}

}  // namespace cairn::cli
