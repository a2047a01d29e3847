#pragma once

#include <array>
#include <optional>
#include <string>

namespace cairn::offline {

/// A map file to be laid into a site's store.
struct ImportRequest {
  std::string map_file;
  std::string store;                ///< Founded when it does not exist.
  std::optional<std::string> name;  ///< Of a site that is founded; else the store's file name.
  /// [m] Size of the file's cells; needed where the file does not tell, but for
  /// Moving AI maps, which count in cells: 1 m.
  std::optional<double> cell_m;
  /// [m] Where the file's south-west corner and its height 0 lie in the site.
  std::optional<std::array<double, 3>> origin_m;
};

}  // namespace cairn::offline
