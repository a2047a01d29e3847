#include "client/cli/offline_options.h"

#include <array>
#include <charconv>
#include <cmath>

namespace cairn::cli {

namespace {

constexpr const char* kStoreHelp =
    "A site's store (NAME.cairn of a server's data folder); without one the server is asked";

/// "X,Y" or "X,Y,Z"; nothing when it is neither.
std::optional<std::array<double, 3>> parse_origin(const std::string& text) {
  std::array<double, 3> origin{};
  std::size_t at = 0;
  for (std::size_t i = 0; i < origin.size(); ++i) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const auto [parsed, fault] = std::from_chars(text.data() + at, text.data() + end, origin[i]);
    const bool whole = fault == std::errc() && parsed == text.data() + end;
    if (!whole || !(std::abs(origin[i]) <= api::kMaxCoordinateM)) return {};
    if (end == text.size()) return i >= 1 ? std::optional(origin) : std::nullopt;
    at = end + 1;
  }
  return {};
}

void add_limits(CLI::App& sub, OfflineOptions& options) {
  sub.add_option("--climb", options.climb_m, "Highest step the robot climbs [m]")
      ->check(CLI::Range(0.0, 2.0))
      ->capture_default_str();
  sub.add_option("--descend", options.descend_m, "Deepest step it goes down [m]")
      ->check(CLI::Range(0.0, 2.0))
      ->capture_default_str();
}

CLI::App* add(CLI::App& map, const std::string& name, const std::string& what,
              const std::string& examples) {
  auto* sub = map.add_subcommand(name, what);
  sub->fallthrough();
  sub->footer("Examples:\n" + examples);
  return sub;
}

VehicleLimits limits_of(const OfflineOptions& options, double default_radius_m) {
  const auto mm = [](double m) { return static_cast<std::int32_t>(std::lround(m * 1000.0)); };
  return {mm(options.climb_m), mm(options.descend_m), options.radius_m.value_or(default_radius_m)};
}

void add_import(CLI::App& map, OfflineOptions& options) {
  auto* sub =
      add(map, "import", "Lay a map file into a site's store, which is founded if it is missing",
          "  cairn map import floor.yaml --site floor.cairn        ROS map_server (with its .pgm)\n"
          "  cairn map import arena.map --site arena.cairn --cell-size 0.5\n"
          "  cairn map import terrain.tif --site hills.cairn --origin -100,-100\n"
          "Also .asc (Esri ASCII grid) and .csv (rows of heights in metres). The server must not\n"
          "be running on the store.");
  auto& request = options.import.request;
  sub->add_option("FILE", request.map_file, "The map: .map .yaml .pgm .asc .csv .tif")->required();
  sub->add_option("--site", request.store, "The store")->required();
  sub->add_option_function<std::string>(
      "--name", [&request](const std::string& name) { request.name = name; },
      "Name of a new site (default: as the store's file)");
  sub->add_option_function<double>(
         "--cell-size", [&request](double cell_m) { request.cell_m = cell_m; },
         "Size of the file's cells [m], where it does not tell (.map: 1)")
      ->check(CLI::Range(0.001, 1000.0));
  sub->add_option("--origin", options.origin,
                  "Where the file's south-west corner lies in the site: X,Y or X,Y,Z [m]")
      ->check([](const std::string& text) {
        return parse_origin(text) ? "" : "\"" + text + "\" is no place: expected X,Y or X,Y,Z";
      });
}

}  // namespace

void add_offline_map(CLI::App& map, OfflineOptions& options) {
  map.require_subcommand(0, 1);
  map.add_option("SITE", options.store, kStoreHelp);
  add_import(map, options);
  auto* out = add(map, "export", "Write a store's ground as a file of another program",
                  "  cairn map export yard.cairn yard.yaml     with yard.pgm, for ROS\n"
                  "  cairn map export yard.cairn yard.tif      GeoTIFF; also .asc .csv .map .ply");
  out->add_option("SITE", options.export_store, "The store")->required();
  out->add_option("FILE", options.export_file, "File to write; its ending names the kind")
      ->required();
  add_limits(*out, options);
  auto* info = add(map, "info", "Tell what a store holds",
                   "  cairn map info yard.cairn\n  cairn map info yard.cairn --json");
  info->add_option("SITE", options.info_store, "The store")->required();
}

void add_offline_plan(CLI::App& plan, OfflineOptions& options) {
  auto* store = plan.add_option("SITE", options.store, kStoreHelp);
  plan.add_option_function<std::string>(
          "--scen", [&options](const std::string& file) { options.scenarios = file; },
          "On a store: plan every problem of this Moving AI file")
      ->needs(store)
      ->excludes("--from")
      ->excludes("--to")
      ->excludes("--png");
  plan.add_option_function<double>(
          "--radius", [&options](double radius_m) { options.radius_m = radius_m; },
          "On a store: room the robot needs around its middle [m] (default 0.5; 0 with --scen)")
      ->check(CLI::Range(0.0, 10.0))
      ->needs(store);
  add_limits(plan, options);
  for (const char* limit : {"--climb", "--descend"}) plan.get_option(limit)->needs(store);
}

Command map_command(const CLI::App& map, const MapCommand& online, const OfflineOptions& options) {
  if (!map.get_subcommands().empty()) {
    if (!options.store.empty()) throw CLI::ExtrasError({options.store});
    if (map.got_subcommand("info")) return InfoCommand{options.info_store};
    if (map.got_subcommand("export")) {
      return ExportCommand{options.export_store, options.export_file, limits_of(options, 0.0)};
    }
    ImportCommand import = options.import;
    if (!options.origin.empty()) import.request.origin_m = parse_origin(options.origin);
    return import;
  }
  if (online.png.empty()) throw CLI::RequiredError("--png, import, export or info");
  if (options.store.empty()) return online;
  if (online.site) throw CLI::ExcludesError("SITE", "--site");
  return DrawStoreCommand{options.store, online.png, online.scale};
}

Command plan_command(const PlanCommand& online, const OfflineOptions& options) {
  if (options.store.empty()) return online;
  if (online.request.site) throw CLI::ExcludesError("SITE", "--site");
  if (options.scenarios) {
    return ScenariosCommand{options.store, *options.scenarios, limits_of(options, 0.0),
                            online.request.unknown};
  }
  return PlanOnStoreCommand{options.store, online, limits_of(options, VehicleLimits{}.radius_m)};
}

}  // namespace cairn::cli
