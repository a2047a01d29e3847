// The link on the wire: bytes as the emulator counts them, IP headers included, both ways.
//   bench_link [--seeds N] [--outage SECONDS] [--trials N] [--only PART]
// First contact, a standing robot and mapping run the real programs over the emulated radio, on
// each carrier; a thousand stops and outages run in virtual time over the same channels.

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "tests/bench/link_convergence.h"
#include "tests/bench/link_virtual.h"
#include "tests/bench/report.h"
#include "tests/support/emulated_site.h"

namespace {

using namespace std::chrono_literals;
using cairn::bench::Better;
using cairn::bench::Figure;
using cairn::bench::Report;
using cairn::bench::VirtualLink;
using cairn::test::CarrierKind;
using cairn::test::ChannelConfig;
using cairn::test::EmulatedSite;

struct Options {
  int seeds = 3;
  int outage_s = 60;
  int trials = 1'000;
  std::string only;  ///< One of `main`'s parts; empty: all.
};

ChannelConfig radio(double rate_bit_s, double loss) {
  return {.rate_bit_s = rate_bit_s, .queue = 4s, .delay = 300ms, .loss = loss};
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return -1.0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

/// A server with a site, and an agent; null when the system has no emulator.
std::unique_ptr<EmulatedSite> start(std::uint64_t seed, CarrierKind carrier,
                                    const ChannelConfig& config,
                                    const std::vector<std::string>& agent) {
  auto site = EmulatedSite::create(seed, carrier, config);
  if (!site) {
    std::cout << "skipped: " << site.error().message << '\n';
    return nullptr;
  }
  if (!(*site)->start_server() || (*site)->cairn({"found", "lab"}).exit_code != 0) return nullptr;
  (*site)->start_agent(agent);
  return std::move(*site);
}

const std::vector<std::string> kStanding{"--world", "room", "--site", "lab", "--start-unknown"};

/// Seconds since the first packet until the server knows where the robot is, and bytes until then.
struct Contact {
  double seconds = 0.0;
  double bytes = 0.0;
};

std::optional<Contact> first_contact(std::uint64_t seed, CarrierKind carrier, double loss) {
  const auto site = start(seed, carrier, radio(9'600, loss), kStanding);
  if (!site) return std::nullopt;
  auto& link = site->link();
  if (!cairn::test::eventually([&] { return link.counters().offered_bytes() > 0; }, 30s)) {
    return std::nullopt;
  }
  // The server says so itself, the moment the pose is there.
  if (!site->server().wait_for_output("first pose", 120s)) return std::nullopt;
  const auto first = std::min(link.counters().up.first_offered, link.counters().down.first_offered);
  return Contact{static_cast<double>((link.age() - first).count()) * 1e-9,
                 static_cast<double>(link.counters().offered_bytes())};
}

void measure_first_contact(const Options& options, Report& report) {
  for (const double loss : {0.0, 0.3}) {
    for (const CarrierKind carrier : {CarrierKind::udp, CarrierKind::dds}) {
      std::vector<double> seconds;
      std::vector<double> bytes;
      for (int seed = 1; seed <= options.seeds; ++seed) {
        const auto contact = first_contact(static_cast<std::uint64_t>(seed), carrier, loss);
        if (!contact) continue;
        seconds.push_back(contact->seconds);
        bytes.push_back(contact->bytes);
      }
      const std::string name = std::string(to_string(carrier)) + ", 9.6 kbit/s, loss " +
                               std::to_string(static_cast<int>(loss * 100)) + " %";
      const bool ours = carrier == CarrierKind::udp;
      Figure time{.name = "first pose, " + name, .value = quantile(seconds, 0.5), .unit = "s"};
      Figure cost{.name = "bytes until then, " + name, .value = quantile(bytes, 0.5), .unit = "B"};
      if (ours) time.goal = loss > 0.0 ? 4.0 : 1.5;
      if (ours && loss == 0.0) cost.goal = 1'000.0;
      report.add(time);
      report.add(cost);
    }
  }
}

double bit_rate_over(EmulatedSite& site, std::chrono::seconds length) {
  const auto before = site.link().counters().offered_bytes();
  const auto begun = site.link().age();
  (void)cairn::test::eventually([] { return false; }, length);
  const double took = static_cast<double>((site.link().age() - begun).count()) * 1e-9;
  return static_cast<double>(site.link().counters().offered_bytes() - before) * 8.0 / took;
}

bool known(EmulatedSite& site) {
  return cairn::test::eventually([&] { return site.robot().is_object(); }, 90s);
}

void measure_standing(Report& report) {
  for (const CarrierKind carrier : {CarrierKind::udp, CarrierKind::dds}) {
    const auto site = start(7, carrier, radio(64'000, 0.0), kStanding);
    if (!site || !known(*site)) continue;
    (void)bit_rate_over(*site, 20s);
    Figure figure{
        .name = std::string("a robot that stands and maps nothing, ") + to_string(carrier),
        .value = bit_rate_over(*site, 80s),
        .unit = "bit/s"};
    if (carrier == CarrierKind::udp) figure.goal = 100.0;
    report.add(figure);
  }
}

/// [m2] Of the site, mapped at the server.
double known_m2(const EmulatedSite& site) {
  const auto finished = site.cairn({"status", "--json"});
  const auto status = nlohmann::json::parse(finished.output, nullptr, false);
  constexpr double kCellM2 = 0.125 * 0.125;
  return status.is_object() ? status["sites"][0].value("known_cells", 0.0) * kCellM2 : 0.0;
}

void measure_mapping(Report& report) {
  for (const CarrierKind carrier : {CarrierKind::udp, CarrierKind::dds}) {
    const auto site = start(9, carrier, radio(64'000, 0.0),
                            {"--world", "block", "--site", "lab", "--max-speed", "1"});
    if (!site || !known(*site)) continue;
    (void)bit_rate_over(*site, 10s);  // What is seen from the start.
    (void)site->cairn({"explore"});
    const double before_m2 = known_m2(*site);
    Figure figure{.name = std::string("mapping new ground in block, ") + to_string(carrier),
                  .value = bit_rate_over(*site, 60s) * 1e-3,
                  .unit = "kbit/s"};
    if (carrier == CarrierKind::udp) figure.goal = 10.0;
    report.add(figure);
    report.add({.name = std::string("ground gained in that minute, ") + to_string(carrier),
                .value = known_m2(*site) - before_m2,
                .unit = "m2"});
  }
}

/// Round and round in a room that an earlier run of the agent mapped.
void measure_patrol(Report& report) {
  const std::vector<std::string> robot{"--world", "room", "--site", "lab"};
  const std::vector<std::string> round{"goto",    "10.5,2.5", "10.5,10.5", "2.5,10.5",
                                       "2.5,2.5", "--loop",   "--expires", "3600"};
  for (const CarrierKind carrier : {CarrierKind::udp, CarrierKind::dds}) {
    const auto site = start(11, carrier, radio(64'000, 0.0), robot);
    if (!site || !known(*site)) continue;
    (void)site->cairn(round);
    (void)bit_rate_over(*site, 100s);
    site->start_agent(robot);  // Where it was first switched on.
    // The old session still counts as present: the new run is let in once it has been silent.
    if (!site->agent().wait_for_output("connected to the server", 90s)) continue;
    (void)bit_rate_over(*site, 5s);
    (void)site->cairn(round);
    (void)bit_rate_over(*site, 60s);
    Figure figure{.name = std::string("patrol of known ground, ") + to_string(carrier),
                  .value = bit_rate_over(*site, 75s) * 1e-3,
                  .unit = "kbit/s"};
    if (carrier == CarrierKind::udp) figure.goal = 1.2;
    report.add(figure);
  }
}

constexpr std::size_t kUdpOverhead = 44;
constexpr std::size_t kDdsOverhead = 92;

void measure_stops(const Options& options, Report& report) {
  for (const auto& [name, overhead] : {std::pair{"udp", kUdpOverhead}, {"dds", kDdsOverhead}}) {
    VirtualLink link(21, radio(32'000, 0.2), overhead);
    link.set_load(true);
    link.run(60s);
    std::vector<double> there;
    std::vector<double> back;
    for (int i = 0; i < options.trials; ++i) {
      const auto delays = link.stop();
      there.push_back(delays ? delays->there_s : 60.0);
      back.push_back(delays ? delays->there_and_back_s : 60.0);
      link.run(2s);
    }
    const std::string what = std::string(", ") + name + ", map both ways, 32 kbit/s, loss 20 %";
    Figure p50{.name = "stop at the robot p50" + what, .value = quantile(there, 0.5), .unit = "s"};
    Figure p99{.name = "stop at the robot p99" + what, .value = quantile(there, 0.99), .unit = "s"};
    if (overhead == kUdpOverhead) p50.goal = 0.6 + 0.15;
    if (overhead == kUdpOverhead) p99.goal = 4 * 0.6;
    report.add(p50);
    report.add(p99);
    report.add({.name = "stop confirmed p50" + what, .value = quantile(back, 0.5), .unit = "s"});
    report.add({.name = "stop confirmed p99" + what, .value = quantile(back, 0.99), .unit = "s"});
  }
}

void measure_outage(const Options& options, Report& report) {
  for (const double rate : {9'600.0, 64'000.0}) {
    VirtualLink link(31, radio(rate, 0.0), kUdpOverhead);
    link.set_load(true);
    link.run(20s);
    link.set_load(false);
    for (int i = 0; i < 600 && !link.synchronised(); ++i) link.run(1s);
    const auto recovery = link.outage(std::chrono::seconds(options.outage_s), 10);
    const std::string name = std::to_string(options.outage_s) + " s away, 10 scans seen, " +
                             std::to_string(static_cast<int>(rate)) + " bit/s";
    Figure time{.name = "in step again, " + name, .value = recovery.seconds, .unit = "s"};
    Figure cost{.name = "bytes for that, " + name,
                .value = static_cast<double>(recovery.bytes),
                .unit = "B"};
    if (options.outage_s == 60 && rate < 10'000.0) {
      time.goal = 5.0;
      cost.goal = 8'000.0;
    }
    report.add(time);
    report.add(cost);
  }
}

void measure_staleness(Report& report) {
  std::vector<double> mean_s;
  for (const double loss : {0.0, 0.2}) {
    VirtualLink link(41, radio(64'000, loss), kUdpOverhead);
    link.run(5s);
    mean_s.push_back(link.mean_staleness_s(1000s));
    report.add({.name = "age of the server's copy, 64 kbit/s, loss " +
                        std::to_string(static_cast<int>(loss * 100)) + " %",
                .value = mean_s.back(),
                .unit = "s"});
  }
  report.add({.name = "the same, above loss-free",
              .value = mean_s.back() - mean_s.front(),
              .unit = "s",
              .goal = 0.15});
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i];
    if (name == "--seeds") options.seeds = std::atoi(argv[i + 1]);
    if (name == "--outage") options.outage_s = std::atoi(argv[i + 1]);
    if (name == "--trials") options.trials = std::atoi(argv[i + 1]);
    if (name == "--only") options.only = argv[i + 1];
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  Report report("link");
  const auto part = [&](const char* name, const auto& measure) {
    if (options.only.empty() || options.only == name) measure();
  };
  part("stops", [&] { measure_stops(options, report); });
  part("outage", [&] { measure_outage(options, report); });
  part("staleness", [&] { measure_staleness(report); });
  part("convergence", [&] { cairn::bench::measure_convergence(report); });
  part("contact", [&] { measure_first_contact(options, report); });
  part("standing", [&] { measure_standing(report); });
  part("mapping", [&] { measure_mapping(report); });
  part("patrol", [&] { measure_patrol(report); });
  report.print(std::cout);
  return 0;
}
