#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "client/cli/options.h"

/// The options of `map` and `plan` that mean a store instead of a server.
namespace cairn::cli {

/// What CLI11 fills in.
struct OfflineOptions {
  std::string store;  ///< Positional SITE of `plan` and `map`; empty: ask the server.
  std::optional<std::string> scenarios;
  std::optional<double> radius_m;
  double climb_m = VehicleLimits{}.climb_mm / 1000.0;
  double descend_m = VehicleLimits{}.descend_mm / 1000.0;
  ImportCommand import;
  std::string origin;
  std::string export_store;
  std::string export_file;
  std::string info_store;
};

void add_offline_map(CLI::App& map, OfflineOptions& options);
void add_offline_plan(CLI::App& plan, OfflineOptions& options);

/// The command that was given, on a server or on a store. Throws CLI::ParseError when what was
/// typed does not go together.
[[nodiscard]] Command map_command(const CLI::App& map, const MapCommand& online,
                                  const OfflineOptions& options);
[[nodiscard]] Command plan_command(const PlanCommand& online, const OfflineOptions& options);

}  // namespace cairn::cli
