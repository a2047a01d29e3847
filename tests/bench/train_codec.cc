// Trains the priors that every patch begins with (proto/codec/patch_priors_table.inc) on simulated
// drives. What is reported of the codec (bench_codec) uses other seeds.
//   train_codec FILE

#include <algorithm>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "proto/codec/patch.h"
#include "proto/codec/patch_priors.h"
#include "tests/bench/drive_deltas.h"

namespace {

using cairn::Coarseness;
using cairn::bench::Delta;
using cairn::bench::Drive;
using cairn::bench::DriveSetting;
using cairn::proto::Learning;
using cairn::proto::MixerState;
using cairn::proto::patch::blank_priors;

/// While statistics are gathered they rest on many bits: each then is near a mean.
constexpr Learning kGathering{.most_seen = 1000, .weight_rate = 6};
/// While weights are learned each packet begins with the statistics that it will begin with.
constexpr Learning kWeighing{.most_seen = 255, .weight_rate = 2};
/// A prior rests on at most so many bits, so that a packet's own count soon.
constexpr std::uint16_t kMostSeen = 10;

using Drives = std::vector<std::pair<DriveSetting, Drive>>;

bool add(Drives& drives, const DriveSetting& setting) {
  auto drive = cairn::bench::drive_deltas(setting);
  if (!drive) {
    std::cerr << drive.error().message << '\n';
    return false;
  }
  drives.emplace_back(setting, *std::move(drive));
  return true;
}

bool add(Drives& drives, const std::vector<std::uint64_t>& seeds) {
  for (const std::uint64_t seed : seeds) {
    for (const char* world : {"block", "hill", "room"}) {
      if (!add(drives, {.world = world, .seed = seed, .coarseness = {}})) return false;
    }
  }
  return true;
}

/// What a drive took.
struct Cost {
  double bytes = 0.0;
  double cells = 0.0;
};

/// Runs a drive's deltas through the coder, each against what was told before; `state` is given to
/// `before_each` first.
template <class BeforeEach>
Cost run(const Drive& drive, const Coarseness& coarseness, MixerState& state,
         const Learning& learning, const BeforeEach& before_each) {
  cairn::ContextImage image;
  Cost cost;
  std::uint8_t tick = 0;
  for (const Delta& delta : drive.deltas) {
    ++tick;
    before_each(state);
    const auto bytes =
        cairn::proto::write_patch_learning(delta, {1, tick}, coarseness, image, state, learning);
    cost.bytes += static_cast<double>(bytes.size());
    for (const auto& update : delta) {
      cost.cells += static_cast<double>(update.delta.changed.count());
      image.merge(update.sequence, told_block(update.key, update.version, update.delta), tick);
    }
  }
  return cost;
}

void gather(const Drives& drives, MixerState& state) {
  for (const auto& [setting, drive] : drives) {
    run(drive, setting.coarseness, state, kGathering, [](MixerState&) {});
  }
}

MixerState held_back(MixerState state) {
  for (auto& statistic : state.statistics) statistic.seen = std::min(statistic.seen, kMostSeen);
  return state;
}

/// The mean of the weights over all packets of drives that the statistics do not know: single
/// packets pull them to and fro.
std::vector<std::int32_t> weigh(const Drives& drives, const MixerState& gathered) {
  MixerState state = held_back(gathered);
  state.weights = blank_priors().weights;
  const auto priors = state.statistics;
  std::vector<double> sum;
  double packets = 0.0;
  constexpr int kPasses = 2;  // The first gets them there.
  for (int pass = 0; pass < kPasses; ++pass) {
    sum.assign(state.weights.size(), 0.0);
    packets = 0.0;
    for (const auto& [setting, drive] : drives) {
      run(drive, setting.coarseness, state, kWeighing, [&](MixerState& before) {
        before.statistics = priors;
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += before.weights[i];
        packets += 1.0;
      });
    }
  }
  std::vector<std::int32_t> mean;
  for (const double total : sum) mean.push_back(static_cast<std::int32_t>(total / packets));
  return mean;
}

void report(const Drives& drives, const MixerState& priors) {
  for (const auto& [setting, drive] : drives) {
    MixerState state;
    const Cost cost = run(drive, setting.coarseness, state, cairn::proto::kPacketLearning,
                          [&](MixerState& before) { before = priors; });
    std::cerr << setting.world << ' ' << setting.seed << ": " << 8.0 * cost.bytes / cost.cells
              << " bits a cell\n";
  }
}

bool write(const std::string& file, const MixerState& state) {
  constexpr std::size_t kLine = 96;
  std::ofstream out(file);
  const std::string text = cairn::proto::patch::priors_to_text(state);
  for (std::size_t at = 0; at < text.size(); at += kLine) {
    out << '"' << text.substr(at, kLine) << "\"\n";
  }
  return out.good();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: train_codec FILE\n";
    return 2;
  }
  Drives others;  // Exact values, told with and without common ground, lend a first guess.
  Drives known;
  Drives fresh;
  Drives check;
  DriveSetting exact{.world = "block", .seed = 121, .coarseness = cairn::kExact};
  exact.duration_s = 60.0;
  if (!add(others, exact) || !add(known, {101, 102, 104}) || !add(fresh, {103, 105}) ||
      !add(check, {106})) {
    return 1;
  }
  MixerState state = blank_priors();
  gather(others, state);
  gather(known, state);
  const auto weights = weigh(fresh, state);
  gather(fresh, state);
  gather(known, state);
  state = held_back(state);
  state.weights = weights;
  report(check, state);
  return write(argv[1], state) ? 0 : 1;
}
