#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/common/result.h"
#include "core/delta/coarseness.h"
#include "core/delta/context_image.h"
#include "proto/codec/bit_mixer.h"
#include "proto/codec/patch_view.h"
#include "proto/codec/records.h"

/// Changes of one submap's blocks as few bytes as possible (PROTOCOL.md, "Patches"): which blocks
/// and cells changed and their new absolute values, each bit predicted from the cells around it, as
/// far as they are in the packet or in the image that both ends hold.
namespace cairn::proto {

/// Bounds of one patch, and so of the work that a packet can cause.
inline constexpr std::size_t kMaxPatchBlocks = 255;
inline constexpr std::size_t kMaxPatchCells = 4096;
inline constexpr std::int32_t kMaxPatchSpan = 64;  ///< [blocks] Width and height of its frame.
/// [bytes] A patch with room for so many can always take a block, however wild.
inline constexpr std::size_t kEnoughForABlock = 880;

/// What both ends know about a patch without reading it.
struct PatchSetting {
  std::uint32_t sequence = 0;  ///< Of the submap.
  std::uint8_t tick = 0;       ///< Counts the rounds in which evidence set out.
  /// For the writer, if it knows: the reader finds it in the patch.
  std::optional<Viewpoint> view{};
};

struct PatchBytes {
  std::vector<std::uint8_t> bytes;
  std::vector<std::size_t> taken;  ///< Indices into the blocks that are in it, ascending.
};

/// Writes as many of the blocks, the first ones first, as fit into `most_bytes` (and the bounds
/// above, of one level). All are of the setting's submap. Values that are not of the coarseness
/// make the patch an exact one. Empty when not even the first fits.
/// Requires: each block has changed cells, base < version, no key twice, heights within
/// Tile::kHeightLimitMm of the datum and storable.
[[nodiscard]] PatchBytes write_patch(std::span<const BlockUpdate> blocks,
                                     const PatchSetting& setting, const Coarseness& coarseness,
                                     const ContextImage& image, std::size_t most_bytes);

/// Reads what `write_patch` wrote with an equal image. The error says which rule the bytes break.
[[nodiscard]] Result<std::vector<BlockUpdate>> read_patch(std::span<const std::uint8_t> bytes,
                                                          const PatchSetting& setting,
                                                          const ContextImage& image);

/// The same with another state of the mixer than the trained one, which learns on: for training.
/// Requires: values of the coarseness.
[[nodiscard]] std::vector<std::uint8_t> write_patch_learning(
    std::span<const BlockUpdate> blocks, const PatchSetting& setting, const Coarseness& coarseness,
    const ContextImage& image, MixerState& state, const Learning& learning);

/// The mixer's state at the beginning of every patch of such values, part of the protocol version:
/// exact ones have one of their own, which knows whole tiles of finished maps.
[[nodiscard]] const MixerState& trained_priors(const Coarseness& coarseness);
/// How it learns within a packet.
inline constexpr Learning kPacketLearning{};

}  // namespace cairn::proto
