#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/map_files/raster.h"
#include "core/common/result.h"
#include "server/world/world.h"

/// What `cairn` does on a site's store without a server. It reads and writes stores through the
/// server's own store and world, so that both always agree on what a site is.
namespace cairn::offline {

/// Cells from the south-west to the north-east, both included.
struct CellExtent {
  CellIndex lowest;
  CellIndex highest;
};

/// What a store remembers of the files that it was imported from (FORMAT.md, notes).
struct ImportNotes {
  /// [m] To be added to the site's coordinates to get the files' (a national grid).
  map_files::RasterFrame::Corner offset;
  /// All that the files covered, known or not, so that exports cover it, too.
  std::optional<CellExtent> covered;
};

/// A store in our hands alone.
struct OpenStore {
  std::unique_ptr<server::Store> store;
  std::string file;
  ImportNotes notes;
};

/// not_found; conflict when a server holds it; corrupt or unsupported_version when it is no sound
/// store.
[[nodiscard]] Result<OpenStore> open_store(const std::string& file);
/// Makes one. conflict when the file exists; invalid_argument for a bad name or cell size.
[[nodiscard]] Result<OpenStore> found_store(const std::string& file, const std::string& name,
                                            int cell_size_mm);
[[nodiscard]] Status remember(OpenStore& store, const ImportNotes& notes);

/// A store with its whole long-term map in memory (about 3.3 bytes per known cell).
struct OpenSite {
  std::unique_ptr<server::World> world;
  std::string file;
  ImportNotes notes;
};

[[nodiscard]] Result<OpenSite> with_map(OpenStore store);
/// Both in one.
[[nodiscard]] Result<OpenSite> open_site(const std::string& file);

/// What `cairn map info` tells.
struct SiteFacts {
  std::string name;
  int cell_size_mm = 0;
  std::uint64_t map_version = 0;
  std::uint64_t known_cells = 0;
  std::uint64_t tiles = 0;
  std::uint64_t submaps = 0;
  std::uint64_t submaps_merged = 0;
  std::uint64_t bytes_on_disk = 0;
  std::optional<CellExtent> extent;  ///< See extent_of.
  std::int32_t lowest_mm = 0;        ///< Of the heights of the ground level.
  std::int32_t highest_mm = 0;
  struct Level {
    std::int8_t level = 0;
    std::uint64_t tiles = 0;
    std::uint64_t known_cells = 0;
  };
  std::vector<Level> levels;              ///< Sorted.
  map_files::RasterFrame::Corner offset;  ///< See ImportNotes.
};
[[nodiscard]] SiteFacts facts_of(const OpenSite& site);

/// All known cells of the ground level, and what imported files covered; none while there is
/// neither.
[[nodiscard]] std::optional<CellExtent> extent_of(const OpenSite& site);

/// What lies in `extent` of the ground level. exhausted when that is more than
/// HeightGrid::kMaxCells (5 bytes each).
[[nodiscard]] Result<HeightGrid> ground_in(const server::MapSnapshot& map,
                                           const CellExtent& extent);

}  // namespace cairn::offline
