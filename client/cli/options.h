#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "client/offline/import_request.h"
#include "core/common/result.h"
#include "core/map/traversability.h"
#include "proto/json/messages.h"

/// What the operator typed, as values.
namespace cairn::cli {

struct ServerAddress {
  std::string host = "127.0.0.1";
  std::uint16_t port = 8642;
};

/// "HOST:PORT", "[IPv6]:PORT".
[[nodiscard]] Result<ServerAddress> parse_server(const std::string& text);
[[nodiscard]] std::string to_string(const ServerAddress& address);
/// Where `goto` leads: "X Y", or "[ROBOT] X,Y[,HEADING_DEG] [X,Y[,HEADING_DEG] …]".
struct Places {
  std::optional<std::string> robot;
  std::vector<api::PlaceJson> places;  ///< One or more.
};
[[nodiscard]] Result<Places> parse_places(const std::vector<std::string>& words);
/// "X,Y" in metres.
[[nodiscard]] Result<api::PointJson> parse_point(const std::string& text);

struct StatusCommand {};
struct LinkCommand {};
struct WatchCommand {};
struct FoundCommand {
  api::FoundRequest request;
};
struct GotoCommand {
  api::GotoRequest request;
  bool follow = false;
};
struct ExploreCommand {
  api::ExploreRequest request;
  bool follow = false;
};
struct ReturnCommand {
  api::ReturnRequest request;
  bool follow = false;
};
struct StopCommand {
  api::StopRequest request;
};
struct MapCommand {
  std::string png;
  std::optional<std::string> site;
  int scale = 0;  ///< Pixels per cell; 0: chosen by the map's size.
};
struct PlanCommand {
  api::PlanRequestJson request;
  std::string png;  ///< Empty: no picture.
};

// These work on a site's store, without a server.

struct ImportCommand {
  offline::ImportRequest request;
};
struct ExportCommand {
  std::string store;
  std::string file;
  VehicleLimits limits;
};
struct InfoCommand {
  std::string store;
};
struct DrawStoreCommand {
  std::string store;
  std::string png;
  int scale = 0;  ///< As MapCommand's.
};
struct PlanOnStoreCommand {
  std::string store;
  PlanCommand plan;
  VehicleLimits limits;
};
struct ScenariosCommand {
  std::string store;
  std::string file;
  VehicleLimits limits;
  std::string unknown = "blocked";
};

using Command = std::variant<StatusCommand, LinkCommand, WatchCommand, FoundCommand, GotoCommand,
                             ExploreCommand, ReturnCommand, StopCommand, MapCommand, PlanCommand,
                             ImportCommand, ExportCommand, InfoCommand, DrawStoreCommand,
                             PlanOnStoreCommand, ScenariosCommand>;

struct Invocation {
  ServerAddress server;
  bool json = false;
  double timeout_s = 10.0;
  Command command;
};

/// The program's end without a command: --help, --version or wrong usage.
struct Exit {
  int code = 0;
  std::string out;
  std::string err;
};

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;

/// Reads the arguments (without the program's name), $CAIRN_SERVER and the file of --config.
[[nodiscard]] std::variant<Invocation, Exit> parse_arguments(std::vector<std::string> arguments);

}  // namespace cairn::cli
