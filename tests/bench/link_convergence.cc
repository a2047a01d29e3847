#include "tests/bench/link_convergence.h"

#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include "tests/bench/virtual_site.h"
#include "tests/support/process.h"

namespace cairn::bench {
namespace {

using namespace std::chrono_literals;

constexpr double kRateBitS = 64'000.0;
constexpr double kRoundTripS = 0.6;
constexpr std::uint64_t kSeed = 51;
const std::vector<Eigen::Vector2d> kRound{{10.5, 2.5}, {10.5, 10.5}, {2.5, 10.5}, {2.5, 2.5}};

test::ChannelConfig radio(double loss) {
  return {.rate_bit_s = kRateBitS, .queue = 4s, .delay = 300ms, .loss = loss};
}

/// What happens while the robot drives.
struct Misfortune {
  std::string name;
  test::ChannelConfig radio = bench::radio(0.0);
  /// Done once, after `at` of driving; returns when the link is back.
  std::function<void(VirtualSite&)> event = [](VirtualSite&) {};
  Duration at = 20s;
};

struct Outcome {
  bool same = false;
  double seconds = 0.0;      ///< Since the drive ended, or the link came back.
  std::uint64_t bytes = 0;   ///< In all, both ways.
  std::uint64_t behind = 0;  ///< [B] Of `bytes`, up, in those seconds.
};

Outcome drive(const Misfortune& misfortune) {
  const test::TempFolder folder;
  VirtualSite site({.seed = kSeed, .radio = misfortune.radio, .spool = true}, folder.path());
  site.run(5s);
  site.steer_along(kRound);
  site.run(misfortune.at);
  misfortune.event(site);
  (void)site.run_until([&] { return !site.steering(); }, 300s);
  site.finish();
  const MonotonicTime ended = site.now();
  const std::uint64_t up = site.bytes().up;
  Outcome outcome;
  outcome.same = site.run_until([&] { return site.in_step(); }, 600s);
  outcome.seconds = to_seconds(site.now() - ended);
  outcome.bytes = site.bytes().up + site.bytes().down;
  outcome.behind = site.bytes().up - up;
  return outcome;
}

void away(VirtualSite& site, Duration length) {
  test::ChannelConfig gone = radio(0.0);
  gone.outages = {{site.now(), site.now() + length}};
  site.set_radio(gone);
  site.run(length);
}

std::vector<Misfortune> misfortunes() {
  test::ChannelConfig bursts = radio(0.0);
  bursts.burst_begin = 0.02;
  bursts.burst_end = 0.2;
  return {
      {.name = "loss-free"},
      {.name = "loss 10 %", .radio = radio(0.1)},
      {.name = "loss 20 %", .radio = radio(0.2)},
      {.name = "loss 30 %", .radio = radio(0.3)},
      {.name = "bursts of 5, 9 %", .radio = bursts},
      {.name = "60 s away", .event = [](VirtualSite& site) { away(site, 60s); }},
      {.name = "10 min away", .event = [](VirtualSite& site) { away(site, 600s); }},
      {.name = "server killed", .event = [](VirtualSite& site) { site.restart_server(); }},
      {.name = "agent killed", .event = [](VirtualSite& site) { site.restart_agent(); }},
  };
}

}  // namespace

void measure_convergence(Report& report) {
  double loss_free = 0.0;
  for (const Misfortune& misfortune : misfortunes()) {
    const Outcome outcome = drive(misfortune);
    if (loss_free == 0.0) loss_free = static_cast<double>(outcome.bytes);
    report.add({.name = "both maps the same: " + misfortune.name,
                .value = outcome.same ? 1.0 : 0.0,
                .unit = "",
                .better = Better::higher,
                .goal = 1.0});
    const double outstanding_s = static_cast<double>(outcome.behind) * 8.0 / kRateBitS;
    report.add({.name = "the last of it after: " + misfortune.name,
                .value = outcome.seconds,
                .unit = "s",
                .goal = outstanding_s * 1.3 + 3.0 * kRoundTripS});
    Figure bytes{.name = "bytes, of loss-free: " + misfortune.name,
                 .value = static_cast<double>(outcome.bytes) / loss_free,
                 .unit = "x"};
    if (misfortune.name == "loss 20 %") bytes.goal = 1.3;
    report.add(bytes);
  }
  report.add({.name = "bytes of the loss-free drive", .value = loss_free, .unit = "B"});
}

}  // namespace cairn::bench
