#pragma once

#include <cstdint>
#include <string>

namespace cairn::proto {

enum class DdsRole { server, robot };

/// What Cyclone's configuration depends on.
struct DdsConfig {
  DdsRole role = DdsRole::robot;
  std::string interface_address = {};  ///< IPv4 of the interface to use; empty = Cyclone chooses.
  std::string server_address = {};     ///< IPv4; only a robot needs it.
  std::uint32_t domain = 0;
  bool loopback = false;  ///< Nothing leaves this machine: quick timers cost nothing.
};

/// Cyclone's XML for one domain; README.md gives the reason for each setting.
[[nodiscard]] std::string dds_config_xml(const DdsConfig& config);

}  // namespace cairn::proto
