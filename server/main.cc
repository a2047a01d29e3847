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
#include "proto/udp/keys.h"
#include "proto/udp/server_carrier.h"
#include "server/api/api_server.h"
#include "server/server.h"
#include "server/store/sqlite_store.h"
#include "server/world/audit.h"

namespace {

using cairn::Error;
using cairn::ErrorCode;
using cairn::Result;
using cairn::Status;

struct Options {
  std::string data;
  std::vector<std::string> listen = {"dds://127.0.0.1"};
  std::string keys;
  std::string new_key;
  double link_min_kbit = cairn::proto::BudgetConfig{}.floor_bit_s * 1e-3;
  double link_max_kbit = cairn::proto::BudgetConfig{}.ceiling_bit_s * 1e-3;
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
  cairn-server --data /srv/cairn --listen dds://0.0.0.0 --listen udp://0.0.0.0:8643 --keys robots.key
                                                  also robots on thin links, each with its key
  cairn-server --new-key rover-1 >> robots.key    a key for a robot: the same line goes into the
                                                  file that its agent is started with (--key)
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
  app.add_option("--data", options.data, "Folder of the site files (made if missing)");
  app.add_option("--listen", options.listen,
                 "Where robots find this server: dds://HOST[?domain=N], udp://HOST[:PORT]; may be "
                 "given several times")
      ->capture_default_str();
  app.add_option("--keys", options.keys, "The robots' keys, for udp://: lines ROBOT KEY");
  app.add_option("--new-key", options.new_key, "Print a new key for this robot, and end");
  app.add_option("--link-min-kbit", options.link_min_kbit,
                 "The way to each robot is trusted to carry this much, whatever happens [kbit/s]")
      ->check(CLI::Range(0.1, 1e6))
      ->capture_default_str();
  app.add_option("--link-max-kbit", options.link_max_kbit,
                 "Never send a robot more than this, headers included [kbit/s]")
      ->check(CLI::Range(0.1, 1e6))
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
  config.budget.floor_bit_s = options.link_min_kbit * 1e3;
  config.budget.ceiling_bit_s = options.link_max_kbit * 1e3;
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

using Carriers = std::vector<std::unique_ptr<cairn::proto::Carrier>>;

/// Where robots find a carrier, as it can be told to them.
Result<std::string> add_dds(const std::string& url, Carriers& carriers) {
  auto endpoint = cairn::proto::parse_dds_url(url);
  if (!endpoint) return endpoint.error();
  auto carrier = cairn::proto::DdsServerCarrier::create(*endpoint);
  if (!carrier) return carrier.error();
  carriers.push_back(std::move(*carrier));
  return url;
}

Result<std::string> add_udp(const std::string& url, const std::string& key_file,
                            Carriers& carriers) {
  auto address = cairn::proto::parse_udp_url(url);
  if (!address) return address.error();
  if (key_file.empty()) {
    return Error{ErrorCode::invalid_argument,
                 "--listen " + url + " needs the robots' keys: --keys FILE"};
  }
  auto keys = cairn::proto::read_keys(key_file);
  if (!keys) return keys.error();
  auto carrier = cairn::proto::UdpServerCarrier::create(*address, *keys);
  if (!carrier) return carrier.error();
  const std::string told = "udp://" + address->host + ":" + std::to_string((*carrier)->port());
  carriers.push_back(std::move(*carrier));
  return told;
}

Status serve(const Options& options) {
  if (Status valid = cairn::proto::validate(config_of(options).budget); !valid) return valid;
  Carriers carriers;
  std::string robots;
  for (const std::string& url : options.listen) {
    const auto told = cairn::proto::is_udp_url(url) ? add_udp(url, options.keys, carriers)
                                                    : add_dds(url, carriers);
    if (!told) return told.error();
    robots += (robots.empty() ? "" : " ") + *told;
  }

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
  spdlog::info("robots: {}  operators: http://{}:{}", robots, options.api_address, api->port());
  wait_for_signal();
  spdlog::info("stopping: making everything received durable");
  api->stop();
  server->stop();
  return {};
}

Status print_new_key(const std::string& robot) {
  const auto line = cairn::proto::new_key_line(robot);
  if (!line) return line.error();
  std::cout << *line << '\n';
  return {};
}

Status run(const Options& options) {
  if (!options.new_key.empty()) return print_new_key(options.new_key);
  if (options.data.empty()) {
    return Error{ErrorCode::invalid_argument, "--data is required: the folder of the site files"};
  }
  return options.audit ? audit_sites(options) : serve(options);
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
  if (Status result = run(options); !result) {
    std::cerr << "cairn-server: " << result.error().message << '\n';
    return 1;
  }
  return 0;
}
