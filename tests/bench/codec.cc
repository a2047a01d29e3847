// Map changes as patches, against well-known libraries on the same changes: simulated drives of
// 300 s, one delta a second, 10 mm, 16 probability levels; each delta in packets that fit a frame.
// The same coarser and less often, for radios; and whole tiles.

#include <ctime>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "core/map/traversability.h"
#include "proto/codec/patch.h"
#include "robot_agent/pipeline/detail.h"
#include "tests/bench/codec_snapshots.h"
#include "tests/bench/delta_baselines.h"
#include "tests/bench/drive_deltas.h"
#include "tests/bench/report.h"

namespace {

using cairn::CellClass;
using cairn::CellIndex;
using cairn::HeightMap;
using cairn::bench::Better;
using cairn::bench::Delta;
using cairn::bench::Drive;
using cairn::bench::DriveSetting;
using cairn::proto::BlockUpdate;

/// What a frame leaves for a patch beside its header and a pose.
constexpr std::size_t kMostBytes = 1100;
/// The others take seconds for a drive, so they are given each tenth delta only.
constexpr std::size_t kEach = 10;
/// Seeds that the priors were not trained on.
constexpr std::uint64_t kSeeds[] = {7, 8};

double cpu_ms(std::clock_t since) {
  return 1000.0 * static_cast<double>(std::clock() - since) / CLOCKS_PER_SEC;
}

/// What the patches of some drives took.
struct Cost {
  double bytes = 0.0;
  double cells = 0.0;
  double deltas = 0.0;
  double packets = 0.0;
  double write_ms = 0.0;
  double read_ms = 0.0;
  double worst_write_ms = 0.0;
  double worst_read_ms = 0.0;
  int wrong = 0;  ///< Blocks that were read otherwise than written.
};

bool same(const BlockUpdate& a, const BlockUpdate& b) {
  if (a.key != b.key || a.base != b.base || a.version != b.version) return false;
  if (a.delta.datum_mm != b.delta.datum_mm || a.delta.changed != b.delta.changed) return false;
  for (std::size_t i = 0; i < cairn::kBlockCells; ++i) {
    if (!a.delta.changed[i]) continue;
    const cairn::Cell& told = a.delta.cells.at(i);
    const cairn::Cell& read = b.delta.cells.at(i);
    if (told.known() ? told != read : read.known()) return false;
  }
  return true;
}

/// Both ends of a link without loss: each delta in as many packets as it takes.
class Link {
 public:
  Link(const cairn::Coarseness& coarseness, Cost& cost) : coarseness_(coarseness), cost_(cost) {}

  void tell(Delta delta, const cairn::proto::Viewpoint& view) {
    ++tick_;
    cost_.deltas += 1.0;
    double write_ms = 0.0;
    double read_ms = 0.0;
    std::vector<BlockUpdate> told;
    while (!delta.empty()) {
      const std::clock_t start = std::clock();
      const auto patch =
          cairn::proto::write_patch(delta, {1, tick_, view}, coarseness_, image_, kMostBytes);
      write_ms += cpu_ms(start);
      const std::clock_t read_start = std::clock();
      const auto read = cairn::proto::read_patch(patch.bytes, {1, tick_}, image_);
      read_ms += cpu_ms(read_start);
      cost_.bytes += static_cast<double>(patch.bytes.size());
      cost_.packets += 1.0;
      check(delta, patch.taken, read);
      Delta rest;
      for (std::size_t i = 0, next = 0; i < delta.size(); ++i) {
        const bool taken = next < patch.taken.size() && patch.taken[next] == i;
        next += taken ? 1 : 0;
        (taken ? told : rest).push_back(delta[i]);
      }
      delta = std::move(rest);
    }
    for (const BlockUpdate& update : told) {
      image_.merge(1, told_block(update.key, update.version, update.delta), tick_);
      cost_.cells += static_cast<double>(update.delta.changed.count());
    }
    cost_.write_ms += write_ms;
    cost_.read_ms += read_ms;
    cost_.worst_write_ms = std::max(cost_.worst_write_ms, write_ms);
    cost_.worst_read_ms = std::max(cost_.worst_read_ms, read_ms);
  }

 private:
  void check(const Delta& delta, const std::vector<std::size_t>& taken,
             const cairn::Result<std::vector<BlockUpdate>>& read) {
    if (!read || read->size() != taken.size()) {
      cost_.wrong += static_cast<int>(taken.size());
      return;
    }
    std::map<cairn::BlockKey, const BlockUpdate*> by_key;
    for (const BlockUpdate& update : *read) by_key[update.key] = &update;
    for (const std::size_t i : taken) {
      const auto found = by_key.find(delta[i].key);
      if (found == by_key.end() || !same(delta[i], *found->second)) ++cost_.wrong;
    }
  }

  cairn::Coarseness coarseness_;
  Cost& cost_;
  cairn::ContextImage image_;
  std::uint8_t tick_ = 0;
};

struct Peer {
  std::string name;
  double bytes = 0.0;
};

/// One world's drives by the patches and by the others.
struct Measured {
  Cost cost;
  std::vector<Peer> peers;
  double compared_bytes = 0.0;  ///< Of the patches of the deltas that the others got.
  double compared_cells = 0.0;
  double seconds = 0.0;
};

bool measure(const std::string& world, Measured& measured, std::vector<std::string>& absent) {
  absent.clear();
  const auto baselines = cairn::bench::delta_baselines({}, absent);
  for (const auto& baseline : baselines) measured.peers.push_back({baseline.name});
  for (const std::uint64_t seed : kSeeds) {
    const auto drive = cairn::bench::drive_deltas({.world = world, .seed = seed, .coarseness = {}});
    if (!drive) {
      std::cerr << drive.error().message << '\n';
      return false;
    }
    measured.seconds += 300.0;
    Link link({}, measured.cost);
    for (std::size_t turn = 0; turn < drive->deltas.size(); ++turn) {
      const Delta& delta = drive->deltas[turn];
      const Cost before = measured.cost;
      link.tell(delta, drive->views[turn]);
      if (turn % kEach != 0) continue;
      measured.compared_bytes += measured.cost.bytes - before.bytes;
      measured.compared_cells += measured.cost.cells - before.cells;
      for (std::size_t i = 0; i < baselines.size(); ++i) {
        measured.peers[i].bytes += static_cast<double>(baselines[i].size_bytes(delta));
      }
    }
  }
  return true;
}

/// Share of the cells of two maps that a planner takes for something else. Both hold the same
/// tiles.
double misjudged(const HeightMap& truth, const HeightMap& told) {
  double cells = 0.0;
  double wrong = 0.0;
  std::vector<CellIndex> corners;
  for (const auto& [key, tile] : truth.tiles()) {
    const CellIndex first{key.tx * cairn::Tile::kSize, key.ty * cairn::Tile::kSize};
    corners.push_back(first);
    corners.push_back({first.x + cairn::Tile::kSize - 1, first.y + cairn::Tile::kSize - 1});
  }
  const auto [west, east] = std::ranges::minmax(corners, {}, &CellIndex::x);
  const auto [south, north] = std::ranges::minmax(corners, {}, &CellIndex::y);
  const auto classes = [&](const HeightMap& map) {
    auto grid = cairn::empty_grid({west.x, south.y}, {east.x, north.y}, map.cell_size_mm());
    for (const auto& [key, tile] : map.tiles()) draw_tile(*grid, key, *tile, 1);
    return classify(*grid, {});
  };
  const auto right = classes(truth);
  const auto seen = classes(told);
  for (std::size_t i = 0; i < right.size(); ++i) {
    if (right[i] == CellClass::unknown && seen[i] == CellClass::unknown) continue;
    cells += 1.0;
    wrong += right[i] != seen[i] ? 1.0 : 0.0;
  }
  return wrong / cells;
}

/// The detail for the thinnest links, where there is most to tell.
bool measure_radio(cairn::bench::Report& to) {
  const cairn::agent::Detail& radio = cairn::agent::kRadioDetail;
  Cost cost;
  double seconds = 0.0;
  double worst = 0.0;
  for (const std::uint64_t seed : kSeeds) {
    const auto drive = cairn::bench::drive_deltas({.world = "block",
                                                   .seed = seed,
                                                   .cadence_s = radio.period_s,
                                                   .coarseness = radio.coarseness});
    if (!drive) {
      std::cerr << drive.error().message << '\n';
      return false;
    }
    Link link(radio.coarseness, cost);
    for (std::size_t i = 0; i < drive->deltas.size(); ++i) {
      link.tell(drive->deltas[i], drive->views[i]);
    }
    seconds += 300.0;
    worst = std::max(worst, misjudged(drive->exact, drive->told));
  }
  to.add({.name = "radio, block",
          .value = 8.0 * cost.bytes / seconds / 1000.0,
          .unit = "kbit/s",
          .goal = 3.2});
  to.add({.name = "radio, block, bits per changed cell",
          .value = 8.0 * cost.bytes / cost.cells,
          .unit = "bit"});
  to.add(
      {.name = "radio, block, cells misjudged", .value = 100.0 * worst, .unit = "%", .goal = 0.5});
  to.add({.name = "radio, block, blocks read wrongly",
          .value = static_cast<double>(cost.wrong),
          .unit = "blocks",
          .goal = 0.0});
  return true;
}

void print(const std::string& world, const Measured& m) {
  std::cout << "\n"
            << world << ": " << m.cost.cells / m.cost.deltas << " cells a delta, "
            << m.cost.bytes * 8.0 / m.seconds / 1000.0 << " kbit/s, "
            << m.cost.packets / m.cost.deltas << " packets a delta; write "
            << m.cost.write_ms / m.cost.deltas << " ms (worst " << m.cost.worst_write_ms
            << "), read " << m.cost.read_ms / m.cost.deltas << " ms (worst " << m.cost.worst_read_ms
            << ") a delta\n";
  const auto line = [&](const std::string& name, double bytes) {
    std::cout << "  " << 8.0 * bytes / m.compared_cells << " bits a cell, "
              << bytes / m.compared_bytes << " x  " << name << std::endl;
  };
  line("Cairn", m.compared_bytes);
  for (const Peer& peer : m.peers) line(peer.name, peer.bytes);
}

void report(cairn::bench::Report& to, const std::string& world, const Measured& m) {
  double best = 1e300;
  double list = 0.0;
  std::map<std::string, double> peers;
  for (const Peer& peer : m.peers) {
    best = std::min(best, peer.bytes);
    if (peer.name.starts_with("struct")) list = peer.bytes;
    peers[peer.name] = 8.0 * peer.bytes / m.compared_cells;
  }
  to.add({.name = world + ", bits per changed cell",
          .value = 8.0 * m.cost.bytes / m.cost.cells,
          .unit = "bit",
          .peers = peers});
  to.add({.name = world + ", best other / Cairn",
          .value = best / m.compared_bytes,
          .unit = "x",
          .better = Better::higher,
          .goal = world == "room" ? 1.85 : 1.9});
  to.add({.name = world + ", struct list + zstd / Cairn",
          .value = list / m.compared_bytes,
          .unit = "x",
          .better = Better::higher,
          .goal = 3.5});
  to.add({.name = world + ", written in",
          .value = m.cost.write_ms / m.cost.deltas,
          .unit = "ms/delta",
          .goal = 5.0});
  to.add({.name = world + ", read in",
          .value = m.cost.read_ms / m.cost.deltas,
          .unit = "ms/delta",
          .goal = 5.0});
  to.add({.name = world + ", blocks read wrongly",
          .value = static_cast<double>(m.cost.wrong),
          .unit = "blocks",
          .goal = 0.0});
}

bool measure_drives(cairn::bench::Report& to) {
  std::vector<std::string> absent;
  for (const std::string world : {"block", "hill", "room"}) {
    Measured measured;
    if (!measure(world, measured, absent)) return false;
    print(world, measured);
    report(to, world, measured);
  }
  for (const std::string& name : absent) {
    std::cout << "not compared, as its library was absent at build time: " << name << '\n';
  }
  return true;
}

}  // namespace

/// bench_codec [drives | radio | snapshots]: one part alone.
int main(int argc, char** argv) {
  const std::string only = argc > 1 ? argv[1] : "";
  const auto wanted = [&](const std::string& part) { return only.empty() || only == part; };
  cairn::bench::Report to("codec");
  const bool measured = (!wanted("drives") || measure_drives(to)) &&
                        (!wanted("radio") || measure_radio(to)) &&
                        (!wanted("snapshots") || cairn::bench::measure_snapshots(to));
  if (!measured) return 1;
  to.print(std::cout);
  return 0;
}
