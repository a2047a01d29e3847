#include "proto/codec/patch.h"

#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <map>
#include <random>

#include "core/map/height_map.h"
#include "tests/support/random_records.h"
#include "tests/support/sample_records.h"

namespace cairn::proto {
namespace {

constexpr PatchSetting kSetting{.sequence = 7, .tick = 3};
constexpr std::size_t kRoom = 1100;

/// A robot's map of a rough slope with a wall, told in steps.
class Slope {
 public:
  explicit Slope(std::uint64_t seed) : random_(seed) {}

  /// New values in a stripe of the ground, and now and then somewhere else.
  std::vector<BlockUpdate> step(const Coarseness& coarseness) {
    std::map<BlockKey, BlockUpdate> updates;
    for (int y = -20; y < 28; ++y) {
      for (int x = at_ - 4; x < at_ + 2; ++x) {
        if (random_() % 3 != 0) tell({x, y}, coarseness, updates);
      }
    }
    at_ += 2;
    std::vector<BlockUpdate> blocks;
    for (auto& [key, update] : updates) {
      update.version = ++versions_[key];
      update.base = update.version - 1;
      blocks.push_back(update);
    }
    return blocks;
  }

 private:
  void tell(CellIndex at, const Coarseness& coarseness, std::map<BlockKey, BlockUpdate>& updates) {
    const int noise = static_cast<int>(random_() % 31) - 15;
    const int wall = at.x > 20 && at.y == 9 ? 1700 : 0;
    const int probability = 120 + static_cast<int>(random_() % 130);
    const Cell exact{at.x * 11 + at.y * 7 + wall + noise, static_cast<std::uint8_t>(probability)};
    const Cell cell = random_() % 40 == 0 ? Cell{} : coarse(exact, {}, coarseness);
    const BlockPlace place = place_in_block(HeightMap::index_in_tile(at));
    const BlockKey key{EvidenceLayer::surface, HeightMap::tile_of(at), place.block};
    BlockUpdate& update = updates[key];
    update.sequence = kSetting.sequence;
    update.key = key;
    update.delta.changed.set(static_cast<std::size_t>(place.cell));
    update.delta.cells.at(static_cast<std::size_t>(place.cell)) = cell;
  }

  std::mt19937_64 random_;
  std::map<BlockKey, std::uint32_t> versions_;
  int at_ = 0;
};

void expect_same(const std::vector<BlockUpdate>& sent, const std::vector<std::size_t>& taken,
                 const std::vector<BlockUpdate>& read, std::uint64_t seed) {
  ASSERT_EQ(taken.size(), read.size()) << "seed " << seed;
  std::map<BlockKey, BlockUpdate> by_key;
  for (const BlockUpdate& update : read) by_key[update.key] = update;
  for (const std::size_t i : taken) {
    ASSERT_TRUE(by_key.contains(sent[i].key)) << "seed " << seed;
    ASSERT_TRUE(testing::same(sent[i], by_key[sent[i].key])) << "seed " << seed;
  }
}

void merge(ContextImage& image, const std::vector<BlockUpdate>& blocks, std::uint8_t tick) {
  for (const BlockUpdate& update : blocks) {
    image.merge(update.sequence, told_block(update.key, update.version, update.delta), tick);
  }
}

/// Random blocks of one submap, all keys different, as near to each other as a patch asks for.
std::vector<BlockUpdate> random_blocks(testing::RandomRecords& random, int most) {
  std::map<BlockKey, BlockUpdate> blocks;
  const int count = random.between(1, most);
  const std::int32_t tx = random.between(-kMaxTileCoordinate, kMaxTileCoordinate - 8);
  for (int i = 0; i < count; ++i) {
    BlockUpdate update = random.block();
    update.sequence = kSetting.sequence;
    update.key.tile = {0, random.between(tx, tx + 8), random.between(-3, 3)};
    for (Cell& cell : update.delta.cells) {
      const bool storable = HeightMap::storable(cell.height_mm);
      if (cell.known() && !storable) cell.height_mm = update.delta.datum_mm;
    }
    blocks[update.key] = update;
  }
  std::vector<BlockUpdate> all;
  for (auto& [key, update] : blocks) all.push_back(update);
  return all;
}

TEST(Patch, MapsComeBackThroughAllSteps) {
  for (const Coarseness coarseness : {Coarseness{}, Coarseness{1, 16}, Coarseness{20, 4}, kExact,
                                      Coarseness{10, 2}, Coarseness{255, 13}}) {
    Slope slope(1);
    ContextImage image;
    for (std::uint8_t tick = 0; tick < 40; ++tick) {
      const auto sent = slope.step(coarseness);
      const PatchSetting setting{kSetting.sequence, tick};
      const auto patch = write_patch(sent, setting, coarseness, image, kRoom);
      ASSERT_LE(patch.bytes.size(), kRoom);
      const auto read = read_patch(patch.bytes, setting, image);
      ASSERT_TRUE(read) << read.error().message;
      expect_same(sent, patch.taken, *read, tick);
      merge(image, *read, tick);
    }
  }
}

TEST(Patch, CarriesTheViewpointThatItWasToldFrom) {
  for (const std::int32_t far : {0, 1, -37, 100'000, std::numeric_limits<std::int32_t>::max(),
                                 std::numeric_limits<std::int32_t>::min()}) {
    for (int heading = 0; heading < kHeadings; heading += 7) {
      Slope slope(4);
      PatchSetting setting = kSetting;
      setting.view = Viewpoint{{far, -(far / 2)}, static_cast<std::uint8_t>(heading)};
      const auto sent = slope.step({});
      const auto patch = write_patch(sent, setting, {}, {}, kRoom);
      const auto read = read_patch(patch.bytes, kSetting, {});
      ASSERT_TRUE(read) << read.error().message << " at " << far;
      expect_same(sent, patch.taken, *read, static_cast<std::uint64_t>(heading));
    }
  }
}

/// A slope that one submap told in steps of 10 mm, lying so much off the site's heights.
std::vector<BlockUpdate> tile_on_grid(int off_mm, int noise_mm) {
  std::mt19937 random(1);
  Tile tile(0);
  for (int i = 0; i < Tile::kCells; ++i) {
    const int x = i % Tile::kSize;
    const int y = i / Tile::kSize;
    const int noise = static_cast<int>(random() % 3) - 1;
    const int steps = (x * 11 + y * 7) / 10 + noise;
    const int off_grid = noise_mm == 0 ? 0 : static_cast<int>(random()) % noise_mm;
    tile.set(i, {10 * steps + off_mm + off_grid, probability_of(10 + noise, kMaxLevels)});
  }
  std::vector<BlockUpdate> blocks;
  for (std::uint8_t block = 0; block < 4; ++block) {
    blocks.push_back({kSetting.sequence, {{}, {}, block}, 0, 1, diff(nullptr, &tile, block)});
  }
  return blocks;
}

TEST(Patch, ExactHeightsOnAGridTakeLessWhereverTheGridLies) {
  const auto bytes = [](const std::vector<BlockUpdate>& sent) {
    const auto patch = write_patch(sent, kSetting, kExact, {}, 4000);
    EXPECT_EQ(patch.taken.size(), sent.size());
    const auto read = read_patch(patch.bytes, kSetting, {});
    EXPECT_TRUE(read);
    expect_same(sent, patch.taken, *read, 0);
    return patch.bytes.size();
  };
  const std::size_t at_zero = bytes(tile_on_grid(0, 0));
  EXPECT_LT(bytes(tile_on_grid(-3, 0)), at_zero + at_zero / 20);
  EXPECT_GT(bytes(tile_on_grid(0, 10)), at_zero + at_zero / 3);
}

TEST(Patch, EveryExactProbabilityComesBack) {
  Tile tile(0);
  for (int i = 0; i < 255; ++i) tile.set(i, {i, static_cast<std::uint8_t>(i + 1)});
  std::vector<BlockUpdate> sent;
  for (std::uint8_t block = 0; block < 4; ++block) {
    sent.push_back({kSetting.sequence, {{}, {}, block}, 0, 1, diff(nullptr, &tile, block)});
  }
  const auto patch = write_patch(sent, kSetting, kExact, {}, 4000);
  const auto read = read_patch(patch.bytes, kSetting, {});
  ASSERT_TRUE(read) << read.error().message;
  expect_same(sent, patch.taken, *read, 0);
}

TEST(Patch, AMappedCellTakesHalfAsMuchAsOneFromNothing) {
  Slope slope(2);
  ContextImage image;
  double bytes = 0.0;
  double cells = 0.0;
  for (std::uint8_t tick = 0; tick < 50; ++tick) {
    const auto sent = slope.step({});
    bytes += static_cast<double>(
        write_patch(sent, {kSetting.sequence, tick}, {}, image, kRoom).bytes.size());
    for (const BlockUpdate& update : sent) {
      cells += static_cast<double>(update.delta.changed.count());
    }
    merge(image, sent, tick);
  }
  EXPECT_LT(8.0 * bytes / cells, 10.0);  // Of which 4 are the probability, which is random here.
}

TEST(Patch, RandomBlocksOfAnyValuesComeBack) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    testing::RandomRecords random(seed);
    ContextImage image;
    const auto sent = random_blocks(random, 6);
    const auto patch = write_patch(sent, kSetting, {}, image, kRoom);
    ASSERT_FALSE(patch.taken.empty()) << "seed " << seed;
    ASSERT_LE(patch.bytes.size(), kRoom);
    const auto read = read_patch(patch.bytes, kSetting, image);
    ASSERT_TRUE(read) << "seed " << seed << ' ' << read.error().message;
    expect_same(sent, patch.taken, *read, seed);
  }
}

TEST(Patch, BothLayersShareAPatch) {
  Slope slope(3);
  auto sent = slope.step({});
  BlockUpdate through = testing::sample_block();
  through.sequence = kSetting.sequence;
  through.delta.cells[0].probability = 250;
  sent.push_back(through);
  const auto patch = write_patch(sent, kSetting, {}, {}, kRoom);
  EXPECT_EQ(patch.taken.size(), sent.size());
  const auto read = read_patch(patch.bytes, kSetting, {});
  ASSERT_TRUE(read) << read.error().message;
  expect_same(sent, patch.taken, *read, 3);
}

TEST(Patch, EvenTheWildestBlockFits) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    std::mt19937_64 random(seed);
    BlockUpdate update{kSetting.sequence, {EvidenceLayer::surface, {-7, -999, 5}, 3}, 8, 90, {}};
    update.delta.datum_mm = 99'000'000;
    update.delta.changed.set();
    for (Cell& cell : update.delta.cells) {
      cell = {99'000'000 + static_cast<int>(random() % 65'535) - 32'767,
              static_cast<std::uint8_t>(random())};
      if (!cell.known()) cell = {};
    }
    const auto patch = write_patch({&update, 1}, kSetting, {}, {}, kEnoughForABlock);
    ASSERT_EQ(patch.taken.size(), 1U) << "seed " << seed;
    ASSERT_LE(patch.bytes.size(), kEnoughForABlock);
    const auto read = read_patch(patch.bytes, kSetting, {});
    ASSERT_TRUE(read) << read.error().message;
    expect_same({update}, patch.taken, *read, seed);
  }
}

TEST(Patch, TheFirstBlocksThatFitAreTaken) {
  Slope slope(4);
  slope.step({});
  const auto sent = slope.step({});
  const auto all = write_patch(sent, kSetting, {}, {}, kRoom);
  ASSERT_EQ(all.taken.size(), sent.size());
  for (std::size_t room = 0; room < all.bytes.size(); room += 7) {
    const auto some = write_patch(sent, kSetting, {}, {}, room);
    ASSERT_LE(some.bytes.size(), room);
    for (std::size_t i = 0; i < some.taken.size(); ++i) ASSERT_EQ(some.taken[i], i);
    if (room > 100) {
      ASSERT_GT(some.bytes.size(), room / 2) << room;
    }
  }
}

TEST(Patch, AnotherImageIsNoHarmButNonsense) {
  Slope slope(5);
  ContextImage image;
  merge(image, slope.step({}), 1);
  const auto patch = write_patch(slope.step({}), kSetting, {}, image, kRoom);
  const auto read = read_patch(patch.bytes, kSetting, {});
  if (read) {
    EXPECT_LE(read->size(), kMaxPatchBlocks);
  }
}

/// What every reader may count on, whatever the bytes were.
void expect_within_bounds(const Result<std::vector<BlockUpdate>>& read) {
  if (!read) return;
  std::size_t cells = 0;
  ASSERT_LE(read->size(), kMaxPatchBlocks);
  for (const BlockUpdate& update : *read) {
    ASSERT_TRUE(update.delta.changed.any());
    ASSERT_LT(update.base, update.version);
    ASSERT_LE(std::abs(update.key.tile.tx), kMaxTileCoordinate);
    ASSERT_LE(std::abs(update.key.tile.ty), kMaxTileCoordinate);
    ASSERT_LT(update.key.block, kBlocksPerTile);
    cells += update.delta.changed.count();
    for (std::size_t i = 0; i < kBlockCells; ++i) {
      const Cell& cell = update.delta.cells.at(i);
      if (!update.delta.changed[i] || !cell.known()) continue;
      ASSERT_LE(std::abs(std::int64_t{cell.height_mm} - update.delta.datum_mm),
                Tile::kHeightLimitMm);
      ASSERT_TRUE(HeightMap::storable(cell.height_mm));
    }
  }
  ASSERT_LE(cells, kMaxPatchCells);
}

TEST(Patch, RandomBytesAreRefusedOrWithinBounds) {
  ContextImage image;
  Slope slope(6);
  merge(image, slope.step({}), 1);
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    std::mt19937_64 random(seed);
    std::vector<std::uint8_t> bytes(random() % 200);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    expect_within_bounds(read_patch(bytes, kSetting, image));
  }
}

TEST(Patch, DamagedBytesAreRefusedOrWithinBounds) {
  ContextImage image;
  Slope slope(7);
  merge(image, slope.step({}), 1);
  const auto patch = write_patch(slope.step({}), kSetting, {}, image, kRoom);
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    std::mt19937_64 random(seed);
    auto bytes = patch.bytes;
    for (std::uint64_t i = 0; i <= random() % 3; ++i) {
      bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1U << (random() % 8));
    }
    if (random() % 2 == 0) bytes.resize(random() % bytes.size());
    expect_within_bounds(read_patch(bytes, kSetting, image));
  }
}

TEST(Patch, NoBytesCostMuchTime) {
  // What a decoder finds likely again and again makes the longest work of few bytes.
  const auto start = std::chrono::steady_clock::now();
  for (int fill = 0; fill < 256; ++fill) {
    const std::vector<std::uint8_t> bytes(1200, static_cast<std::uint8_t>(fill));
    expect_within_bounds(read_patch(bytes, kSetting, {}));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST(Patch, EmptyBytesAreRefused) { EXPECT_FALSE(read_patch({}, kSetting, {})); }

}  // namespace
}  // namespace cairn::proto
