#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "core/common/result.h"
#include "core/graph/level_pose.h"
#include "core/map/submap.h"

namespace cairn::server {

/// How the pose graph has moved what one boot of a robot places: a stiff motion for each edition.
/// A pose that the robot made before it heard of the newest edition is brought there.
class Corrections {
 public:
  /// [editions] Older ones are forgotten: a pose that old lies where the oldest kept one leaves it.
  static constexpr std::size_t kMaxKept = 32;

  [[nodiscard]] std::uint32_t edition() const { return edition_; }
  /// Everything the boot placed moves stiffly with a submap that lay at `was` and lies at `is`;
  /// returns the new edition. (A motion told by its ends is exact where it matters: rounded angles
  /// do not act over the distance to the site's origin.)
  std::uint32_t add(const SubmapPose& was, const SubmapPose& is);
  /// A pose of that edition as it is now.
  [[nodiscard]] SubmapPose corrected(const SubmapPose& pose, std::uint32_t edition) const;

  /// As the note `moved/BOOT` of the site file has it (FORMAT.md).
  [[nodiscard]] std::string text() const;
  static Result<Corrections> from_text(const std::string& text);

 private:
  struct Motion {
    std::uint32_t edition = 0;
    SubmapPose was;
    SubmapPose is;
  };
  std::deque<Motion> motions_;  ///< [Limit: ≤ kMaxKept]
  std::uint32_t edition_ = 0;
};

/// The name of a boot's note, and back.
[[nodiscard]] std::string corrections_note(std::uint64_t boot);
[[nodiscard]] std::optional<std::uint64_t> boot_of_note(const std::string& name);

}  // namespace cairn::server
