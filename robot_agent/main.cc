#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <iostream>
#include <optional>
#include <random>
#include <thread>

#include "core/common/angle.h"
#include "proto/codec/text.h"
#include "proto/dds/endpoint.h"
#include "proto/dds/robot_carrier.h"
#include "proto/udp/keys.h"
#include "proto/udp/robot_carrier.h"
#include "robot_agent/input/carmen_log.h"
#include "robot_agent/input/simulator.h"
#include "robot_agent/pipeline/agent.h"
#include "robot_agent/pipeline/detail.h"

namespace {

using namespace std::chrono_literals;
using cairn::MonotonicTime;
using cairn::Result;
using cairn::Status;
using cairn::agent::Agent;
using cairn::agent::Input;

std::atomic<bool> stop_asked{false};

struct Options {
  std::string world;
  std::string replay;
  std::uint64_t seed = 1;
  double speed = 1.0;
  double max_range_m = cairn::agent::LogConfig{}.max_range_m;
  bool start_unknown = false;
  std::string server = "dds://127.0.0.1";
  std::string key;
  double link_min_kbit = cairn::proto::BudgetConfig{}.floor_bit_s * 1e-3;
  double link_max_kbit = cairn::proto::BudgetConfig{}.ceiling_bit_s * 1e-3;
  double pose_period_s = 1.0;
  std::string detail = "full";
  std::optional<int> height_step_mm;
  std::optional<int> probability_levels;
  std::optional<double> evidence_period_s;
  std::string spool;
  std::uint64_t spool_mb = 256;
  std::string robot = "robot";
  std::string site = "lab";
  int cell_mm = 125;
  double max_speed_m_s = cairn::agent::FollowerConfig{}.max_speed_m_s;
  double mapping_range_m = cairn::agent::MapperConfig{}.mapping_range_m;
  cairn::VehicleLimits vehicle;
  std::string log_level = "info";
};

constexpr const char* kExamples = R"(Examples:
  cairn-agent --world room --site lab                 a simulated robot in a furnished laboratory
  cairn-agent --world block --seed 7 --robot atrv-2   a city block, other furniture, another robot
  cairn-agent --world dem:terrain_10cm.csv --site hills
                                                      any terrain file (TIFF, or rows of heights)
  cairn-agent --replay intel.clf.bz2 --site intel     a CARMEN log, as fast as the machine allows
  cairn-agent --world room --server "dds://10.0.0.2?domain=3"
                                                      a server on another machine
  cairn-agent --world room --server udp://base.local:8643 --robot rover-1 --key rover-1.key
                                                      over a thin link, encrypted with the key that
                                                      `cairn-server --new-key rover-1` printed

Worlds: room, ramp, block, hill, dem:FILE[@CELL_SIZE_IN_M])";

void describe(CLI::App& app, Options& options) {
  app.footer(kExamples);
  app.set_config("--config", "", "Read flags from a TOML file; unknown keys are refused");
  app.allow_config_extras(CLI::config_extras_mode::error);
  app.set_version_flag("--version", CAIRN_VERSION);
  auto* input = app.add_option_group("input", "Where the robot's readings come from");
  input->add_option("--world", options.world, "Simulate a robot in this world");
  input->add_option("--replay", options.replay, "Replay this CARMEN log (plain, .gz, .bz2)");
  input->require_option(1);
  app.add_option("--seed", options.seed, "Of the simulated world and all its noise")
      ->capture_default_str();
  app.add_option("--speed", options.speed, "Simulated seconds per second")
      ->check(CLI::Range(0.1, 20.0))
      ->capture_default_str();
  app.add_option("--max-range-m", options.max_range_m, "Replay: readings beyond are no return")
      ->check(CLI::Range(1.0, 200.0))
      ->capture_default_str();
  app.add_flag(
      "--start-unknown", options.start_unknown,
      "Nobody knows where on the site the robot stands: it maps nothing until it has found "
      "itself in the server's map");
  app.add_option("--server", options.server,
                 "The server: dds://HOST[?domain=N] or udp://HOST[:PORT]")
      ->capture_default_str();
  app.add_option("--key", options.key, "File with this robot's key, for udp://: a line ROBOT KEY");
  app.add_option("--link-min-kbit", options.link_min_kbit,
                 "The way to the server is trusted to carry this much, whatever happens [kbit/s]")
      ->check(CLI::Range(0.1, 1e6))
      ->capture_default_str();
  app.add_option("--link-max-kbit", options.link_max_kbit,
                 "Never send more than this, headers included [kbit/s]")
      ->check(CLI::Range(0.1, 1e6))
      ->capture_default_str();
  app.add_option("--pose-period-s", options.pose_period_s,
                 "How often it tells its pose while it moves [s]")
      ->check(CLI::Range(0.1, 60.0))
      ->capture_default_str();
  app.add_option("--detail", options.detail,
                 "How finely the map is told: full (10 mm, 16 levels of probability, each second) "
                 "or radio, for the thinnest links (10 mm, 4 levels, each 5 s)")
      ->check(CLI::IsMember({"full", "radio"}))
      ->capture_default_str();
  app.add_option("--height-step-mm", options.height_step_mm,
                 "Other than --detail has it: heights are told in these steps, and again when they "
                 "moved by one [mm]")
      ->check(CLI::Range(1, 255));
  app.add_option("--probability-levels", options.probability_levels,
                 "Other than --detail has it: levels of probability that are told apart")
      ->check(CLI::Range(2, cairn::kMaxLevels));
  app.add_option("--evidence-period-s", options.evidence_period_s,
                 "Other than --detail has it: how often at most what changed is told [s]")
      ->check(CLI::Range(0.05, 600.0));
  app.add_option("--spool", options.spool,
                 "Keep evidence in this folder until the server holds it, also beyond the end of "
                 "this agent; the next one with the same folder, --robot and --site delivers it");
  app.add_option("--spool-mb", options.spool_mb,
                 "The spool never takes more; then the oldest detail goes [MB]")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app.add_option("--robot", options.robot, "This robot's id: a-z, 0-9, '-', '_'")
      ->capture_default_str();
  app.add_option("--site", options.site, "The site it works on (founded with `cairn found`)")
      ->capture_default_str();
  app.add_option("--cell-mm", options.cell_mm, "Size of a map cell, the site's [mm]")
      ->check(CLI::Range(10, 2000))
      ->capture_default_str();
  app.add_option("--max-speed", options.max_speed_m_s, "Highest driving speed [m/s]")
      ->check(CLI::Range(0.05, 3.0))
      ->capture_default_str();
  app.add_option("--mapping-range-m", options.mapping_range_m, "Beams are believed this far [m]")
      ->check(CLI::Range(1.0, 80.0))
      ->capture_default_str();
  app.add_option("--climb-mm", options.vehicle.climb_mm, "Highest step it climbs [mm]")
      ->check(CLI::Range(0, 2000))
      ->capture_default_str();
  app.add_option("--descend-mm", options.vehicle.descend_mm, "Deepest step it goes down [mm]")
      ->check(CLI::Range(0, 2000))
      ->capture_default_str();
  app.add_option("--radius-m", options.vehicle.radius_m, "Room it needs around its middle [m]")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  app.add_option("--log-level", options.log_level, "trace, debug, info, warn, error")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error"}))
      ->capture_default_str();
}

cairn::agent::Detail detail_of(const Options& options) {
  cairn::agent::Detail detail = cairn::agent::detail_named(options.detail).value();
  auto& [coarseness, period_s] = detail;
  coarseness.quantum_mm = options.height_step_mm.value_or(coarseness.quantum_mm);
  coarseness.levels = options.probability_levels.value_or(coarseness.levels);
  period_s = options.evidence_period_s.value_or(period_s);
  return detail;
}

cairn::agent::AgentConfig config_of(const Options& options) {
  cairn::agent::AgentConfig config;
  std::random_device random;
  config.link.robot = options.robot;
  config.link.site = options.site;
  config.link.budget.floor_bit_s = options.link_min_kbit * 1e3;
  config.link.budget.ceiling_bit_s = options.link_max_kbit * 1e3;
  config.link.pose_period = cairn::from_seconds(options.pose_period_s);
  config.link.boot = (std::uint64_t{random()} << 32) | random();
  config.link.cell_size_mm = options.cell_mm;
  const cairn::agent::Detail detail = detail_of(options);
  config.mapper.coarseness = detail.coarseness;
  config.link.evidence_period = cairn::from_seconds(detail.period_s);
  if (!options.replay.empty()) config.link.evidence_period = 50ms;  // Logs run faster than time.
  config.mapper.cell_size_mm = options.cell_mm;
  config.mapper.start_known = !options.start_unknown;
  config.mapper.mapping_range_m = options.mapping_range_m;
  config.driver.limits = options.vehicle;
  config.driver.follower.max_speed_m_s = options.max_speed_m_s;
  return config;
}

std::unique_ptr<cairn::agent::Spool> make_spool(const Options& options,
                                                const cairn::agent::AgentConfig& config) {
  if (options.spool.empty()) return nullptr;
  cairn::agent::SpoolConfig spool;
  spool.folder = options.spool;
  spool.most_bytes = options.spool_mb << 20U;
  spool.owner = {options.robot, options.site, options.cell_mm};
  spool.coarseness = config.mapper.coarseness;
  return std::make_unique<cairn::agent::Spool>(spool, config.link.boot);
}

Result<std::unique_ptr<Input>> open_input(const Options& options) {
  if (!options.replay.empty()) {
    cairn::agent::LogConfig log;
    log.max_range_m = options.max_range_m;
    return cairn::agent::open_carmen_log(options.replay, log);
  }
  cairn::agent::SimulatorConfig simulator;
  simulator.world = options.world;
  simulator.seed = options.seed;
  return cairn::agent::make_simulator(simulator);
}

MonotonicTime since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration_cast<MonotonicTime>(std::chrono::steady_clock::now() - start);
}

void tell_journey(const cairn::agent::Journey& journey) {
  const auto& [report, believed, truth] = journey;
  spdlog::info("command {}: {} at ({:.2f}, {:.2f}){}{}", report.command,
               report.state == cairn::proto::CommandState::arrived ? "arrived" : "ended",
               believed.x_m, believed.y_m, report.why.empty() ? "" : ": ", report.why);
  if (!truth) return;
  const cairn::Pose& pose = truth->T_site_robot;
  spdlog::info(
      "truth: ({:.3f}, {:.3f}), position error {:.3f} m, heading error {:.2f} deg, "
      "{} collisions",
      pose.x_m, pose.y_m, std::hypot(pose.x_m - believed.x_m, pose.y_m - believed.y_m),
      std::abs(cairn::degrees(cairn::wrap_angle(pose.yaw_rad - believed.yaw_rad))),
      truth->collisions);
}

/// What the log shows of the connection and the spool, a line for each change.
class Watch {
 public:
  explicit Watch(cairn::agent::Spool* spool) : spool_(spool) {}

  void look(const cairn::proto::RobotLink& link) {
    if (spool_ != nullptr) {
      for (const std::string& line : spool_->take_news()) spdlog::warn("spool: {}", line);
    }
    if (link.connected() == connected_) return;
    connected_ = link.connected();
    spdlog::info(connected_ ? "connected to the server" : "the server does not answer");
  }

 private:
  cairn::agent::Spool* spool_;
  bool connected_ = false;
};

Status check_rejected(const Agent& agent) {
  if (const auto& rejected = agent.link().rejected()) return *rejected;
  return {};
}

/// Real time, or a multiple of it: the robot lives until it is told to end.
Status run_live(Agent& agent, cairn::agent::Spool* spool, double speed) {
  constexpr auto kPeriod = 50ms;
  const auto start = std::chrono::steady_clock::now();
  Watch watch(spool);
  auto next = start;
  while (!stop_asked) {
    const MonotonicTime clock = since(start);
    const auto input_time = cairn::from_seconds(cairn::to_seconds(clock) * speed);
    if (Status stepped = agent.step(input_time, clock); !stepped) return stepped;
    next += kPeriod;
    for (auto now = std::chrono::steady_clock::now(); now < next && !stop_asked;
         now = std::chrono::steady_clock::now()) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(next - now);
      if (Status done =
              agent.exchange(since(start), std::min<std::chrono::milliseconds>(left, 10ms));
          !done) {
        return done;
      }
    }
    next = std::max(next, std::chrono::steady_clock::now() - kPeriod);  // Never catch up in bursts.
    watch.look(agent.link());
    if (Status status = check_rejected(agent); !status) return status;
    if (const auto journey = agent.take_journey()) tell_journey(*journey);
  }
  if (!agent.keep_the_rest(since(start))) spdlog::warn("spool: not all evidence is on disk");
  return {};
}

/// A log, as fast as the link takes it; ends when the server holds everything.
Status run_replay(Agent& agent, cairn::agent::Spool* spool, Input& input) {
  const auto start = std::chrono::steady_clock::now();
  Watch watch(spool);
  const auto service = [&](std::chrono::milliseconds wait) -> Status {
    if (Status done = agent.exchange(since(start), wait); !done) return done;
    watch.look(agent.link());
    return check_rejected(agent);
  };
  while (!agent.link().connected() && !stop_asked) {
    if (Status done = service(20ms); !done) return done;
  }
  MonotonicTime log_time{};
  while (!input.finished() && !stop_asked) {
    while (agent.congested() && !stop_asked) {
      if (Status done = service(5ms); !done) return done;
    }
    log_time = input.next_stamp().value_or(log_time) + 200ms;
    if (Status stepped = agent.step(log_time, since(start)); !stepped) return stepped;
    if (Status done = service(0ms); !done) return done;
  }
  agent.finish();
  while (!agent.delivered() && !stop_asked) {
    if (Status done = service(5ms); !done) return done;
  }
  if (!agent.keep_the_rest(since(start))) spdlog::warn("spool: not all evidence is on disk");
  const double real_s = cairn::to_seconds(since(start));
  spdlog::info(
      "replayed {:.0f} s of log in {:.1f} s ({:.0f} times real time): {} beams, {:.1f} m, "
      "{:.1f} MB sent",
      cairn::to_seconds(log_time), real_s, cairn::to_seconds(log_time) / real_s,
      agent.mapper().beams(), agent.mapper().distance_m(),
      static_cast<double>(agent.link().counters().bytes_sent) / 1e6);
  return {};
}

using CarrierResult = Result<std::unique_ptr<cairn::proto::Carrier>>;

template <class T>
CarrierResult as_carrier(Result<std::unique_ptr<T>> made) {
  if (!made) return made.error();
  return std::unique_ptr<cairn::proto::Carrier>(std::move(made).value());
}

CarrierResult open_udp(const Options& options) {
  auto address = cairn::proto::parse_udp_url(options.server);
  if (!address) return address.error();
  if (options.key.empty()) {
    return cairn::Error{cairn::ErrorCode::invalid_argument,
                        "--server " + options.server + " needs this robot's key: --key FILE"};
  }
  const auto key = cairn::proto::read_key(options.key, options.robot);
  if (!key) return key.error();
  return as_carrier(cairn::proto::UdpRobotCarrier::create(*address, *key));
}

CarrierResult open_carrier(const Options& options) {
  if (cairn::proto::is_udp_url(options.server)) return open_udp(options);
  auto endpoint = cairn::proto::parse_dds_url(options.server);
  if (!endpoint) return endpoint.error();
  return as_carrier(cairn::proto::DdsRobotCarrier::create(*endpoint, options.robot));
}

Status run(const Options& options) {
  for (const auto& [flag, name] :
       {std::pair{"--robot ", options.robot}, {"--site ", options.site}}) {
    if (cairn::proto::valid_name(name)) continue;
    return cairn::Error{cairn::ErrorCode::invalid_argument,
                        flag + name + ": use 1 to 32 of a-z, 0-9, '-' and '_'"};
  }
  if (Status valid = cairn::proto::validate(config_of(options).link.budget); !valid) return valid;
  auto input = open_input(options);
  if (!input) return input.error();
  auto carrier = open_carrier(options);
  if (!carrier) return carrier.error();
  const cairn::agent::AgentConfig config = config_of(options);
  const auto spool = make_spool(options, config);
  Agent agent(config, **input, **carrier, spool.get());
  spdlog::info("robot {} on site {}, looking for the server at {}", options.robot, options.site,
               options.server);
  Status result = options.replay.empty() ? run_live(agent, spool.get(), options.speed)
                                         : run_replay(agent, spool.get(), **input);
  const auto& counters = agent.link().counters();
  spdlog::info("link: {} bytes up, {} bytes down, {} frames lost, {} corridors of the field",
               counters.bytes_sent, counters.bytes_received, counters.frames_lost,
               agent.corridors());
  agent.say_goodbye();
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("The onboard agent: senses, maps, drives to goals, streams its map to the server.",
               "cairn-agent");
  Options options;
  describe(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  spdlog::set_default_logger(spdlog::stderr_color_mt("cairn-agent"));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
  spdlog::set_level(spdlog::level::from_str(options.log_level));
  std::signal(SIGINT, [](int) { stop_asked = true; });
  std::signal(SIGTERM, [](int) { stop_asked = true; });
  std::signal(SIGXFSZ, SIG_IGN);  // A file that may not grow is the spool's to report.
  if (Status result = run(options); !result) {
    std::cerr << "cairn-agent: " << result.error().message << '\n';
    return 1;
  }
  return 0;
}
