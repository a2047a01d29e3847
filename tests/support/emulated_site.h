#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/cairn_programs.h"
#include "tests/support/link_emulator/emulator.h"
#include "tests/support/udp_link.h"

namespace cairn::test {

enum class CarrierKind { udp, dds };
[[nodiscard]] const char* to_string(CarrierKind carrier);

/// The real programs at both ends of an emulated link: a server and its operator on the base's
/// side, an agent on the robot's.
class EmulatedSite {
 public:
  /// unavailable where the system allows no emulator.
  static Result<std::unique_ptr<EmulatedSite>> create(std::uint64_t seed, CarrierKind carrier,
                                                      const ChannelConfig& config);

  /// Starts (or starts again) the server; false when it does not get ready.
  bool start_server(const std::vector<std::string>& more = {});
  /// Starts (or starts again) robot "r1".
  void start_agent(const std::vector<std::string>& arguments);
  /// `cairn ARGUMENTS` beside the server.
  [[nodiscard]] Finished cairn(std::vector<std::string> arguments) const;
  /// The robot as `cairn status --json` tells it; null while it is not known.
  [[nodiscard]] nlohmann::json robot() const;

  [[nodiscard]] LinkEmulator& link() { return *link_; }
  [[nodiscard]] const TempFolder& folder() const { return folder_; }
  Process& server() { return *server_; }
  Process& agent() { return *agent_; }

 private:
  EmulatedSite(CarrierKind carrier, std::unique_ptr<LinkEmulator> link);

  CarrierKind carrier_;
  TempFolder folder_;
  std::unique_ptr<LinkEmulator> link_;
  UdpLink udp_;
  std::unique_ptr<Process> server_;
  std::unique_ptr<Process> agent_;
  std::string api_port_;
};

}  // namespace cairn::test
