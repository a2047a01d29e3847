#include "client/cli/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <utility>

#include "client/cli/offline_options.h"
#include "core/common/angle.h"

namespace cairn::cli {

namespace {

constexpr double kMostHeadingDeg = 360.0;

template <class T>
bool read_whole(std::string_view text, T& value) {
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  return fault == std::errc() && end == text.data() + text.size() && !text.empty();
}

bool read_coordinate(std::string_view text, double& value) {
  if (text.starts_with('+')) text.remove_prefix(1);
  return read_whole(text, value) && std::isfinite(value) && std::abs(value) <= api::kMaxCoordinateM;
}

bool read_heading(std::string_view text, double& value_deg) {
  if (text.starts_with('+')) text.remove_prefix(1);
  return read_whole(text, value_deg) && std::abs(value_deg) <= kMostHeadingDeg;
}

/// "X,Y" or "X,Y,HEADING_DEG".
Result<api::PlaceJson> parse_place(const std::string& text) {
  const auto first = text.find(',');
  const auto second = first == std::string::npos ? first : text.find(',', first + 1);
  const auto point = parse_point(text.substr(0, second));
  if (!point) return point.error();
  api::PlaceJson place{point->x_m, point->y_m, {}};
  if (second == std::string::npos) return place;
  double heading_deg = 0.0;
  if (!read_heading(std::string_view(text).substr(second + 1), heading_deg)) {
    return Error{ErrorCode::invalid_argument,
                 "\"" + text +
                     "\" has no sound heading: expected X,Y,DEGREES with -360 to 360, 0 " +
                     "east and 90 north, as -3,2.5,90"};
  }
  place.heading_rad = radians(heading_deg);
  return place;
}

/// CLI11 validators answer with the fault's text, empty when there is none.
std::string check_point(const std::string& text) {
  const auto point = parse_point(text);
  return point ? "" : point.error().message;
}
std::string check_server(const std::string& text) {
  const auto address = parse_server(text);
  return address ? "" : address.error().message;
}

/// "W,S,E,N".
std::optional<api::AreaJson> parse_area(const std::string& text) {
  std::array<double, 4> sides{};
  std::string_view rest = text;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const std::size_t end = std::min(rest.find(','), rest.size());
    if (!read_coordinate(rest.substr(0, end), sides[i])) return {};
    if ((end == rest.size()) != (i + 1 == sides.size())) return {};
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  if (sides[0] >= sides[2] || sides[1] >= sides[3]) return {};
  return api::AreaJson{sides[0], sides[1], sides[2], sides[3]};
}

/// What CLI11 fills in; turned into an Invocation when all of it is sound.
struct Typed {
  std::string server = "127.0.0.1:8642";
  Invocation invocation;
  FoundCommand found;
  GotoCommand go_to;
  StopCommand stop;
  MapCommand map;
  PlanCommand plan;
  OfflineOptions offline;
  ExploreCommand explore;
  ReturnCommand go_home;
  std::vector<std::string> places;
  std::string area;
  std::string from;
  std::string to;
};

CLI::App* add(CLI::App& app, const std::string& name, const std::string& what,
              const std::string& examples) {
  auto* sub = app.add_subcommand(name, what);
  sub->fallthrough();
  sub->footer("Examples:\n" + examples);
  return sub;
}

void add_unknown(CLI::App& sub, std::string& unknown) {
  sub.add_option("--unknown", unknown, "May the path cross what nobody has seen?")
      ->check(CLI::IsMember({"allowed", "blocked"}))
      ->capture_default_str();
}

template <class T>
void add_optional(CLI::App& sub, const std::string& name, std::optional<T>& value,
                  const std::string& what) {
  sub.add_option_function<T>(
      name, [&value](const T& given) { value = given; }, what);
}

void add_robot(CLI::App& sub, std::optional<std::string>& robot) {
  add_optional(sub, "--robot", robot, "Which robot (may be left out when there is one)");
}

/// What every task can be told.
template <class Request>
void add_task_options(CLI::App& sub, Request& request, bool& follow) {
  sub.add_option("--on-link-loss", request.on_link_loss,
                 "When the link is lost: stop there, continue, or return along the way it came")
      ->check(CLI::IsMember({"stop", "continue", "return"}))
      ->capture_default_str();
  sub.add_option("--expires", request.expires_s, "The robot stops after this [s]")
      ->check(CLI::Range(1.0, 86400.0))
      ->capture_default_str();
  sub.add_flag("--queue", request.queue, "After what the robot does now, not in its place");
  sub.add_flag("--follow", follow, "Show progress until the robot is done or gives up");
}

std::string check_area(const std::string& text) {
  return parse_area(text) ? "" : "\"" + text + "\" is no area: expected WEST,SOUTH,EAST,NORTH [m]";
}

void add_goto(CLI::App& app, Typed& typed) {
  auto* sub =
      add(app, "goto", "Send a robot to a place or along several (metres east and north)",
          "  cairn goto 12.5 -3                 returns once the command is sent\n"
          "  cairn goto 12.5 -3 --follow        shows the way there; exit 0 = arrived\n"
          "  cairn goto 12.5,-3,90 --follow     and turn to 90 degrees there (0 east, 90 north)\n"
          "  cairn goto r2 12,-3 20,4 0,0       one place after the other\n"
          "  cairn goto 12,-3 20,4 --loop --expires 3600    a patrol\n"
          "  cairn goto 80 40 --robot r2 --unknown blocked --on-link-loss return");
  auto& request = typed.go_to.request;
  sub->add_option("PLACE", typed.places,
                  "X Y, or [ROBOT] X,Y[,HEADING_DEG] [X,Y[,HEADING_DEG] ...]")
      ->required();
  add_robot(*sub, request.robot);
  add_unknown(*sub, request.unknown);
  sub->add_flag("--partial", request.allow_partial, "Go as near as possible when there is no way");
  sub->add_flag("--loop", request.loop, "Round and round until it expires or is stopped");
  add_task_options(*sub, request, typed.go_to.follow);
}

void add_explore(CLI::App& app, Typed& typed) {
  auto* sub = add(app, "explore", "Let a robot map all that it can reach",
                  "  cairn explore\n"
                  "  cairn explore r2 --area 0,0,20,15 --follow");
  auto& request = typed.explore.request;
  add_optional(*sub, "ROBOT,--robot", request.robot,
               "Which robot (may be left out when there is one)");
  sub->add_option("--area", typed.area, "Only there: WEST,SOUTH,EAST,NORTH [m]")->check(check_area);
  add_task_options(*sub, request, typed.explore.follow);
}

void add_return(CLI::App& app, Typed& typed) {
  auto* sub = add(app, "return", "Send a robot back to where it began",
                  "  cairn return\n  cairn return r2 --follow");
  auto& request = typed.go_home.request;
  add_optional(*sub, "ROBOT,--robot", request.robot,
               "Which robot (may be left out when there is one)");
  add_unknown(*sub, request.unknown);
  add_task_options(*sub, request, typed.go_home.follow);
}

void add_plan(CLI::App& app, Typed& typed) {
  auto* sub = add(app, "plan", "Plan a path without driving it, on a server's map or a store",
                  "  cairn plan --from 0,0 --to -12.5,3\n"
                  "  cairn plan --from 0,0 --to 80,40 --unknown allowed --png plan.png\n"
                  "  cairn plan yard.cairn --from 0,0 --to 80,40 --json     no server needed\n"
                  "  cairn plan arena.cairn --scen arena.map.scen --json    all of a benchmark");
  auto& request = typed.plan.request;
  sub->add_option("--from", typed.from, "Start X,Y [m]")->check(check_point);
  sub->add_option("--to", typed.to, "Goal X,Y [m]")->check(check_point);
  add_optional(*sub, "--site", request.site, "Which site (may be left out when there is one)");
  add_unknown(*sub, request.unknown);
  sub->add_flag("--partial", request.allow_partial,
                "Plan as near as possible when there is no way");
  sub->add_option("--png", typed.plan.png, "Draw the map with the path into this file");
  add_offline_plan(*sub, typed.offline);
}

void add_map(CLI::App& app, Typed& typed) {
  auto* map = add(app, "map", "Draw a site's map; import, export or describe a store",
                  "  cairn map --png yard.png\n"
                  "  cairn map --png hall.png --site hall --scale 12\n"
                  "  cairn map yard.cairn --png yard.png        a store, no server needed\n"
                  "  cairn map import floor.yaml --site floor.cairn\n"
                  "  cairn map export yard.cairn yard.tif\n"
                  "  cairn map info yard.cairn --json");
  map->add_option("--png", typed.map.png, "File to write");
  add_optional(*map, "--site", typed.map.site, "Which site (may be left out when there is one)");
  map->add_option("--scale", typed.map.scale, "Pixels per cell (default: by the map's size)")
      ->check(CLI::Range(1, 64));
  add_offline_map(*map, typed.offline);
}

void add_subcommands(CLI::App& app, Typed& typed) {
  add(app, "status", "Show the server's sites and robots",
      "  cairn status\n  cairn status --json | jq '.robots[].link'");
  auto* found = add(app, "found", "Found a site: its map's name and cell size",
                    "  cairn found yard\n  cairn found hall --cell-mm 50");
  found->add_option("NAME", typed.found.request.site, "a-z, 0-9, _ and -, at most 32")->required();
  found->add_option("--cell-mm", typed.found.request.cell_size_mm, "Size of a cell [mm]")
      ->check(CLI::Range(10, 2000))
      ->capture_default_str();
  add_goto(app, typed);
  add_explore(app, typed);
  add_return(app, typed);
  auto* stop =
      add(app, "stop", "Stop a robot where it is", "  cairn stop\n  cairn stop --robot r2");
  add_optional(*stop, "--robot", typed.stop.request.robot,
               "Which robot (may be left out when there is one)");
  add_map(app, typed);
  add(app, "watch", "Show the robots live until Ctrl-C", "  cairn watch\n  cairn watch --json");
  add_plan(app, typed);
  add(app, "link", "Show what each robot's link carries",
      "  cairn link\n  cairn --server base.local:8642 link");
}

void add_globals(CLI::App& app, Typed& typed) {
  app.set_version_flag("--version", std::string("cairn ") + CAIRN_VERSION);
  app.set_config("--config", "", "TOML file with options of the same names")
      ->check(CLI::ExistingFile);
  app.allow_config_extras(CLI::config_extras_mode::error);
  app.add_option("--server", typed.server, "HOST:PORT of cairn-server")
      ->envname("CAIRN_SERVER")
      ->check(check_server)
      ->capture_default_str();
  app.add_flag("--json", typed.invocation.json, "Answer in JSON, for programs");
  app.add_option("--timeout", typed.invocation.timeout_s, "Wait this long for the server [s]")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  app.require_subcommand(1);
  app.footer(
      "Examples:\n"
      "  cairn status                       what is there, and how old it is\n"
      "  cairn goto 12.5 -3 --follow        send the robot and watch it go\n"
      "  cairn map --png yard.png           draw the map\n"
      "`cairn COMMAND --help` tells more of each.\n"
      "Exit codes: 0 done, 1 refused or failed, 2 wrong usage.");
}

api::PointJson point_of(const std::string& checked) { return parse_point(checked).value(); }

Command goto_command_of(Typed& typed) {
  const auto places = parse_places(typed.places);
  if (!places) throw CLI::ValidationError("PLACE", places.error().message);
  auto& request = typed.go_to.request;
  if (places->robot && request.robot) throw CLI::ExcludesError("ROBOT", "--robot");
  if (places->robot) request.robot = places->robot;
  request.x_m = places->places[0].x_m;
  request.y_m = places->places[0].y_m;
  request.heading_rad = places->places[0].heading_rad;
  request.then.assign(places->places.begin() + 1, places->places.end());
  if (request.loop && request.then.empty()) {
    throw CLI::ValidationError("--loop", "needs two places or more");
  }
  return typed.go_to;
}

Command plan_command_of(Typed& typed) {
  const bool way = !typed.from.empty() && !typed.to.empty();
  if (!way && !typed.offline.scenarios) throw CLI::RequiredError("--from and --to");
  if (way) {
    typed.plan.request.from = point_of(typed.from);
    typed.plan.request.to = point_of(typed.to);
  }
  return plan_command(typed.plan, typed.offline);
}

Command command_of(const CLI::App& app, Typed& typed) {
  if (app.got_subcommand("found")) return typed.found;
  if (app.got_subcommand("goto")) return goto_command_of(typed);
  if (app.got_subcommand("explore")) {
    if (!typed.area.empty()) typed.explore.request.area = parse_area(typed.area);
    return typed.explore;
  }
  if (app.got_subcommand("return")) return typed.go_home;
  if (app.got_subcommand("stop")) return typed.stop;
  if (app.got_subcommand("map")) {
    return map_command(*app.get_subcommand("map"), typed.map, typed.offline);
  }
  if (app.got_subcommand("plan")) return plan_command_of(typed);
  if (app.got_subcommand("link")) return LinkCommand{};
  if (app.got_subcommand("watch")) return WatchCommand{};
  return StatusCommand{};
}

/// "-.5" is a number to people; CLI11 takes only a digit after the sign for one.
std::string with_leading_zero(std::string argument) {
  if (argument.starts_with("-.")) argument.insert(1, "0");
  return argument;
}

}  // namespace

Result<ServerAddress> parse_server(const std::string& text) {
  const Error fault{ErrorCode::invalid_argument,
                    "\"" + text + "\" is no server: expected HOST:PORT, as 127.0.0.1:8642"};
  const auto colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) return fault;
  ServerAddress address;
  address.host = text.substr(0, colon);
  if (address.host.starts_with('[') && address.host.ends_with(']')) {
    address.host = address.host.substr(1, address.host.size() - 2);
  } else if (address.host.find(':') != std::string::npos) {
    return fault;
  }
  if (address.host.empty() || !read_whole(std::string_view(text).substr(colon + 1), address.port) ||
      address.port == 0) {
    return fault;
  }
  return address;
}

std::string to_string(const ServerAddress& address) {
  const bool v6 = address.host.find(':') != std::string::npos;
  return (v6 ? "[" + address.host + "]" : address.host) + ":" + std::to_string(address.port);
}

Result<api::PointJson> parse_point(const std::string& text) {
  const auto comma = text.find(',');
  api::PointJson point;
  if (comma == std::string::npos ||
      !read_coordinate(std::string_view(text).substr(0, comma), point.x_m) ||
      !read_coordinate(std::string_view(text).substr(comma + 1), point.y_m)) {
    return Error{ErrorCode::invalid_argument,
                 "\"" + text + "\" is no place: expected X,Y in metres, as -3,2.5"};
  }
  return point;
}

Result<Places> parse_places(const std::vector<std::string>& words) {
  Places places;
  api::PlaceJson place;
  if (words.size() == 2 && read_coordinate(words[0], place.x_m) &&
      read_coordinate(words[1], place.y_m)) {
    places.places = {place};
    return places;
  }
  for (std::size_t i = 0; i < words.size(); ++i) {
    auto read = parse_place(words[i]);
    if (read) {
      places.places.push_back(*read);
    } else if (i == 0 && words.size() > 1 && words[0].find(',') == std::string::npos) {
      places.robot = words[0];
    } else {
      return Error{ErrorCode::invalid_argument,
                   read.error().message + "; one place may also be two numbers of metres: 12.5 -3"};
    }
  }
  if (places.places.size() > api::kMaxWaypoints) {
    return Error{ErrorCode::invalid_argument, "more than 256 places"};
  }
  return places;
}

std::variant<Invocation, Exit> parse_arguments(std::vector<std::string> arguments) {
  Typed typed;
  CLI::App app("Command robots and see their map over a thin radio link.", "cairn");
  add_globals(app, typed);
  add_subcommands(app, typed);
  std::ranges::transform(arguments, arguments.begin(), with_leading_zero);
  std::ranges::reverse(arguments);  // As CLI11 wants them.
  try {
    app.parse(arguments);
    typed.invocation.server = parse_server(typed.server).value();
    typed.invocation.command = command_of(app, typed);
    return typed.invocation;
  } catch (const CLI::Error& end) {
    std::ostringstream out;
    std::ostringstream err;
    const int code = app.exit(end, out, err);
    return Exit{code == 0 ? kExitOk : kExitUsage, out.str(), err.str()};
  }
}

}  // namespace cairn::cli
