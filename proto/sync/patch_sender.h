#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "proto/codec/frame.h"
#include "proto/codec/patch.h"

namespace cairn::proto {

/// The robot's half of the common ground on which patches are told (PROTOCOL.md, "Common ground"):
/// remembers what went out in which frame, merges it into the image once the server has
/// acknowledged it, and names in each patch the frames that were merged lately.
class PatchSender {
 public:
  /// How finely the robot's maps are written; patches of other values are exact ones.
  void set_coarseness(const Coarseness& coarseness) { coarseness_ = coarseness; }

  /// A round of evidence sets out: what was acknowledged since the last one is merged. All frames
  /// of a round are told on the same image, so that those who overtake each other do no harm.
  void begin_round(std::uint32_t last_number);
  /// Adds a patch of as many of these blocks, the first ones first, as the frame has room for.
  /// Returns their indices. Numbers ascend. Requires: as write_patch.
  /// `view`: where the robot is in the blocks' submap, if it is in it.
  std::vector<std::size_t> fill(FrameWriter& frame, std::uint32_t number,
                                std::span<const BlockUpdate> blocks,
                                const std::optional<Viewpoint>& view);
  void on_acked(std::uint32_t number);
  /// A new session: both ends begin with an empty image.
  void on_session();
  /// The server does not have the image of this epoch: the next patch begins with an empty one.
  void on_ground_lost(std::uint8_t epoch);

 private:
  struct Part {
    std::uint32_t sequence = 0;
    std::uint8_t tick = 0;
    std::vector<ToldBlock> blocks;
  };
  /// What a frame told, and on how much.
  struct Sent {
    std::uint8_t epoch = 0;
    std::uint32_t merged = 0;
    std::vector<Part> parts;
  };
  struct Acked {
    std::uint32_t number = 0;
    std::vector<Part> parts;
  };

  void begin_anew();
  [[nodiscard]] CommonGround ground_for(std::uint32_t number) const;

  Coarseness coarseness_;
  ContextImage image_;
  std::uint8_t epoch_ = 0;
  std::uint8_t tick_ = 0;
  std::uint32_t merged_ = 0;            ///< Frames merged in this epoch.
  std::deque<std::uint32_t> unproven_;  ///< The last of them: the server may not know. [Limit: ≤
                                        ///< kMaxGroundFrames]
  std::map<std::uint32_t, Sent> sent_;  ///< [Limit: ≤ Flight::kReach]
  std::vector<Acked> acked_;            ///< Not merged yet. [Limit: ≤ Flight::kReach]
};

}  // namespace cairn::proto
