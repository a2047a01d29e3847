#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/common/result.h"
#include "core/delta/block.h"
#include "core/map/packed_tile.h"
#include "core/map/submap.h"

namespace cairn::server {

/// Facts of a site, fixed when it is founded.
struct SiteInfo {
  std::string name;
  std::uint64_t epoch = 0;  ///< Random; a store made anew has another.
  int cell_size_mm = 125;
  std::int64_t founded_unix_s = 0;
};

/// How far a submap has come.
enum class SubmapState : std::uint8_t {
  open = 0,    ///< The robot may add to it.
  closed = 1,  ///< Its robot has closed it; some blocks may still be missing.
  merged = 2,  ///< Complete and folded into the long-term map.
};

struct SubmapRow {
  SubmapId id;
  std::string robot;
  std::uint32_t head_version = 0;
  SubmapPose T_site_submap;
  SubmapState state = SubmapState::open;
  std::uint32_t blocks = 0;          ///< Expected in all, once closed.
  std::uint64_t final_versions = 0;  ///< Expected sum of block versions, once closed.
  std::uint64_t merge_order = 0;     ///< 1, 2, … in the order of folding; 0 = not merged.
  std::uint32_t edition = 0;         ///< Of the corrections of its boot that its pose accounts for.
  std::optional<SubmapLink> link{};
};

/// How two submaps lie to each other, found by registration: what keeps the map straight.
struct LoopRow {
  SubmapId from;
  SubmapId to;
  std::uint8_t status = 0;            ///< 0 takes part, 1 held back, 2 contradicts the rest.
  std::array<double, 4> T_from_to{};  ///< x, y, z [m], yaw [rad].
  /// Of T_from_to, along the axes of `from`: the upper half of the matrix, row by row.
  std::array<double, 10> information{};
};

/// A block as held: version and absolute values (all known cells).
struct BlockRow {
  SubmapId id;
  BlockKey key;
  std::uint32_t version = 0;
  BlockDelta state;  ///< `changed` = known cells.
};

struct TileRow {
  TileKey key;
  std::uint64_t version = 0;  ///< merge_order of the last submap folded into it.
  PackedTile tile;
};

/// Two submaps that were compared, so that they need not be again.
struct TriedRow {
  SubmapId a;  ///< a < b
  SubmapId b;
  std::uint32_t tries = 0;
  double sigma_m = 0.0;  ///< How well b's place in a was known then.
};

/// What one transaction writes: all of it becomes durable, or none.
struct Transaction {
  std::vector<SubmapRow> submaps;            ///< Inserted or replaced.
  std::vector<BlockRow> blocks;              ///< Inserted or replaced.
  std::vector<TileRow> tiles;                ///< Inserted or replaced.
  std::vector<LoopRow> loops{};              ///< Inserted or replaced.
  std::vector<TriedRow> tried{};             ///< Inserted or replaced.
  std::vector<TileKey> erased_tiles{};       ///< Removed, before tiles are inserted.
  std::map<std::string, std::string> notes;  ///< Small named values (next command id, …).
  [[nodiscard]] bool empty() const {
    return submaps.empty() && blocks.empty() && tiles.empty() && loops.empty() && tried.empty() &&
           erased_tiles.empty() && notes.empty();
  }
};

/// What `verify` found.
struct StoreReport {
  std::uint64_t submaps = 0;
  std::uint64_t blocks = 0;
  std::uint64_t tiles = 0;
  std::uint64_t loops = 0;
  std::vector<std::string> faults;  ///< One line each, at most kMaxFaults.
  static constexpr std::size_t kMaxFaults = 100;
};

/// The durable memory of one site. One thread at a time.
class Store {
 public:
  Store() = default;
  virtual ~Store() = default;
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  [[nodiscard]] virtual const SiteInfo& site() const = 0;
  /// Durable when it returns success.
  virtual Status commit(const Transaction& transaction) = 0;

  /// All of each kind; corrupt when a row fails its checksum or a bound (the message names it).
  virtual Result<std::vector<SubmapRow>> submaps() = 0;
  virtual Result<std::vector<BlockRow>> blocks_of(const SubmapId& id) = 0;
  virtual Result<std::vector<TileRow>> tiles() = 0;
  virtual Result<std::vector<LoopRow>> loops() = 0;
  virtual Result<std::vector<TriedRow>> tried() = 0;
  virtual Result<std::map<std::string, std::string>> notes() = 0;
  /// Reads every row and checks every checksum and bound.
  virtual Result<StoreReport> verify() = 0;
};

}  // namespace cairn::server
