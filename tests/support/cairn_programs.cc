#include "tests/support/cairn_programs.h"

namespace cairn::test {

namespace {

std::vector<std::string> server_arguments(const TempFolder& folder,
                                          const std::vector<std::string>& more) {
  std::vector<std::string> argv{server_program(),
                                "--data",
                                site_folder(folder).string(),
                                "--listen",
                                ServerProcess::dds_url(),
                                "--api-port",
                                "0"};
  argv.insert(argv.end(), more.begin(), more.end());
  return argv;
}

constexpr const char* kReadyLine = "operators: http://";

}  // namespace

std::string server_program() { return CAIRN_SERVER; }
std::string agent_program() { return CAIRN_AGENT; }
std::string cli_program() { return CAIRN_CLI; }

std::filesystem::path site_folder(const TempFolder& folder) { return folder.path() / "sites"; }

ServerProcess::ServerProcess(const TempFolder& folder, const std::vector<std::string>& more)
    : process_(server_arguments(folder, more), folder.path() / "server.log") {}

std::string ServerProcess::dds_url() {
  return "dds://127.0.0.1?domain=" + std::to_string(own_dds_domain());
}

bool ServerProcess::wait_until_ready() {
  return process_.wait_for_output(kReadyLine, std::chrono::seconds(20));
}

std::string ServerProcess::address() const {
  if (port_.empty()) {
    const std::string output = process_.output();
    const std::size_t line = output.find(kReadyLine);
    const std::size_t colon = output.find(':', line + std::string(kReadyLine).size());
    port_ = output.substr(colon + 1, output.find('\n', colon) - colon - 1);
  }
  return "127.0.0.1:" + port_;
}

Finished ServerProcess::cairn(std::vector<std::string> arguments,
                              std::chrono::milliseconds timeout) const {
  arguments.insert(arguments.begin(), {cli_program(), "--server", address()});
  return run(arguments, timeout);
}

nlohmann::json ServerProcess::status() const {
  const Finished finished = cairn({"status", "--json"});
  if (finished.exit_code != 0) return nullptr;
  return nlohmann::json::parse(finished.output, nullptr, false);
}

Process start_agent(const TempFolder& folder, const std::string& name,
                    std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(),
                   {agent_program(), "--server", ServerProcess::dds_url(), "--robot", name});
  return Process(arguments, folder.path() / (name + ".log"));
}

Finished audit(const TempFolder& folder) {
  return run({server_program(), "--data", site_folder(folder).string(), "--audit"},
             std::chrono::seconds(60));
}

}  // namespace cairn::test
