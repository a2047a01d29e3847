#pragma once

#include <cstdlib>
#include <filesystem>

namespace cairn::test {

/// Where real logs, terrain and planning benchmarks are: $CAIRN_DATA, else `shared/data` beside the
/// source tree. Empty when there is none; what needs it then says "skipped: …".
inline std::filesystem::path data_folder() {
  const char* named = std::getenv("CAIRN_DATA");  // NOLINT(concurrency-mt-unsafe): no threads yet.
  const std::filesystem::path folder = named != nullptr ? named : CAIRN_DATA_DEFAULT;
  return std::filesystem::is_directory(folder) ? folder : std::filesystem::path{};
}

}  // namespace cairn::test
