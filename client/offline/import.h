#pragma once

#include "client/offline/import_request.h"
#include "client/offline/site.h"

namespace cairn::offline {

struct ImportReport {
  bool founded = false;
  SiteFacts site;
  int columns = 0;
  int rows = 0;
  std::int64_t cells = 0;           ///< Known ones in the file.
  std::int64_t submaps = 0;         ///< That they came in as.
  std::int64_t lone_obstacles = 0;  ///< See map_files::Relief.
  std::int64_t too_steep = 0;       ///< Left unknown: beyond what a tile's heights span (±32 m).
  double west_m = 0.0;              ///< Where the file's south-west corner lies in the site.
  double south_m = 0.0;
};

/// Reads a map file and lays it into a site as evidence of a robot named kImporter: submaps of
/// 256 × 256 cells, tied stiffly to each other, through the same door that robots' submaps take,
/// so that the map stays the fold of its evidence. Where the site knows something already, the two
/// are combined by the rules of evidence.
///
/// A founded site takes the file's cell size and coordinates; where these lie beyond 100 km the
/// file's south-west corner becomes the origin, and the store remembers by how much it was moved.
/// Memory: 4 bytes per cell of the file (at most 256 MB), and the site's map.
/// Errors: those of the readers and of the store; invalid_argument for an unknown, odd or different
/// cell size or a place beyond 100 km. Nothing is written then, but a failing disk may leave the
/// first part of a large import.
[[nodiscard]] Result<ImportReport> import_map(const ImportRequest& request);

inline constexpr const char* kImporter = "import";
/// [1/255] How sure imported cells are: as sure as after four hits, so that what robots see
/// corrects them.
inline constexpr std::uint8_t kImportedProbability = 230;

}  // namespace cairn::offline
