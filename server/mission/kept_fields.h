#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "core/planner/corridor.h"
#include "core/planner/field_keeper.h"
#include "core/planner/plan.h"
#include "server/mission/planning.h"

namespace cairn::server {

/// Where somebody wants to go on which site.
struct PlanTarget {
  std::string site;
  std::shared_ptr<const MapSnapshot> map;  ///< Of the site.
  PlanRequest request;
  PlannerConfig planner;
};

/// One goal's grid and field, brought from snapshot to snapshot by what changed between them.
class KeptField {
 public:
  explicit KeptField(std::uint8_t min_probability) : min_probability_(min_probability) {}

  /// Afterwards `grid` and `field` are what a new plan would make. Errors as drivable_grid's.
  [[nodiscard]] Status follow(const PlanTarget& target);

  /// Requires: follow succeeded.
  [[nodiscard]] const DrivableGrid& grid() const { return keeper_ ? keeper_->grid() : *closed_; }
  [[nodiscard]] Path plan(const PlanTarget& target) const;
  /// Fills in the field's directions; false when there is no field, as the goal is closed.
  [[nodiscard]] bool fill(Corridor& corridor) const;
  /// A closed goal has no field to keep.
  [[nodiscard]] bool worth_keeping() const { return keeper_.has_value(); }
  /// [bytes] With the tiles of the snapshot, which may be its last owner.
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  [[nodiscard]] Status start_anew(const PlanTarget& target, const MapWindow& window);
  /// nullopt when so much has changed that a new field is cheaper.
  [[nodiscard]] std::optional<std::vector<CellChange>> changes_to(const MapSnapshot& map) const;
  void compare(const TileKey& key, const PackedTile* tile, std::vector<CellChange>& changes) const;

  std::uint8_t min_probability_;
  std::shared_ptr<const MapSnapshot> map_;
  MapWindow window_;
  std::optional<FieldKeeper> keeper_;
  std::optional<DrivableGrid> closed_;  ///< When the goal is closed or outside.
};

/// The fields of the goals that were asked for lately, on all sites: a robot's present goal is
/// asked for with every change of the map. Those that were not used for longest go first.
/// Thread-safe; who asks for the same goal at the same time waits for the first.
class KeptFields {
 public:
  /// [bytes] Kept between requests, about 20 a cell; while a request is served its own comes on
  /// top, so beside them there may be one field per thread that plans. One that is larger alone is
  /// made anew for each request.
  static constexpr std::size_t kMostBytes = std::size_t{512} << 20;
  static constexpr std::size_t kMostFields = 64;

  explicit KeptFields(std::uint8_t min_probability, std::size_t most_bytes = kMostBytes)
      : min_probability_(min_probability), most_bytes_(most_bytes) {}

  using Use = std::function<void(const KeptField& field)>;
  /// Calls `use` with the goal's field, which is of the target's map. Errors as drivable_grid's.
  [[nodiscard]] Status with(const PlanTarget& target, const Use& use);

  [[nodiscard]] std::size_t memory_bytes() const;
  [[nodiscard]] std::size_t count() const;

 private:
  struct Entry {
    std::string site;
    CellIndex goal;
    PlannerConfig planner;
    std::mutex mutex;  ///< Guards `field`.
    KeptField field;
    std::size_t bytes = 0;  ///< As last counted; guarded by the cache's mutex.

    explicit Entry(std::uint8_t min_probability) : field(min_probability) {}
  };
  using Entries = std::list<std::shared_ptr<Entry>>;

  /// Moves it to the front.
  [[nodiscard]] std::shared_ptr<Entry> find_or_add(const PlanTarget& target);
  void account(const std::shared_ptr<Entry>& entry, std::size_t bytes, bool keep);
  void drop(Entries::iterator entry);

  std::uint8_t min_probability_;
  std::size_t most_bytes_;
  mutable std::mutex mutex_;
  Entries entries_;  ///< Newest first. [Limit: kMostFields, and most_bytes_ in all]
  std::size_t bytes_ = 0;
};

}  // namespace cairn::server
