#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/common/result.h"
#include "core/map/sensor_model.h"
#include "server/store/store.h"

namespace cairn::server {

/// What an audit of a site's store found. No faults: the store is sound.
struct Audit {
  StoreReport store;
  std::uint64_t merged_submaps = 0;
  std::uint64_t compared_tiles = 0;
  std::vector<std::string> faults;  ///< Beyond those of `store`; at most StoreReport::kMaxFaults.
  [[nodiscard]] bool sound() const { return store.faults.empty() && faults.empty(); }
};

/// Checks a store from the ground up: every row's checksum and bounds, and that the long-term map
/// is exactly the fold of the merged submaps in their order, each once. Takes as long as building
/// the map anew.
Result<Audit> audit(Store& store, const SensorModel& model);

}  // namespace cairn::server
