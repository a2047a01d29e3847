#include "tests/bench/virtual_site.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/common/angle.h"
#include "core/planner/plan.h"
#include "robot_agent/input/simulator.h"
#include "server/mission/corridors.h"
#include "server/mission/planning.h"

namespace cairn::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Duration kTick = milliseconds(10);         ///< How often the agent looks at the link …
constexpr Duration kAgentPeriod = milliseconds(50);  ///< … and at its instruments.
constexpr Duration kValid = std::chrono::hours(1);

std::int32_t to_mm(double m) { return static_cast<std::int32_t>(std::lround(m * 1000.0)); }

std::unique_ptr<agent::Input> make_input(const VirtualSite::Config& config) {
  agent::SimulatorConfig simulator;
  simulator.world = config.world;
  simulator.seed = config.seed;
  return agent::make_simulator(simulator).value();
}

}  // namespace

VirtualSite::VirtualSite(const Config& config, std::filesystem::path folder)
    : config_(config),
      folder_(std::move(folder)),
      up_(config.seed * 2 + 1, config.radio),
      down_(config.seed * 2 + 2, config.radio),
      server_(folder_, config.seed, config.overhead_bytes),
      input_(make_input(config)),
      instruments_(*input_),
      carrier_(*this) {
  start_agent();
}

void VirtualSite::restart_agent() {
  agent_.reset();
  spool_.reset();
  under_way_ = false;
  instruments_.start_at(input_->truth()->T_site_robot);
  start_agent();
}

void VirtualSite::start_agent() {
  agent::AgentConfig agent;
  agent.link.robot = "r1";
  agent.link.site = "lab";
  agent.link.boot = ++boot_;
  agent.driver.follower.max_speed_m_s = config_.max_speed_m_s;
  if (config_.spool) {
    agent::SpoolConfig spool;
    spool.folder = folder_ / "spool";
    spool.owner = {"r1", "lab", agent.mapper.cell_size_mm};
    spool.coarseness = agent.mapper.coarseness;
    spool_ = std::make_unique<agent::Spool>(spool, boot_);
  }
  agent_ = std::make_unique<agent::Agent>(agent, instruments_, carrier_, spool_.get());
}

Status VirtualSite::Carrier::send(const proto::Datagram& frame) {
  std::vector<std::uint8_t> packet = frame.bytes;
  packet.resize(packet.size() + site_.config_.overhead_bytes);
  site_.up_.offer(std::move(packet), site_.now_);
  return {};
}

Result<std::optional<proto::Datagram>> VirtualSite::Carrier::receive(milliseconds /*timeout*/) {
  auto packet = site_.down_.receive(site_.now_);
  if (!packet) return std::optional<proto::Datagram>{};
  packet->resize(packet->size() - site_.config_.overhead_bytes);
  return std::optional(proto::Datagram{{}, *std::move(packet)});
}

void VirtualSite::step() {
  while (auto packet = up_.receive(now_)) {
    packet->resize(packet->size() - config_.overhead_bytes);
    server_.on_frame(*packet, now_);
  }
  order_next();
  while (auto frame = server_.next_frame(now_)) {
    frame->resize(frame->size() + config_.overhead_bytes);
    down_.offer(*std::move(frame), now_);
  }
  if (now_ >= agent_step_ && !finished_) {
    agent_step_ = now_ + kAgentPeriod;
    steer();
    (void)agent_->step(now_ - input_begun_, now_);
  }
  (void)agent_->exchange(now_, milliseconds(0));
}

void VirtualSite::steer_along(std::vector<Eigen::Vector2d> places_m) {
  steer_to_m_.assign(places_m.begin(), places_m.end());
  instruments_.steered = true;
}

void VirtualSite::steer() {
  if (!instruments_.steered) return;
  const Pose at = input_->truth()->T_site_robot;
  while (!steer_to_m_.empty() &&
         (steer_to_m_.front() - Eigen::Vector2d(at.x_m, at.y_m)).norm() < 0.2) {
    steer_to_m_.pop_front();
  }
  if (steer_to_m_.empty()) return input_->drive({});
  const Eigen::Vector2d way = steer_to_m_.front() - Eigen::Vector2d(at.x_m, at.y_m);
  const double turn_rad = wrap_angle(std::atan2(way.y(), way.x()) - at.yaw_rad);
  const bool ahead = std::abs(turn_rad) < 0.4;
  input_->drive({ahead ? config_.max_speed_m_s : 0.0, std::clamp(2.0 * turn_rad, -0.8, 0.8)});
}

bool VirtualSite::in_step() {
  if (!agent_->delivered() || server_.link() == nullptr || !server_.link()->map().idle()) {
    return false;
  }
  server_.world().publish();
  const auto held = server_.world().snapshot();
  const HeightMap& map = agent_->mapper().replica().now();
  const auto known = std::ranges::count_if(
      map.tiles(), [](const auto& entry) { return entry.second->known_count() > 0; });
  return static_cast<std::size_t>(known) == held->tiles.size() &&
         std::ranges::all_of(held->tiles, [&](const auto& entry) {
           const Tile* own = map.find(entry.first);
           return own != nullptr && *own == entry.second->unpack();
         });
}

void VirtualSite::order_next() {
  const auto& reports = server_.reports();
  for (; reports_seen_ < reports.size(); ++reports_seen_) {
    const proto::CommandReport& report = reports[reports_seen_];
    if (report.command != command_ || report.state == proto::CommandState::accepted) continue;
    under_way_ = false;
    if (report.state != proto::CommandState::arrived) continue;
    next_place_ = (next_place_ + 1) % places_m_.size();
    if (next_place_ == 0) ++rounds_;
  }
  if (under_way_ || places_m_.empty() || server_.link() == nullptr || !server_.pose()) return;
  if (server_.link()->boot() != boot_) return;
  server_.world().publish();
  const Eigen::Vector2d goal_m = places_m_[next_place_];
  const auto path = path_to(goal_m);
  if (path.empty()) return;
  proto::Command command;
  command.id = ++command_;
  command.kind = proto::CommandKind::go_to;
  command.issuer = "bench";
  command.link_timeout_ms = 5'000;
  command.goal_x_mm = to_mm(goal_m.x());
  command.goal_y_mm = to_mm(goal_m.y());
  server_.link()->command(command, path, kValid, now_);
  under_way_ = true;
}

std::vector<std::uint8_t> VirtualSite::path_to(const Eigen::Vector2d& goal_m) {
  const auto& at = server_.pose()->T_site_robot;
  const Eigen::Vector2d start_m(at.x_mm * 1e-3, at.y_mm * 1e-3);
  const auto map = server_.world().snapshot();
  PlannerConfig planner;
  planner.unknown = UnknownGround::allowed;
  auto grid =
      server::drivable_grid(*map, {start_m, goal_m}, planner, SensorModel{}.min_probability);
  if (!grid) return {};
  const Path path = plan(*grid, {.start_m = start_m, .goal_m = goal_m}, planner);
  if (path.status != PathStatus::complete) return {};
  return server::to_wire(path.points_m, agent_->mapper().cell_size_mm()).bytes;
}

void VirtualSite::finish() {
  agent_->finish();
  finished_ = true;
}

void VirtualSite::run(Duration length) {
  (void)run_until([] { return false; }, length);
}

bool VirtualSite::run_until(const std::function<bool()>& done, Duration limit) {
  for (const MonotonicTime end = now_ + limit; now_ < end; now_ += kTick) {
    if (done()) return true;
    step();
  }
  return done();
}

void VirtualSite::set_radio(const test::ChannelConfig& radio) {
  up_.set(radio);
  down_.set(radio);
}

VirtualSite::Bytes VirtualSite::bytes() const {
  return {up_.counters().offered.bytes, down_.counters().offered.bytes};
}

}  // namespace cairn::bench
