#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/common/result.h"
#include "robot_agent/spool/kept_file.h"
#include "robot_agent/spool/spool_folder.h"

namespace cairn::agent {

struct SpoolConfig {
  std::filesystem::path folder;
  /// [bytes] Of all files. While one is replaced, its new form comes on top. [Limit: ≥ 1 MiB]
  std::uint64_t most_bytes = 256U << 20U;
  SpoolOwner owner;
  Coarseness coarseness;  ///< How finely submaps are written.
};

/// Submaps on disk within a bound of bytes. When it is reached the oldest detail goes first: the
/// layer seen through of one submap after the other, then whole submaps. Every call may wait for
/// the disk; one thread.
class SpoolStore {
 public:
  static Result<std::unique_ptr<SpoolStore>> open(const SpoolConfig& config);

  /// What went to make room.
  struct Thinned {
    std::vector<SubmapId> thinned;
    std::vector<SubmapId> dropped;
    std::vector<Error> refused;  ///< Files met that cannot be delivered, set aside.
  };
  /// Durable when it returns without an error. exhausted: it alone is more than the bound.
  Status save(const proto::KeptSubmap& kept, Thinned& went);
  /// Nothing happens when it is not there.
  Status remove(const SubmapId& id);
  /// A file that cannot be delivered is set aside; the error says why, and where it is now.
  Result<proto::KeptSubmap> load(const SubmapId& id);

  [[nodiscard]] bool contains(const SubmapId& id) const { return orders_.contains(id); }
  [[nodiscard]] std::vector<SubmapId> oldest_first() const;
  [[nodiscard]] std::size_t submaps() const { return entries_.size(); }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

 private:
  struct Entry {
    SubmapId id;
    std::uint64_t bytes = 0;
    bool thinned = false;  ///< In this run; a file thinned before is found to be so.
  };
  using Entries = std::map<std::uint64_t, Entry>;

  SpoolStore(SpoolConfig config, std::unique_ptr<SpoolFolder> folder);
  Status read_folder();
  /// So that so many bytes more fit; `except` stays as it is.
  Status make_room(std::uint64_t bytes, const SubmapId& except, Thinned& went);
  Status thin_entry(Entries::iterator entry, Thinned& went);
  Status set_aside(Entries::iterator entry, const Error& why);
  void forget(Entries::iterator entry);
  [[nodiscard]] Entries::iterator find(const SubmapId& id);

  SpoolConfig config_;
  std::unique_ptr<SpoolFolder> folder_;
  Entries entries_;  ///< By order of beginning.
  std::map<SubmapId, std::uint64_t> orders_;
  std::uint64_t bytes_ = 0;
};

}  // namespace cairn::agent
