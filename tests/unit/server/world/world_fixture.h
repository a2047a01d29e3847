#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/map/fold.h"
#include "server/world/audit.h"
#include "server/world/world.h"
#include "tests/support/evidence_frames.h"
#include "tests/unit/server/store/store_fixture.h"

/// What the tests of the world share.
namespace cairn::server {

using Evidence = proto::ServerLink::Evidence;

inline constexpr Cell kFloor{0, 200};

/// A disk that refuses some commits.
class FlakyStore : public Store {
 public:
  struct Switch {
    std::set<int> failing;  ///< Which commits fail, counted from 1.
    int commits = 0;
  };

  FlakyStore(std::unique_ptr<Store> store, std::shared_ptr<Switch> disk)
      : store_(std::move(store)), disk_(std::move(disk)) {}

  [[nodiscard]] const SiteInfo& site() const override { return store_->site(); }
  Status commit(const Transaction& transaction) override {
    if (disk_->failing.contains(++disk_->commits)) return Error{ErrorCode::io, "the disk is full"};
    return store_->commit(transaction);
  }
  Result<std::vector<SubmapRow>> submaps() override { return store_->submaps(); }
  Result<std::vector<BlockRow>> blocks_of(const SubmapId& id) override {
    return store_->blocks_of(id);
  }
  Result<std::vector<TileRow>> tiles() override { return store_->tiles(); }
  Result<std::vector<LoopRow>> loops() override { return store_->loops(); }
  Result<std::vector<TriedRow>> tried() override { return store_->tried(); }
  Result<std::map<std::string, std::string>> notes() override { return store_->notes(); }
  Result<StoreReport> verify() override { return store_->verify(); }

 private:
  std::unique_ptr<Store> store_;
  std::shared_ptr<Switch> disk_;
};

/// A robot that writes evidence: rectangles of cells, submap after submap.
class Surveyor {
 public:
  explicit Surveyor(std::uint64_t boot = 1) : boot_(boot) {}

  proto::EvidenceSender evidence;
  std::vector<Submap> closed;  ///< As the robot closed them.

  void begin(SubmapPose T_site_submap = {}) { evidence.begin(boot_, T_site_submap, 125); }
  void see(CellIndex from, int size, Cell cell, EvidenceLayer layer = EvidenceLayer::surface) {
    std::vector<CellIndex> changed;
    for (std::int32_t y = from.y; y < from.y + size; ++y) {
      for (std::int32_t x = from.x; x < from.x + size; ++x) {
        if (layer_of(*evidence.open_submap(), layer).set({x, y}, cell)) changed.push_back({x, y});
      }
    }
    evidence.touch(layer, changed);
  }
  void close() {
    closed.push_back(*evidence.open_submap());
    evidence.close();
    closed.back().closed = true;
  }
  /// A whole submap: floor of 40 × 40 cells from there on, and a box in it.
  void survey(CellIndex from, std::int32_t height_mm, SubmapPose T_site_submap = {}) {
    begin(T_site_submap);
    see(from, 40, {height_mm, 200});
    see({from.x + 10, from.y + 10}, 5, {height_mm + 600, 220});
    close();
  }
  /// Cells of both layers, here and there around a place.
  void scribble(std::mt19937_64& random, CellIndex around) {
    const auto between = [&random](int least, int most) {
      return std::uniform_int_distribution<int>(least, most)(random);
    };
    for (int i = 0; i < 20; ++i) {
      const auto layer = i % 3 == 0 ? EvidenceLayer::seen_through : EvidenceLayer::surface;
      const CellIndex at{around.x + between(-20, 20), around.y + between(-20, 20)};
      see(at, between(1, 4), {between(-900, 900), static_cast<std::uint8_t>(between(0, 255))},
          layer);
    }
  }
  std::vector<Evidence> frames() { return proto::testing::frames_of(evidence, number_); }
  [[nodiscard]] std::uint64_t boot() const { return boot_; }

 private:
  std::uint64_t boot_;
  std::uint32_t number_ = 0;
};

inline HeightMap fold_of(const std::vector<Submap>& submaps) {
  HeightMap site(125);
  for (const Submap& submap : submaps) (void)fold(site, submap, SensorModel{});
  return site;
}

/// Whether the snapshot's tiles are exactly the map's, bit by bit; tiles of which nothing is known
/// are left out.
inline ::testing::AssertionResult shows(const MapSnapshot& snapshot, const HeightMap& map) {
  std::size_t tiles = 0;
  for (const auto& [key, tile] : map.tiles()) {
    if (tile->known_count() == 0) continue;
    ++tiles;
    const auto found = snapshot.tiles.find(key);
    if (found == snapshot.tiles.end()) {
      return ::testing::AssertionFailure() << "tile " << key.tx << ", " << key.ty << " is missing";
    }
    if (!(*found->second == PackedTile::pack(*tile))) {
      return ::testing::AssertionFailure() << "tile " << key.tx << ", " << key.ty << " differs";
    }
  }
  if (tiles == snapshot.tiles.size()) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << snapshot.tiles.size() << " tiles, not " << tiles;
}

inline bool same_tiles(const MapSnapshot& a, const MapSnapshot& b) {
  if (a.tiles.size() != b.tiles.size()) return false;
  for (const auto& [key, tile] : a.tiles) {
    const auto found = b.tiles.find(key);
    if (found == b.tiles.end() || !(*found->second == *tile)) return false;
  }
  return true;
}

/// A world on a real store in a folder of its own.
class WorldTest : public StoreTest {
 protected:
  std::shared_ptr<FlakyStore::Switch> disk = std::make_shared<FlakyStore::Switch>();
  std::unique_ptr<World> world = open(found());

  std::unique_ptr<World> open(std::unique_ptr<Store> store) const {
    auto opened = World::open(std::make_unique<FlakyStore>(std::move(store), disk), SensorModel{});
    EXPECT_TRUE(opened) << opened.error().message;
    return std::move(opened).value();
  }
  void restart() {
    world.reset();
    world = open(reopen());
  }
  /// Another new site.
  void found_anew() {
    file_ += "+";
    world = open(found());
  }
  /// Ends the world and audits what it leaves behind.
  ::testing::AssertionResult is_sound() {
    world.reset();
    const auto store = reopen();
    const auto audited = audit(*store, SensorModel{});
    if (!audited) return ::testing::AssertionFailure() << audited.error().message;
    if (audited->sound()) return ::testing::AssertionSuccess();
    const auto& faults = audited->faults.empty() ? audited->store.faults : audited->faults;
    return ::testing::AssertionFailure() << faults.front();
  }
  World::Staged stage(const Surveyor& robot, const Evidence& evidence) const {
    return world->stage("rover-1", robot.boot(), evidence);
  }
  /// All that the robot has to say becomes durable and visible.
  void deliver(Surveyor& robot) const {
    for (const Evidence& evidence : robot.frames()) {
      const World::Staged staged = stage(robot, evidence);
      EXPECT_TRUE(staged.accepted);
      EXPECT_TRUE(staged.refusals.empty());
    }
    commit_and_publish();
  }
  void commit_and_publish() const {
    const Status done = world->commit();
    EXPECT_TRUE(done) << done.error().message;
    world->publish();
  }
  [[nodiscard]] Cell cell(CellIndex index) const {
    const auto map = world->snapshot();
    const auto found = map->tiles.find(HeightMap::tile_of(index));
    return found == map->tiles.end()
               ? Cell{}
               : found->second->unpack().cell(HeightMap::index_in_tile(index));
  }
};

}  // namespace cairn::server
