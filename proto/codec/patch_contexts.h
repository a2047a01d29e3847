#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "proto/codec/bit_mixer.h"
#include "proto/codec/patch_view.h"

/// Where each context's statistics and each set of weights lie in the mixer's state: part of the
/// protocol version, as the trained priors are.
namespace cairn::proto::patch {

/// Nodes of a signed number that have statistics under every context; the rarer ones have one each.
inline constexpr std::size_t kNodes = 12;
inline constexpr std::size_t kRareNodes = 384;
/// Inner nodes of the trees of probability levels: of 9 … 16 levels, and of fewer.
inline constexpr std::size_t kLevelNodes = 16;
inline constexpr std::size_t kFewNodes = 8;
/// Nodes of the tree of the exact probabilities that are of one level.
inline constexpr std::size_t kRestNodes = 64;

/// A table of statistics: `contexts` different surroundings, each with its own.
struct Table {
  std::size_t first;
  std::size_t contexts;
  /// Requires: context < contexts.
  [[nodiscard]] constexpr std::size_t at(std::size_t context) const { return first + context; }
};

/// Places as seen from the viewpoint.
inline constexpr std::size_t kPolar = Place::kDistances * Place::kOctants;
inline constexpr std::size_t kSquare = Place::kAhead * Place::kAside;

/// Sizes of the tables, by element of a patch.
inline constexpr std::array<std::size_t, 6> kBlockTables = {128, 144,        256,
                                                            256, kPolar * 8, kSquare * 2};
inline constexpr std::array<std::size_t, 6> kQuarterTables = {64, 128,        256,
                                                              64, kPolar * 8, kSquare * 2};
inline constexpr std::array<std::size_t, 13> kMaskTables = {512,
                                                            720,
                                                            2560,
                                                            800,
                                                            1024,
                                                            1080,
                                                            512,
                                                            1600,
                                                            1024,
                                                            2048,
                                                            kSquare * 6,
                                                            kPolar * 4,
                                                            Place::kDistances * 40};
inline constexpr std::array<std::size_t, 4> kClearTables = {90, 144, 128, 64};
inline constexpr std::array<std::size_t, 4> kAltTables = {64, 128, 128, 256};
inline constexpr std::array<std::size_t, 13> kNewTables = {
    60 * kNodes,  256 * kNodes, 192 * kNodes, 64 * kNodes,  64 * kNodes, 256 * kNodes,
    256 * kNodes, 256 * kNodes, 256 * kNodes, 180 * kNodes, 80 * kNodes, Place::kDistances* kNodes,
    kRareNodes};
inline constexpr std::array<std::size_t, 5> kAltHeightTables = {
    16 * kNodes, 256 * kNodes, 64 * kNodes, 64 * kNodes, kRareNodes};
inline constexpr std::array<std::size_t, 6> kMovedTables = {144, 128, 288,
                                                            144, 256, Place::kDistances * 8};
inline constexpr std::array<std::size_t, 6> kChangeTables = {
    144 * kNodes, 16 * kNodes, 16 * kNodes, 64 * kNodes, 128 * kNodes, kRareNodes};
inline constexpr std::array<std::size_t, 7> kLevelTables = {72 * kLevelNodes,
                                                            72 * kLevelNodes,
                                                            72 * kLevelNodes,
                                                            162 * kLevelNodes,
                                                            320 * kLevelNodes,
                                                            256 * kLevelNodes,
                                                            Place::kDistances * 8 * kLevelNodes};
inline constexpr std::array<std::size_t, 7> kFewTables = {72 * kFewNodes,
                                                          72 * kFewNodes,
                                                          72 * kFewNodes,
                                                          162 * kFewNodes,
                                                          320 * kFewNodes,
                                                          256 * kFewNodes,
                                                          Place::kDistances * 8 * kFewNodes};
inline constexpr std::array<std::size_t, 3> kPlainLevelTables = {144, 64, 81};
inline constexpr std::array<std::size_t, 2> kRestTables = {16 * kRestNodes, kRestNodes* kRestNodes};
inline constexpr std::array<std::size_t, 5> kGridTables = {81, 108, 72, 144, 864};
inline constexpr std::array<std::size_t, 1> kRareTables = {192};

/// How many sets of weights each element has.
inline constexpr std::size_t kBlockSets = 16 + 8;
inline constexpr std::size_t kQuarterSets = 4 + 8;
inline constexpr std::size_t kMaskSets = 10 + 32;
inline constexpr std::size_t kClearSets = 5 + 8;
inline constexpr std::size_t kAltSets = 4 + 6;
inline constexpr std::size_t kNewSets = (kNodes + 1) + 6 * 4;
inline constexpr std::size_t kAltHeightSets = (kNodes + 1) + 4;
inline constexpr std::size_t kMovedSets = 9 + 8;
inline constexpr std::size_t kChangeSets = (kNodes + 1) + 8;
inline constexpr std::size_t kLevelSets = 16 + 20;
inline constexpr std::size_t kFewSets = 8 + 20;
inline constexpr std::size_t kPlainLevelSets = 16 + 9;
inline constexpr std::size_t kRestSets = 8 + 16;
inline constexpr std::size_t kGridSets = 9 + 36;
inline constexpr std::size_t kRareSets = 1;

/// Everything above, laid one after the other.
template <std::size_t N>
struct Element {
  std::array<Table, N> tables;
  std::size_t first_set;
};

class Layout {
 public:
  template <std::size_t N>
  constexpr Element<N> put(const std::array<std::size_t, N>& sizes, std::size_t sets) {
    Element<N> element{};
    for (std::size_t i = 0; i < N; ++i) {
      element.tables[i] = {contexts_, sizes[i]};
      contexts_ += sizes[i];
    }
    element.first_set = sets_;
    sets_ += sets;
    return element;
  }
  [[nodiscard]] constexpr std::size_t contexts() const { return contexts_; }
  [[nodiscard]] constexpr std::size_t sets() const { return sets_; }

 private:
  std::size_t contexts_ = 0;
  std::size_t sets_ = 0;
};

struct Elements {
  Layout layout;
  Element<6> block = layout.put(kBlockTables, kBlockSets);
  Element<6> quarter = layout.put(kQuarterTables, kQuarterSets);
  Element<13> mask = layout.put(kMaskTables, kMaskSets);
  Element<4> clear = layout.put(kClearTables, kClearSets);
  Element<4> alt = layout.put(kAltTables, kAltSets);
  Element<13> fresh = layout.put(kNewTables, kNewSets);
  Element<5> alt_height = layout.put(kAltHeightTables, kAltHeightSets);
  Element<13> fine = layout.put(kNewTables, kNewSets);
  Element<5> fine_alt = layout.put(kAltHeightTables, kAltHeightSets);
  Element<5> grid = layout.put(kGridTables, kGridSets);
  Element<6> moved = layout.put(kMovedTables, kMovedSets);
  Element<6> change = layout.put(kChangeTables, kChangeSets);
  Element<7> level = layout.put(kLevelTables, kLevelSets);
  Element<7> few = layout.put(kFewTables, kFewSets);
  Element<3> plain_level = layout.put(kPlainLevelTables, kPlainLevelSets);
  Element<2> rest = layout.put(kRestTables, kRestSets);
  Element<1> rare = layout.put(kRareTables, kRareSets);
};
inline constexpr Elements kElements{};
inline constexpr std::size_t kContexts = kElements.layout.contexts();
inline constexpr std::size_t kWeights = kElements.layout.sets() * BitMixer::kMaxInputs;

}  // namespace cairn::proto::patch
