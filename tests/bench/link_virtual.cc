#include "tests/bench/link_virtual.h"

#include <algorithm>

namespace cairn::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Duration kStep = milliseconds(5);  ///< How finely time passes while nothing is due.

test::LinkTime link_time(MonotonicTime time) { return time; }

proto::MapOffer some_map(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Tile tile(1000);
  for (int i = 0; i < 2'000; ++i) {
    tile.set(
        static_cast<int>(random() % Tile::kCells),
        {1000 + static_cast<int>(random() % 500), static_cast<std::uint8_t>(1 + random() % 255)});
  }
  proto::MapOffer offer;
  offer.tiles.push_back({{0, 1, 1}, PackedTile::pack(tile), 1});
  return offer;
}

}  // namespace

VirtualLink::VirtualLink(std::uint64_t seed, const test::ChannelConfig& radio,
                         std::size_t overhead_bytes)
    : overhead_(overhead_bytes),
      radio_(radio),
      up_(4 * seed, radio),
      down_(4 * seed + 1, radio),
      server_(4 * seed + 2, milliseconds(20)),
      robot_({.robot = "rover", .site = "quarry", .boot = 0xB007}, overhead_bytes),
      mapper_(4 * seed + 3) {}

void VirtualLink::set(const test::ChannelConfig& radio) {
  radio_ = radio;
  up_.set(radio);
  down_.set(radio);
}

std::uint64_t VirtualLink::offered_bytes() const {
  return up_.counters().offered.bytes + down_.counters().offered.bytes;
}

void VirtualLink::carry(test::Channel& channel, const std::vector<std::uint8_t>& frame) {
  std::vector<std::uint8_t> packet = frame;
  packet.resize(frame.size() + overhead_);  // Headers, at the wrong end: only their length counts.
  channel.offer(std::move(packet), link_time(now_));
}

void VirtualLink::make_load() {
  if (!load_ || now_ < load_due_) return;
  load_due_ = now_ + milliseconds(100);
  for (int i = 0; i < 4; ++i) mapper_.see(robot_.evidence());
  if (mapper_.between(0, 99) == 0) mapper_.close(robot_.evidence());
  mapper_.closed.clear();
  if (server_.link && server_.link->map().idle()) {
    server_.link->map().offer(some_map(static_cast<std::uint64_t>(now_.count())));
  }
}

void VirtualLink::step() {
  while (auto packet = up_.receive(link_time(now_))) {
    packet->resize(packet->size() - overhead_);
    server_.on_frame(*packet, now_);
  }
  while (auto packet = down_.receive(link_time(now_))) {
    packet->resize(packet->size() - overhead_);
    for (auto& order : robot_.on_frame(*packet, now_)) orders_.push_back(std::move(order));
  }
  (void)robot_.take_map_updates();
  make_load();
  proto::PoseReport pose;
  pose.clock_ms = static_cast<std::uint64_t>(now_ / milliseconds(1));
  pose.T_site_robot.x_mm = static_cast<std::int32_t>(pose.clock_ms);
  robot_.set_pose(pose);
  while (const auto frame = robot_.next_frame(now_)) carry(up_, *frame);
  while (const auto frame = server_.next_frame(now_)) carry(down_, *frame);
}

MonotonicTime VirtualLink::next_event() const {
  MonotonicTime next = std::min(robot_.next_due(now_), server_.next_due(now_));
  for (const test::Channel* channel : {&up_, &down_}) {
    if (const auto at = channel->next_arrival()) {
      next = std::min(next, std::chrono::ceil<MonotonicTime>(*at));
    }
  }
  return std::clamp(next, now_ + Duration(1), now_ + kStep);
}

void VirtualLink::run(Duration length) {
  for (const MonotonicTime end = now_ + length; now_ < end; now_ = next_event()) step();
}

std::optional<VirtualLink::StopDelays> VirtualLink::stop() {
  if (!server_.link) return std::nullopt;
  proto::Command command;
  command.id = ++commands_;
  command.kind = proto::CommandKind::stop;
  const MonotonicTime said = now_;
  server_.link->command(command, {}, seconds(60), now_);
  StopDelays delays;
  bool there = false;
  for (; now_ < said + seconds(60); now_ = next_event()) {
    step();
    if (!there && !orders_.empty() && orders_.back().command.id == commands_) {
      there = true;
      delays.there_s = to_seconds(now_ - said);
      robot_.report({commands_, 0, proto::CommandState::stopped, ""});
    }
    if (!server_.reports.empty() && server_.reports.back().command == commands_) {
      delays.there_and_back_s = to_seconds(now_ - said);
      return delays;
    }
  }
  return std::nullopt;
}

VirtualLink::Recovery VirtualLink::outage(Duration length, int changes) {
  test::ChannelConfig away = radio_;
  away.outages = {{link_time(now_), link_time(now_ + length)}};
  up_.set(away);
  down_.set(away);
  const MonotonicTime back = now_ + length;
  for (int i = 0; i < changes; ++i) mapper_.see(robot_.evidence());
  run(length);
  const std::uint64_t before = offered_bytes();
  while (!synchronised() && now_ < back + seconds(600)) {
    step();
    now_ = next_event();
  }
  return {to_seconds(now_ - back), offered_bytes() - before};
}

double VirtualLink::mean_staleness_s(Duration length) {
  constexpr CellIndex kCell{3, 3};
  const MonotonicTime end = now_ + length;
  std::vector<MonotonicTime> written;
  std::uint32_t sequence = 0;
  double sum_s = 0.0;
  int samples = 0;
  for (int value = 1; now_ < end; ++value) {
    written.push_back(now_);
    proto::EvidenceSender& evidence = robot_.evidence();
    if (evidence.open_submap() == nullptr) sequence = evidence.begin(0xB007, {}, 125).id.sequence;
    (void)evidence.open_submap()->surface.set(kCell, {value, 200});
    evidence.touch(EvidenceLayer::surface, {kCell});
    run(milliseconds(100));
    const auto held = server_.store.find(sequence);
    const int there = held == server_.store.end() ? 0 : held->second.surface.cell(kCell).height_mm;
    if (there == 0) continue;
    sum_s += to_seconds(now_ - written[static_cast<std::size_t>(there - 1)]);
    ++samples;
  }
  return samples == 0 ? -1.0 : sum_s / samples;
}

}  // namespace cairn::bench
