#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "robot_agent/spool/spool_store.h"

/// Submaps to spool, made by a real EvidenceSender.
namespace cairn::agent::testing {

inline const SpoolOwner kOwner{"r1", "lab", 125};

/// Changes a patch of cells of the open submap, in both layers.
inline void see(proto::EvidenceSender& sender, CellIndex corner, int size, std::mt19937& random) {
  for (const auto layer : {EvidenceLayer::surface, EvidenceLayer::seen_through}) {
    std::vector<CellIndex> cells;
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const CellIndex cell{corner.x + x, corner.y + y};
        const int height_mm = static_cast<int>(random() % 50) * 10;
        layer_of(*sender.open_submap(), layer).set(cell, {height_mm, 200});
        cells.push_back(cell);
      }
    }
    sender.touch(layer, cells);
  }
}

/// The copy of a closed submap of `size`² cells in each layer.
inline proto::KeptSubmap sample(SubmapId id, int size = 40, unsigned seed = 1) {
  std::mt19937 random(seed);
  proto::EvidenceSender sender;
  proto::KeptSubmap kept;
  for (std::uint32_t sequence = 1; sequence <= id.sequence; ++sequence) {
    sender.begin(id.boot, {8000, -16'000, 1000, 31}, 125).link = SubmapLink{{1, 2, 3, 4}, 5, 6, 7};
    if (sequence == id.sequence) see(sender, {-7, 3}, size, random);
    sender.close();
  }
  return *sender.copy_of(id);
}

inline bool same_cells(const BlockDelta& a, const BlockDelta& b) {
  if (a.changed != b.changed) return false;
  for (std::size_t i = 0; i < kBlockCells; ++i) {
    if (a.changed[i] && a.cells.at(i) != b.cells.at(i)) return false;
  }
  return true;
}

inline bool same(const proto::KeptSubmap& a, const proto::KeptSubmap& b) {
  const auto sorted = [](std::vector<proto::BlockUpdate> blocks) {
    std::ranges::sort(blocks, {}, &proto::BlockUpdate::key);
    return blocks;
  };
  return a.id == b.id && a.T_site_submap == b.T_site_submap && a.edition == b.edition &&
         a.link == b.link &&
         std::ranges::equal(sorted(a.blocks), sorted(b.blocks), [](const auto& x, const auto& y) {
           return x.key == y.key && x.base == y.base && x.version == y.version &&
                  same_cells(x.delta, y.delta);
         });
}

}  // namespace cairn::agent::testing
