// Trains the priors that patches begin with (proto/codec/patch_priors_table.inc on simulated
// drives, patch_exact_priors_table.inc on the maps that drives leave). What is reported of the
// codec (bench_codec) uses other seeds.
//   train_codec FILE FILE_OF_EXACT      "-" leaves one out

#include <algorithm>
#include <fstream>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "proto/codec/patch.h"
#include "proto/codec/patch_priors.h"
#include "tests/bench/drive_deltas.h"
#include "tests/bench/map_tiles.h"

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
constexpr std::uint16_t kMostSeen = 6;

/// Patches of one drive or map.
struct Lesson {
  std::string name;
  Coarseness coarseness;
  std::vector<Delta> deltas;
  std::vector<cairn::proto::Viewpoint> views;  ///< Of each, unless they are alone.
  bool alone = false;                          ///< Each is told without the others being known.
};
using Lessons = std::vector<Lesson>;

bool add_drive(Lessons& lessons, const DriveSetting& setting) {
  auto drive = cairn::bench::drive_deltas(setting);
  if (!drive) {
    std::cerr << drive.error().message << '\n';
    return false;
  }
  lessons.push_back({setting.world + ' ' + std::to_string(setting.seed), setting.coarseness,
                     std::move(drive->deltas), std::move(drive->views)});
  return true;
}

/// A room has little to learn from, so there are more of them: so many for each seed.
std::vector<std::uint64_t> more_rooms(const std::vector<std::uint64_t>& seeds, std::uint64_t each) {
  std::vector<std::uint64_t> more;
  for (const std::uint64_t seed : seeds) {
    for (std::uint64_t room = 1; room <= each; ++room) more.push_back(seed + 100 * room);
  }
  return more;
}

/// The drives of robots, most of them as by default, some coarser and less often.
bool add_drives(Lessons& lessons, const std::vector<std::uint64_t>& seeds) {
  for (const std::uint64_t seed : seeds) {
    for (const char* world : {"block", "hill", "room"}) {
      if (!add_drive(lessons, {.world = world, .seed = seed, .coarseness = {}})) return false;
    }
    if (!add_drive(lessons, {.world = "block",
                             .seed = seed + 20,
                             .cadence_s = 5.0,
                             .coarseness = {.quantum_mm = 10, .levels = 4}})) {
      return false;
    }
  }
  return std::ranges::all_of(more_rooms(seeds, 1), [&](std::uint64_t seed) {
    return add_drive(lessons, {.world = "room", .seed = seed, .coarseness = {}});
  });
}

/// Whole tiles, in parts of about a packet.
void cut(const cairn::bench::MapTiles& tiles, std::vector<Delta>& deltas) {
  constexpr std::size_t kMostCells = 1100;
  for (const auto& [key, tile] : tiles) {
    Delta delta;
    std::size_t cells = 0;
    for (std::uint8_t block = 0; block < cairn::kBlocksPerTile; ++block) {
      cairn::proto::BlockUpdate update{0, {{}, key, block}, 0, 1, diff(nullptr, &tile, block)};
      if (update.delta.changed.none()) continue;
      cells += update.delta.changed.count();
      delta.push_back(update);
      if (cells > kMostCells) {
        deltas.push_back(std::exchange(delta, {}));
        cells = 0;
      }
    }
    if (!delta.empty()) deltas.push_back(std::move(delta));
  }
}

/// The map that a drive leaves, on the grid and moved off it.
bool add_map(Lessons& lessons, const std::string& world, std::uint64_t seed) {
  for (const bool moved : {false, true}) {
    const auto tiles =
        cairn::bench::tiles_of_drive({.world = world, .seed = seed, .coarseness = {}}, moved);
    if (!tiles) {
      std::cerr << tiles.error().message << '\n';
      return false;
    }
    const std::string name = "map of " + world + ' ' + std::to_string(seed);
    lessons.push_back({name + (moved ? ", moved" : ""), cairn::kExact, {}, {}, true});
    cut(*tiles, lessons.back().deltas);
  }
  return true;
}

bool add_maps(Lessons& lessons, const std::vector<std::uint64_t>& seeds) {
  for (const std::uint64_t seed : seeds) {
    for (const char* world : {"block", "hill", "room"}) {
      if (!add_map(lessons, world, seed)) return false;
    }
  }
  return std::ranges::all_of(more_rooms(seeds, 3),
                             [&](std::uint64_t seed) { return add_map(lessons, "room", seed); });
}

/// What a lesson took.
struct Cost {
  double bytes = 0.0;
  double cells = 0.0;
};

/// Runs a lesson's deltas through the coder, each against what was told before; `state` is given to
/// `before_each` first.
template <class BeforeEach>
Cost run(const Lesson& lesson, MixerState& state, const Learning& learning,
         const BeforeEach& before_each) {
  cairn::ContextImage image;
  Cost cost;
  std::uint8_t tick = 0;
  for (std::size_t i = 0; i < lesson.deltas.size(); ++i) {
    const Delta& delta = lesson.deltas[i];
    ++tick;
    before_each(state);
    cairn::proto::PatchSetting setting{1, tick};
    if (!lesson.alone) setting.view = lesson.views[i];
    const auto bytes = cairn::proto::write_patch_learning(delta, setting, lesson.coarseness, image,
                                                          state, learning);
    cost.bytes += static_cast<double>(bytes.size());
    for (const auto& update : delta) {
      cost.cells += static_cast<double>(update.delta.changed.count());
      if (lesson.alone) continue;
      image.merge(update.sequence, told_block(update.key, update.version, update.delta), tick);
    }
  }
  return cost;
}

void gather(const Lessons& lessons, MixerState& state) {
  for (const Lesson& lesson : lessons) run(lesson, state, kGathering, [](MixerState&) {});
}

MixerState held_back(MixerState state) {
  for (auto& statistic : state.statistics) statistic.seen = std::min(statistic.seen, kMostSeen);
  return state;
}

/// The mean of the weights over all packets of lessons that the statistics do not know: single
/// packets pull them to and fro.
std::vector<std::int32_t> weigh(const Lessons& lessons, const MixerState& gathered) {
  MixerState state = held_back(gathered);
  state.weights = blank_priors().weights;
  const auto priors = state.statistics;
  std::vector<double> sum;
  double packets = 0.0;
  constexpr int kPasses = 2;  // The first gets them there.
  for (int pass = 0; pass < kPasses; ++pass) {
    sum.assign(state.weights.size(), 0.0);
    packets = 0.0;
    for (const Lesson& lesson : lessons) {
      run(lesson, state, kWeighing, [&](MixerState& before) {
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

void report(const Lessons& lessons, const MixerState& priors) {
  for (const Lesson& lesson : lessons) {
    MixerState state;
    const Cost cost = run(lesson, state, cairn::proto::kPacketLearning,
                          [&](MixerState& before) { before = priors; });
    std::cerr << lesson.name << ": " << 8.0 * cost.bytes / cost.cells << " bits a cell\n";
  }
}

/// The statistics of `known` and `fresh`, and weights that `fresh` asks for when it is not known.
MixerState train(const Lessons& first, const Lessons& known, const Lessons& fresh) {
  MixerState state = blank_priors();
  gather(first, state);
  gather(known, state);
  const auto weights = weigh(fresh, state);
  gather(fresh, state);
  gather(known, state);
  state = held_back(state);
  state.weights = weights;
  return state;
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

bool train_coarse(const std::string& file) {
  Lessons known;
  Lessons fresh;
  Lessons check;
  if (!add_drives(known, {101, 102, 104}) || !add_drives(fresh, {103, 105}) ||
      !add_drives(check, {106})) {
    return false;
  }
  const MixerState state = train({}, known, fresh);
  report(check, state);
  return write(file, state);
}

bool train_exact(const std::string& file) {
  Lessons first;  // A drive that tells exact values lends a first guess of what maps have not.
  Lessons known;
  Lessons fresh;
  Lessons check;
  DriveSetting exact{.world = "block", .seed = 121, .coarseness = cairn::kExact};
  exact.duration_s = 60.0;
  if (!add_drive(first, exact) || !add_maps(known, {101, 102, 104}) ||
      !add_maps(fresh, {103, 105}) || !add_maps(check, {106})) {
    return false;
  }
  const MixerState state = train(first, known, fresh);
  report(check, state);
  return write(file, state);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: train_codec FILE FILE_OF_EXACT\n";
    return 2;
  }
  const std::string coarse = argv[1];
  const std::string exact = argv[2];
  return (coarse == "-" || train_coarse(coarse)) && (exact == "-" || train_exact(exact)) ? 0 : 1;
}
