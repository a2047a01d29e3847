#include "tests/support/emulated_site.h"

namespace cairn::test {
namespace {

using namespace std::chrono_literals;

constexpr const char* kRobot = "r1";
constexpr const char* kReadyLine = "operators: http://";

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::string dds_url() { return std::string("dds://") + LinkEmulator::kBaseAddress; }

/// The port in the server's own words.
std::string port_of(const std::string& output) {
  const std::size_t line = output.find(kReadyLine);
  const std::size_t colon = output.find(':', line + std::string(kReadyLine).size());
  return output.substr(colon + 1, output.find('\n', colon) - colon - 1);
}

}  // namespace

const char* to_string(CarrierKind carrier) { return carrier == CarrierKind::udp ? "udp" : "dds"; }

Result<std::unique_ptr<EmulatedSite>> EmulatedSite::create(std::uint64_t seed, CarrierKind carrier,
                                                           const ChannelConfig& config) {
  auto link = LinkEmulator::create(seed, config, config);
  if (!link) return link.error();
  return std::unique_ptr<EmulatedSite>(new EmulatedSite(carrier, std::move(link).value()));
}

EmulatedSite::EmulatedSite(CarrierKind carrier, std::unique_ptr<LinkEmulator> link)
    : carrier_(carrier),
      link_(std::move(link)),
      udp_(folder_, {kRobot}, LinkEmulator::kBaseAddress) {}

bool EmulatedSite::start_server(const std::vector<std::string>& more) {
  const std::vector<std::string> own{server_program(), "--data", site_folder(folder_).string(),
                                     "--api-port", "0"};
  const std::vector<std::string> listen = carrier_ == CarrierKind::udp
                                              ? udp_.server_arguments()
                                              : std::vector<std::string>{"--listen", dds_url()};
  server_.reset();
  server_ = std::make_unique<Process>(link_->base().inside(joined(joined(own, listen), more)),
                                      folder_.path() / "server.log");
  if (!server_->wait_for_output(kReadyLine, 20s)) return false;
  api_port_ = port_of(server_->output());
  return true;
}

void EmulatedSite::start_agent(const std::vector<std::string>& arguments) {
  const std::vector<std::string> to =
      carrier_ == CarrierKind::udp
          ? udp_.agent_arguments(kRobot)
          : std::vector<std::string>{"--server", dds_url(), "--robot", kRobot};
  agent_.reset();
  agent_ = std::make_unique<Process>(
      link_->robot().inside(joined(joined({agent_program()}, to), arguments)),
      folder_.path() / "agent.log");
}

Finished EmulatedSite::cairn(std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(), {cli_program(), "--server", "127.0.0.1:" + api_port_});
  return run(link_->base().inside(arguments));
}

nlohmann::json EmulatedSite::robot() const {
  const Finished finished = cairn({"status", "--json"});
  if (finished.exit_code != 0) return nullptr;
  const auto status = nlohmann::json::parse(finished.output, nullptr, false);
  if (!status.is_object() || status["robots"].empty()) return nullptr;
  return status["robots"][0];
}

}  // namespace cairn::test
