#include "tests/bench/codec_snapshots.h"

#include <algorithm>
#include <ctime>
#include <iostream>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/map/packed_tile.h"
#include "proto/codec/patch.h"
#include "proto/codec/tile_snapshot.h"
#include "tests/bench/map_tiles.h"
#include "tests/bench/tile_baselines.h"
#include "tests/support/data_folder.h"

namespace cairn::bench {
namespace {

using proto::BlockUpdate;

/// What a frame leaves for a patch.
constexpr std::size_t kMostBytes = 1100;
/// A cell in memory: height and probability.
constexpr double kCellBytes = 3.0;

double seconds_since(std::clock_t start) {
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

/// What some maps' tiles took.
struct Cost {
  double tiles = 0.0;
  double cells = 0.0;  ///< Known ones.
  double patch_bytes = 0.0;
  double write_s = 0.0;
  double read_s = 0.0;
  double stored_bytes = 0.0;
  double store_s = 0.0;
  double load_s = 0.0;
  int wrong = 0;  ///< Tiles that were read otherwise than written.
  std::map<std::string, double> others;
};

std::vector<BlockUpdate> blocks_of(const TileKey& key, const Tile& tile) {
  std::vector<BlockUpdate> blocks;
  for (std::uint8_t block = 0; block < kBlocksPerTile; ++block) {
    BlockUpdate update{0, {EvidenceLayer::surface, key, block}, 0, 1, diff(nullptr, &tile, block)};
    if (update.delta.changed.any()) blocks.push_back(update);
  }
  return blocks;
}

/// As MapSender has it: frame by frame, each readable alone.
void by_patches(const TileKey& key, const Tile& tile, Cost& cost) {
  Tile read_tile(tile.datum_mm());
  auto blocks = blocks_of(key, tile);
  while (!blocks.empty()) {
    const std::clock_t start = std::clock();
    const auto patch = proto::write_patch(blocks, {}, kExact, {}, kMostBytes);
    cost.write_s += seconds_since(start);
    const std::clock_t read_start = std::clock();
    const auto read = proto::read_patch(patch.bytes, {}, {});
    cost.read_s += seconds_since(read_start);
    cost.patch_bytes += static_cast<double>(patch.bytes.size());
    if (!read) break;
    for (const BlockUpdate& update : *read) {
      for (int i = 0; i < kBlockCells; ++i) {
        const auto at = static_cast<std::size_t>(i);
        if (!update.delta.changed[at]) continue;
        read_tile.set(index_in_tile(update.key.block, i), update.delta.cells.at(at));
      }
    }
    for (auto taken = patch.taken.rbegin(); taken != patch.taken.rend(); ++taken) {
      blocks.erase(blocks.begin() + static_cast<std::ptrdiff_t>(*taken));
    }
  }
  if (read_tile != tile) ++cost.wrong;
}

/// As the store and clients get it.
void by_snapshot(const Tile& tile, Cost& cost) {
  const PackedTile packed = PackedTile::pack(tile);
  const std::clock_t start = std::clock();
  const auto bytes = proto::write_tile_snapshot(packed);
  cost.store_s += seconds_since(start);
  const std::clock_t read_start = std::clock();
  const auto read = proto::read_tile_snapshot(bytes);
  cost.load_s += seconds_since(read_start);
  cost.stored_bytes += static_cast<double>(bytes.size());
  if (!read || *read != packed) ++cost.wrong;
}

void measure(const MapTiles& tiles, const std::vector<TileBaseline>& baselines, Cost& cost) {
  for (const auto& [key, tile] : tiles) {
    cost.tiles += 1.0;
    cost.cells += tile.known_count();
    by_patches(key, tile, cost);
    by_snapshot(tile, cost);
    for (const TileBaseline& baseline : baselines) {
      cost.others[baseline.name] += static_cast<double>(baseline.size_bytes(tile));
    }
  }
}

void report(Report& to, const std::string& name, const Cost& cost) {
  double best = std::numeric_limits<double>::max();
  std::map<std::string, double> peers;
  for (const auto& [other, bytes] : cost.others) {
    best = std::min(best, bytes);
    peers[other] = 8.0 * bytes / cost.cells;
  }
  const double raw_mb = cost.cells * kCellBytes / 1e6;
  std::cout << name << ": " << cost.tiles << " tiles, " << cost.cells / cost.tiles
            << " known cells each; patches " << 8.0 * cost.patch_bytes / cost.cells
            << " bits a cell, written at " << raw_mb / cost.write_s << " MB/s, read at "
            << raw_mb / cost.read_s << " MB/s; stored " << 8.0 * cost.stored_bytes / cost.cells
            << " bits a cell, read at " << raw_mb / cost.load_s << " MB/s\n";
  to.add({.name = "snapshot " + name + ", bits per known cell",
          .value = 8.0 * cost.patch_bytes / cost.cells,
          .unit = "bit",
          .peers = peers});
  if (!cost.others.empty()) {
    to.add({.name = "snapshot " + name + ", best zstd -19 / patches",
            .value = best / cost.patch_bytes,
            .unit = "x",
            .better = Better::higher,
            .goal = 1.35});
  }
  to.add({.name = "snapshot " + name + ", at rest / stored",
          .value = kCellBytes * cost.cells / cost.stored_bytes,
          .unit = "x",
          .better = Better::higher});
  to.add({.name = "snapshot " + name + ", stored at",
          .value = raw_mb / cost.store_s,
          .unit = "MB/s",
          .better = Better::higher,
          .goal = 20.0});
  to.add({.name = "snapshot " + name + ", tiles read wrongly",
          .value = static_cast<double>(cost.wrong),
          .unit = "tiles",
          .goal = 0.0});
}

}  // namespace

bool measure_snapshots(Report& to) {
  const auto baselines = tile_baselines();
  for (const bool moved : {false, true}) {
    for (const std::string world : {"block", "hill", "room"}) {
      Cost cost;
      for (const std::uint64_t seed : {7, 8}) {
        const auto tiles = tiles_of_drive({.world = world, .seed = seed, .coarseness = {}}, moved);
        if (!tiles) {
          std::cerr << tiles.error().message << '\n';
          return false;
        }
        measure(*tiles, baselines, cost);
      }
      report(to, world + (moved ? ", moved submaps" : ""), cost);
    }
  }
  const auto folder = test::data_folder();
  if (folder.empty()) return true;
  Cost terrain;
  for (const char* file : {"ahn3_delft1_025_dsm.tif@0.25", "viewshed_dsm_1m.tif"}) {
    const auto tiles = tiles_of_terrain((folder / "terrain" / file).string());
    if (tiles) measure(*tiles, baselines, terrain);
  }
  if (terrain.tiles > 0.0) report(to, "real terrain", terrain);
  return true;
}

}  // namespace cairn::bench
