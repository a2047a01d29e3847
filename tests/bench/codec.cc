// Map changes as patches, against well-known libraries on the same changes: simulated drives of
// 300 s, one delta a second, 10 mm, 16 probability levels; each delta in packets that fit a frame.

#include <ctime>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "proto/codec/patch.h"
#include "tests/bench/codec_snapshots.h"
#include "tests/bench/delta_baselines.h"
#include "tests/bench/drive_deltas.h"
#include "tests/bench/report.h"

namespace {

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

  void tell(Delta delta) {
    ++tick_;
    cost_.deltas += 1.0;
    double write_ms = 0.0;
    double read_ms = 0.0;
    std::vector<BlockUpdate> told;
    while (!delta.empty()) {
      const std::clock_t start = std::clock();
      const auto patch =
          cairn::proto::write_patch(delta, {1, tick_}, coarseness_, image_, kMostBytes);
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
    std::size_t turn = 0;
    for (const Delta& delta : drive->deltas) {
      const Cost before = measured.cost;
      link.tell(delta);
      if (turn++ % kEach != 0) continue;
      measured.compared_bytes += measured.cost.bytes - before.bytes;
      measured.compared_cells += measured.cost.cells - before.cells;
      for (std::size_t i = 0; i < baselines.size(); ++i) {
        measured.peers[i].bytes += static_cast<double>(baselines[i].size_bytes(delta));
      }
    }
  }
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

}  // namespace

int main(int argc, char** argv) {
  cairn::bench::Report to("codec");
  const std::string only = argc > 1 ? argv[1] : "";
  if (only == "snapshots") {
    const bool measured = cairn::bench::measure_snapshots(to);
    to.print(std::cout);
    return measured ? 0 : 1;
  }
  std::vector<std::string> absent;
  for (const std::string world : {"block", "hill", "room"}) {
    Measured measured;
    if (!measure(world, measured, absent)) return 1;
    print(world, measured);
    report(to, world, measured);
  }
  for (const std::string& name : absent) {
    std::cout << "not compared, as its library was absent at build time: " << name << '\n';
  }
  to.print(std::cout);
  return 0;
}
