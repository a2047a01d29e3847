#include "tests/support/link_emulator/emulator.h"

#include <poll.h>
#include <sched.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

namespace cairn::test {
namespace {

constexpr int kMostAtOnce = 64;  ///< [packets] Taken from a device before the other has its turn.

bool is_ipv4(const Channel::Packet& packet) { return !packet.empty() && packet[0] >> 4U == 4; }

timespec until(LinkTime wait) {
  const auto ns = std::max<LinkTime::rep>(0, wait.count());
  return {.tv_sec = ns / 1'000'000'000, .tv_nsec = ns % 1'000'000'000};
}

/// Delays stay true on a loaded machine; where that is not allowed they are a little less so.
void be_punctual() {
  prctl(PR_SET_TIMERSLACK, 1UL);
  const sched_param urgent{.sched_priority = 1};
  (void)sched_setscheduler(0, SCHED_RR, &urgent);
}

}  // namespace

Result<std::unique_ptr<LinkEmulator>> LinkEmulator::create(std::uint64_t seed,
                                                           const ChannelConfig& up,
                                                           const ChannelConfig& down) {
  auto robot = NetworkNamespace::create(kRobotAddress);
  if (!robot) return robot.error();
  auto base = NetworkNamespace::create(kBaseAddress);
  if (!base) return base.error();
  return std::unique_ptr<LinkEmulator>(
      new LinkEmulator(std::move(robot).value(), std::move(base).value(), seed, up, down));
}

LinkEmulator::LinkEmulator(NetworkNamespace robot, NetworkNamespace base, std::uint64_t seed,
                           const ChannelConfig& up, const ChannelConfig& down)
    : robot_(std::move(robot)),
      base_(std::move(base)),
      stop_(eventfd(0, EFD_CLOEXEC)),
      up_(2 * seed, up),
      down_(2 * seed + 1, down),
      thread_([this] { run(); }) {}

LinkEmulator::~LinkEmulator() {
  const std::uint64_t one = 1;
  (void)!write(stop_, &one, sizeof one);
  thread_.join();
  close(stop_);
}

LinkTime LinkEmulator::age() const { return std::chrono::steady_clock::now() - start_; }

void LinkEmulator::set(const ChannelConfig& up, const ChannelConfig& down) {
  const std::lock_guard lock(mutex_);
  up_.set(up);
  down_.set(down);
}

LinkEmulator::Counters LinkEmulator::counters() const {
  const std::lock_guard lock(mutex_);
  return {up_.counters(), down_.counters()};
}

nlohmann::json LinkEmulator::json() const {
  const Counters now = counters();
  return {{"up", to_json(now.up)}, {"down", to_json(now.down)}};
}

void LinkEmulator::take(int device, Channel& channel) {
  Channel::Packet buffer(65'536);
  for (int i = 0; i < kMostAtOnce; ++i) {
    const ssize_t size = read(device, buffer.data(), buffer.size());
    if (size <= 0) return;
    Channel::Packet packet(buffer.begin(), buffer.begin() + size);
    // The kernel's own IPv6 chatter is not the programs'.
    if (is_ipv4(packet)) channel.offer(std::move(packet), age());
  }
}

void LinkEmulator::give(Channel& channel, int device) {
  while (const auto packet = channel.receive(age())) {
    (void)!write(device, packet->data(), packet->size());  // The kernel refuses damaged headers.
  }
}

void LinkEmulator::run() {
  be_punctual();
  std::array<pollfd, 3> waiting{{{.fd = robot_.device(), .events = POLLIN, .revents = 0},
                                 {.fd = base_.device(), .events = POLLIN, .revents = 0},
                                 {.fd = stop_, .events = POLLIN, .revents = 0}}};
  while (waiting[2].revents == 0) {
    LinkTime next = std::chrono::seconds(1);
    {
      const std::lock_guard lock(mutex_);
      take(robot_.device(), up_);
      take(base_.device(), down_);
      give(up_, base_.device());
      give(down_, robot_.device());
      for (const Channel* channel : {&up_, &down_}) {
        if (const auto at = channel->next_arrival()) next = std::min(next, *at - age());
      }
    }
    const timespec timeout = until(next);
    (void)ppoll(waiting.data(), waiting.size(), &timeout, nullptr);
  }
}

}  // namespace cairn::test
