#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/common/result.h"
#include "core/map/submap.h"

namespace cairn::agent {

/// The files of a spool, one per submap, each replaced at once or not at all: written beside, made
/// durable, renamed. One process at a time. Every call may wait for the disk.
class SpoolFolder {
 public:
  /// [bytes] A file beyond it is no submap's.
  static constexpr std::uint64_t kMaxFileBytes = 64U << 20U;
  static constexpr const char* kSuffix = ".submap";
  static constexpr const char* kAside = "aside";  ///< Folder of what was refused.

  /// A file's name tells the order in which submaps were begun, and which it is.
  struct Name {
    std::uint64_t order = 0;
    SubmapId id;
  };
  struct File {
    Name name;
    std::uint64_t bytes = 0;
  };

  /// Makes the folder if it is not there. conflict: another agent uses it.
  static Result<std::unique_ptr<SpoolFolder>> open(const std::filesystem::path& folder);
  ~SpoolFolder();
  SpoolFolder(const SpoolFolder&) = delete;
  SpoolFolder& operator=(const SpoolFolder&) = delete;

  /// What is there, in its order. Half-written files of an earlier run are removed.
  [[nodiscard]] Result<std::vector<File>> list();
  /// Durable when it returns without an error; after an error the file is as it was.
  Status write(const Name& name, const std::vector<std::uint8_t>& bytes);
  [[nodiscard]] Result<std::vector<std::uint8_t>> read(const Name& name) const;
  Status remove(const Name& name);
  /// Moves it to the folder `aside`, out of the spool's way.
  Status set_aside(const Name& name);
  [[nodiscard]] std::filesystem::path path_of(const Name& name) const;

 private:
  SpoolFolder(std::filesystem::path folder, int folder_fd, int lock_fd);

  std::filesystem::path folder_;
  int folder_fd_;
  int lock_fd_;
};

}  // namespace cairn::agent
