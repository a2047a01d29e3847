#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "client/offline/export.h"
#include "client/offline/import.h"
#include "client/offline/scenarios.h"

/// What commands on a store found, for programs and for people.
namespace cairn::cli {

[[nodiscard]] nlohmann::json facts_json(const offline::SiteFacts& facts);
[[nodiscard]] std::string facts_text(const offline::SiteFacts& facts);
[[nodiscard]] nlohmann::json import_json(const offline::ImportReport& report);
[[nodiscard]] std::string import_text(const offline::ImportReport& report,
                                      const offline::ImportRequest& request);
[[nodiscard]] nlohmann::json export_json(const offline::ExportReport& report,
                                         const std::string& file);
[[nodiscard]] std::string export_text(const offline::ExportReport& report, const std::string& file);
[[nodiscard]] nlohmann::json scenarios_json(const offline::ScenarioReport& report);
[[nodiscard]] std::string scenarios_text(const offline::ScenarioReport& report);

}  // namespace cairn::cli
