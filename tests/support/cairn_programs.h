#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/process.h"

namespace cairn::test {

/// A running cairn-server on loopback, in a DDS domain of this process, on a free API port.
class ServerProcess {
 public:
  /// `data` outlives the process: start another one on it after a crash.
  explicit ServerProcess(const TempFolder& folder, const std::vector<std::string>& more = {});

  /// It listens. When it does not, `process().output()` says why.
  bool wait_until_ready();
  Process& process() { return process_; }
  [[nodiscard]] std::string address() const;  ///< HOST:PORT of its API.
  [[nodiscard]] static std::string dds_url();

  /// `cairn --server … ARGUMENTS`, run to its end.
  [[nodiscard]] Finished cairn(std::vector<std::string> arguments,
                               std::chrono::milliseconds timeout = std::chrono::seconds(30)) const;
  /// `cairn status --json`; null when the server does not answer.
  [[nodiscard]] nlohmann::json status() const;

 private:
  Process process_;
  mutable std::string port_;
};

[[nodiscard]] std::filesystem::path site_folder(const TempFolder& folder);
[[nodiscard]] std::string server_program();
[[nodiscard]] std::string agent_program();
[[nodiscard]] std::string cli_program();

/// A cairn-agent that talks to `ServerProcess::dds_url()`.
Process start_agent(const TempFolder& folder, const std::string& name,
                    std::vector<std::string> arguments);

/// `cairn-server --audit` of the folder's sites.
Finished audit(const TempFolder& folder);

}  // namespace cairn::test
