#include "tests/support/link_emulator/channel.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace cairn::test {
namespace {

nlohmann::json to_json(const PacketCount& count) {
  return {{"packets", count.packets}, {"bytes", count.bytes}};
}

LinkTime from_seconds(double s) { return LinkTime(std::llround(s * 1e9)); }

}  // namespace

nlohmann::json to_json(const ChannelCounters& counters) {
  return {{"offered", to_json(counters.offered)},
          {"delivered", to_json(counters.delivered)},
          {"lost", to_json(counters.lost)},
          {"queue_dropped", to_json(counters.queue_dropped)},
          {"outage_dropped", to_json(counters.outage_dropped)},
          {"duplicated", to_json(counters.duplicated)},
          {"damaged", to_json(counters.damaged)},
          {"longest_queue_s", static_cast<double>(counters.longest_queue.count()) * 1e-9}};
}

void Channel::offer(Packet packet, LinkTime now) {
  const std::size_t size = packet.size();
  counters_.offered.add(size);
  counters_.first_offered = std::min(counters_.first_offered, now);
  const LinkTime starts = std::max(now, free_at_);
  const LinkTime waits = starts - now;
  if (config_.rate_bit_s > 0.0 && waits > config_.queue) {
    counters_.queue_dropped.add(size);
    return;
  }
  counters_.longest_queue = std::max(counters_.longest_queue, waits);
  const LinkTime takes = config_.rate_bit_s > 0.0
                             ? from_seconds(static_cast<double>(size) * 8.0 / config_.rate_bit_s)
                             : LinkTime{};
  const LinkTime sent = free_at_ = starts + takes;
  if (out(starts) || out(sent)) {
    counters_.outage_dropped.add(size);
    return;
  }
  if (lose()) {
    counters_.lost.add(size);
    return;
  }
  damage(packet);
  if (chance(config_.duplicate)) {
    counters_.duplicated.add(size);
    flying_.push({arrival(sent), offered_++, packet});
  }
  flying_.push({arrival(sent), offered_++, std::move(packet)});
}

bool Channel::out(LinkTime at) const {
  return std::ranges::any_of(config_.outages, [&](const auto& outage) {
    return at >= outage.first && at < outage.second;
  });
}

bool Channel::lose() {
  if (chance(config_.loss)) return true;
  if (config_.burst_begin <= 0.0) return false;
  const bool lost = in_burst_ || chance(config_.burst_begin);
  in_burst_ = lost && !chance(config_.burst_end);
  return lost;
}

void Channel::damage(Packet& packet) {
  if (config_.bit_error <= 0.0) return;
  // Distances between wrong bits are geometric: one draw for each, not one for each bit.
  std::geometric_distribution<std::uint64_t> distance(config_.bit_error);
  bool damaged = false;
  for (std::uint64_t bit = distance(random_); bit < packet.size() * 8;
       bit += 1 + distance(random_)) {
    packet[bit / 8] = static_cast<std::uint8_t>(packet[bit / 8] ^ (1U << (bit % 8)));
    damaged = true;
  }
  if (damaged) counters_.damaged.add(packet.size());
}

LinkTime Channel::arrival(LinkTime sent) {
  LinkTime at = sent + config_.delay;
  if (config_.jitter.count() > 0) {
    at +=
        LinkTime(std::uniform_int_distribution<LinkTime::rep>(0, config_.jitter.count())(random_));
  }
  if (!config_.reorder) at = std::max(at, last_arrival_);
  last_arrival_ = std::max(last_arrival_, at);
  return at;
}

std::optional<Channel::Packet> Channel::receive(LinkTime now) {
  if (flying_.empty() || flying_.top().at > now) return std::nullopt;
  Packet packet = flying_.top().packet;
  flying_.pop();
  counters_.delivered.add(packet.size());
  return packet;
}

std::optional<LinkTime> Channel::next_arrival() const {
  if (flying_.empty()) return std::nullopt;
  return flying_.top().at;
}

}  // namespace cairn::test
