#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <iostream>
#include <thread>
#include <vector>

#include "proto/dds/endpoint.h"
#include "proto/dds/server_carrier.h"
#include "server/api/api_server.h"
#include "server/server.h"
#include "server/store/sqlite_store.h"
#include "server/world/audit.h"

namespace {

using cairn::Error;
using cairn::ErrorCode;
using cairn::Status;

struct Options {
  std::string data;
  std::string listen = "dds://127.0.0.1";
  std::string api_address = "127.0.0.1";
  std::uint16_t api_port = 8642;
  cairn::VehicleLimits vehicle;
  double climb_effort = cairn::PlannerConfig{}.climb_effort;
  double descend_effort = cairn::PlannerConfig{}.descend_effort;
  double unknown_price = cairn::PlannerConfig{}.unknown_price;
  std::string log_level = "info";
  bool audit = false;
};

constexpr const char* kExamples = R"(Examples:
  cairn-server --data ~/cairn                     keep sites in ~/cairn, robots on this machine
  cairn-server --data /srv/cairn --listen dds://0.0.0.0 --api-address 0.0.0.0
                                                  robots and operators from the network
  cairn-server --config server.toml               the same flags as `name = value` lines
  cairn-server --data ~/cairn --audit             check every stored row and rebuild every map

A first session, in three shells:
  cairn-server --data ~/cairn
  cairn found lab && cairn-agent --world room --site lab
  cairn goto 3 2 --follow && cairn map --png lab.png)";

void describe(CLI::App& app, Options& options) {
  app.footer(kExamples);
  app.set_config("--config", "", "Read flags from a TOML file; unknown keys are refused");
  app.allow_config_extras(CLI::config_extras_mode::error);
  app.set_version_flag("--version", CAIRN_VERSION);
  app.add_option("--data", options.data, "Folder of the site files (made if missing)")->required();
  app.add_option("--listen", options.listen, "Where robots find this server: dds://HOST[?domain=N]")
      ->capture_default_str();
  app.add_option("--api-address", options.api_address, "Address for operators (HTTP, WebSocket)")
      ->capture_default_str();
  app.add_option("--api-port", options.api_port, "Port for operators; 0 = any free one")
      ->capture_default_str();
  app.add_option("--climb-mm", options.vehicle.climb_mm, "Highest step the robots climb [mm]")
      ->check(CLI::Range(0, 2000))
      ->capture_default_str();
  app.add_option("--descend-mm", options.vehicle.descend_mm, "Deepest step they go down [mm]")
      ->check(CLI::Range(0, 2000))
      ->capture_default_str();
  app.add_option("--radius-m", options.vehicle.radius_m, "Room a robot needs around its middle [m]")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  app.add_option("--climb-effort", options.climb_effort,
                 "Level metres worth one metre of height gained")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  app.add_option("--descend-effort", options.descend_effort,
                 "Level metres worth one metre of height lost")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  app.add_option("--unknown-price", options.unknown_price,
                 "Cost of unknown ground per metre, where it is allowed")
      ->check(CLI::Range(1.0, 100.0))
      ->capture_default_str();
  app.add_flag("--audit", options.audit,
               "Check the stored sites from the ground up, print what was found, and end");
  app.add_option("--log-level", options.log_level, "trace, debug, info, warn, error")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error"}))
      ->capture_default_str();
}

cairn::server::ServerConfig config_of(const Options& options) {
  cairn::server::ServerConfig config;
  config.data = options.data;
  config.mission.planner.limits = options.vehicle;
  config.mission.planner.climb_effort = options.climb_effort;
  config.mission.planner.descend_effort = options.descend_effort;
  config.mission.planner.unknown_price = options.unknown_price;
  config.mission.min_probability = config.sensor_model.min_probability;
  return config;
}

/// The threads that run everything but the carriers' receiving.
class Workers {
 public:
  explicit Workers(boost::asio::io_context& io) : io_(io), guard_(io.get_executor()) {
    for (unsigned i = 0; i < std::max(2U, std::thread::hardware_concurrency()) + 1; ++i) {
      threads_.emplace_back([this] { io_.run(); });
    }
  }
  ~Workers() {
    guard_.reset();
    io_.stop();
  }
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

 private:
  boost::asio::io_context& io_;
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> guard_;
  std::vector<std::jthread> threads_;
};

void wait_for_signal() {
  boost::asio::io_context io;
  boost::asio::signal_set signals(io, SIGINT, SIGTERM);
  signals.async_wait([](const boost::system::error_code&, int) {});
  io.run();
}

/// Prints a line for each site and each fault; an error when there is any.
Status audit_sites(const Options& options) {
  auto files = cairn::server::site_files(options.data);
  if (!files) return files.error();
  std::size_t faults = 0;
  for (const std::filesystem::path& file : *files) {
    auto store = cairn::server::SqliteStore::open(file);
    if (!store) return store.error();
    auto audit = cairn::server::audit(**store, config_of(options).sensor_model);
    if (!audit) return audit.error();
    std::cout << (*store)->site().name << ": " << audit->store.submaps << " submaps ("
              << audit->merged_submaps << " merged), " << audit->store.blocks << " blocks, "
              << audit->store.tiles << " tiles: " << (audit->sound() ? "sound" : "FAULTY") << '\n';
    for (const std::string& fault : audit->store.faults) std::cout << "  " << fault << '\n';
    for (const std::string& fault : audit->faults) std::cout << "  " << fault << '\n';
    faults += audit->store.faults.size() + audit->faults.size();
  }
  if (faults == 0) return {};
  return Error{ErrorCode::corrupt,
               std::to_string(faults) + " faults: restore the named sites from a copy"};
}

Status serve(const Options& options) {
  auto endpoint = cairn::proto::parse_dds_url(options.listen);
  if (!endpoint) return endpoint.error();
  auto carrier = cairn::proto::DdsServerCarrier::create(*endpoint);
  if (!carrier) return carrier.error();
  std::vector<std::unique_ptr<cairn::proto::Carrier>> carriers;
  carriers.push_back(std::move(*carrier));

  boost::asio::io_context io;
  std::shared_ptr<cairn::server::Server> server;
  std::unique_ptr<cairn::server::ApiServer> api;
  const Workers workers(io);
  auto started =
      cairn::server::Server::start(io.get_executor(), config_of(options), std::move(carriers));
  if (!started) return started.error();
  server = *started;
  auto listening = cairn::server::ApiServer::start(
      io, {.address = options.api_address, .port = options.api_port}, *server);
  if (!listening) {
    server->stop();
    return listening.error();
  }
  api = std::move(*listening);
  spdlog::info("robots: {}  operators: http://{}:{}", options.listen, options.api_address,
               api->port());
  wait_for_signal();
  spdlog::info("stopping: making everything received durable");
  api->stop();
  server->stop();
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "The map server: keeps the long-term map of every site, plans on it, commands robots.",
      "cairn-server");
  Options options;
  describe(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  spdlog::set_default_logger(spdlog::stderr_color_mt("cairn-server"));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
  spdlog::set_level(spdlog::level::from_str(options.log_level));
  if (Status result = options.audit ? audit_sites(options) : serve(options); !result) {
    std::cerr << "cairn-server: " << result.error().message << '\n';
    return 1;
  }
  return 0;
}
