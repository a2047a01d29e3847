#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "proto/codec/patch.h"

namespace cairn::proto {

/// The server's half of the common ground (PatchSender): keeps what patches told until the robot
/// says that it merged it, and reads each patch on the image that it names.
class PatchReceiver {
 public:
  /// [frames] Whose patches are kept; a robot has never so many under way.
  static constexpr std::size_t kMaxPending = 128;
  static constexpr std::size_t kMaxPendingCells = 131'072;  ///< Of them all: 1.6 MB.

  enum class Outcome : std::uint8_t {
    read,
    late,  ///< Told on an image that was since left: take it as lost, it comes again.
    lost,  ///< Told on what is not here, or nonsense: the robot must begin with an empty image.
  };
  struct Reading {
    Outcome outcome = Outcome::lost;
    std::vector<BlockUpdate> blocks;  ///< When read.
  };
  /// Reads a patch of frame `number`. Patches of one frame come in their order.
  [[nodiscard]] Reading read(std::uint32_t number, const EvidencePatch& patch);

 private:
  struct Part {
    std::uint32_t sequence = 0;
    std::uint8_t tick = 0;
    std::vector<ToldBlock> blocks;
  };

  Outcome stand_on(std::uint32_t number, const CommonGround& ground);
  void begin_anew(std::uint8_t epoch);
  void drop(std::map<std::uint32_t, std::vector<Part>>::iterator pending);
  void keep(std::uint32_t number, const EvidencePatch& patch,
            const std::vector<BlockUpdate>& blocks);

  ContextImage image_;
  std::uint8_t epoch_ = 0;
  std::uint32_t merged_ = 0;
  std::map<std::uint32_t, std::vector<Part>> pending_;  ///< [Limit: ≤ kMaxPending]
  std::size_t pending_cells_ = 0;
};

}  // namespace cairn::proto
