#include "proto/codec/patch.h"

#include <algorithm>
#include <cassert>
#include <optional>

#include "proto/codec/patch_frame.h"

namespace cairn::proto {
namespace {

using patch::BlockAt;
using patch::Manner;

constexpr int kMostTries = 6;
/// Guessed length of a patch before it is written.
constexpr std::size_t kGuessedBitsPerCell = 8;
constexpr std::size_t kGuessedBitsPerBlock = 12;
constexpr std::array kLayers = {EvidenceLayer::surface, EvidenceLayer::seen_through};

/// The trained state, to be learned on from. Its memory is kept: it is as large as 400 packets.
MixerState& fresh_state(const Coarseness& coarseness) {
  static thread_local MixerState state;
  state = trained_priors(coarseness);
  return state;
}

bool all_of_coarseness(const BlockUpdate& update, const Coarseness& coarseness) {
  for (std::size_t i = 0; i < kBlockCells; ++i) {
    if (update.delta.changed[i] && !representable(update.delta.cells.at(i), coarseness)) {
      return false;
    }
  }
  return true;
}

std::size_t guessed_bits(const BlockUpdate& update) {
  return kGuessedBitsPerBlock + kGuessedBitsPerCell * update.delta.changed.count();
}

/// The frame that one layer's chosen blocks take, and whether one more keeps it within bounds.
class Extent {
 public:
  bool take(const BlockKey& key) {
    const BlockAt at = patch::block_at(key);
    if (!low_) {
      low_ = high_ = at;
      return true;
    }
    const BlockAt low{std::min(low_->x, at.x), std::min(low_->y, at.y)};
    const BlockAt high{std::max(high_->x, at.x), std::max(high_->y, at.y)};
    if (high.x - low.x >= kMaxPatchSpan || high.y - low.y >= kMaxPatchSpan) return false;
    low_ = low;
    high_ = high;
    return true;
  }

 private:
  std::optional<BlockAt> low_;
  std::optional<BlockAt> high_;
};

/// Chooses blocks in their order, up to so many guessed bits and to the bounds of a patch.
std::vector<std::size_t> choose(std::span<const BlockUpdate> blocks, std::size_t most_bits) {
  std::vector<std::size_t> chosen;
  std::array<Extent, 2> extents;
  std::size_t bits = 0;
  std::size_t cells = 0;
  for (std::size_t i = 0; i < blocks.size() && chosen.size() < kMaxPatchBlocks; ++i) {
    const BlockUpdate& update = blocks[i];
    const std::size_t changed = update.delta.changed.count();
    bits += guessed_bits(update);
    if (bits > most_bits && !chosen.empty()) break;
    if (cells + changed > kMaxPatchCells) break;
    if (update.key.tile.level != blocks.front().key.tile.level) continue;
    if (!extents.at(static_cast<std::size_t>(update.key.layer)).take(update.key)) continue;
    cells += changed;
    chosen.push_back(i);
  }
  return chosen;
}

bool all_of_coarseness(std::span<const BlockUpdate> blocks, const std::vector<std::size_t>& chosen,
                       const Coarseness& coarseness) {
  return std::ranges::all_of(
      chosen, [&](std::size_t i) { return all_of_coarseness(blocks[i], coarseness); });
}

/// The chosen blocks of one layer in the order in which they are told.
std::vector<BlockUpdate> of_layer(std::span<const BlockUpdate> blocks,
                                  const std::vector<std::size_t>& chosen, EvidenceLayer layer) {
  std::vector<BlockUpdate> found;
  for (const std::size_t i : chosen) {
    if (blocks[i].key.layer == layer) found.push_back(blocks[i]);
  }
  std::ranges::sort(found, [](const BlockUpdate& a, const BlockUpdate& b) {
    const BlockAt at = patch::block_at(a.key);
    const BlockAt bt = patch::block_at(b.key);
    return at.y != bt.y ? at.y < bt.y : at.x < bt.x;
  });
  return found;
}

std::vector<std::uint8_t> write_chosen(std::span<const BlockUpdate> blocks,
                                       const std::vector<std::size_t>& chosen,
                                       const PatchSetting& setting, const Manner& manner,
                                       const ContextImage& image, MixerState& state,
                                       const Learning& learning) {
  std::vector<std::uint8_t> bytes;
  RangeEncoder encoder(bytes);
  using Coder = patch::PatchCoder<RangeEncoder>;
  Coder::code_manner(encoder, manner);
  Coder coder(encoder, state, learning, setting, manner, image);
  coder.code_view();
  for (const EvidenceLayer layer : kLayers) {
    auto told = of_layer(blocks, chosen, layer);
    [[maybe_unused]] const bool nothing = told.empty();
    [[maybe_unused]] const bool sound = coder.code_layer(layer, told);
    assert(sound || nothing);
  }
  encoder.finish();
  return bytes;
}

/// The first block alone, without statistics: however wild it is, its length is bounded.
PatchBytes write_plain(std::span<const BlockUpdate> blocks, const PatchSetting& setting,
                       const ContextImage& image, std::size_t most_bytes) {
  auto bytes = write_chosen(blocks.first(1), {0}, setting, {kExact, true}, image,
                            fresh_state(kExact), kPacketLearning);
  if (bytes.size() > most_bytes) return {};
  return {std::move(bytes), {0}};
}

}  // namespace

PatchBytes write_patch(std::span<const BlockUpdate> blocks, const PatchSetting& setting,
                       const Coarseness& coarseness, const ContextImage& image,
                       std::size_t most_bytes) {
  if (blocks.empty()) return {};
  std::size_t most_bits = most_bytes * 8;
  PatchBytes best;
  for (int tries = 0; tries < kMostTries; ++tries) {
    const auto chosen = choose(blocks, most_bits);
    if (chosen.size() <= best.taken.size()) break;
    const Coarseness told = all_of_coarseness(blocks, chosen, coarseness) ? coarseness : kExact;
    auto bytes =
        write_chosen(blocks, chosen, setting, {told}, image, fresh_state(told), kPacketLearning);
    std::size_t guessed = 0;
    for (const std::size_t i : chosen) guessed += guessed_bits(blocks[i]);
    const bool fits = bytes.size() <= most_bytes;
    // In proportion, a little less: then it mostly fits.
    const std::size_t better = guessed * most_bytes / std::max<std::size_t>(bytes.size(), 1);
    most_bits = better - better / 32;
    if (fits) {
      const bool nearly_full = bytes.size() * 8 > most_bytes * 7;
      best = {std::move(bytes), chosen};
      if (nearly_full || chosen.size() == blocks.size()) break;
    } else if (!best.taken.empty() || chosen.size() == 1) {
      break;
    }
  }
  return best.taken.empty() ? write_plain(blocks, setting, image, most_bytes) : best;
}

std::vector<std::uint8_t> write_patch_learning(std::span<const BlockUpdate> blocks,
                                               const PatchSetting& setting,
                                               const Coarseness& coarseness,
                                               const ContextImage& image, MixerState& state,
                                               const Learning& learning) {
  const auto chosen = choose(blocks, SIZE_MAX);
  assert(all_of_coarseness(blocks, chosen, coarseness));
  return write_chosen(blocks, chosen, setting, {coarseness}, image, state, learning);
}

Result<std::vector<BlockUpdate>> read_patch(std::span<const std::uint8_t> bytes,
                                            const PatchSetting& setting,
                                            const ContextImage& image) {
  RangeDecoder decoder(bytes);
  using Coder = patch::PatchCoder<RangeDecoder>;
  const Manner manner = Coder::code_manner(decoder, {});
  if (const std::string wrong = faults(manner.coarseness); !wrong.empty()) {
    return Error{ErrorCode::corrupt, "patch: " + wrong};
  }
  Coder coder(decoder, fresh_state(manner.coarseness), kPacketLearning, setting, manner, image);
  coder.code_view();
  std::vector<BlockUpdate> blocks;
  for (const EvidenceLayer layer : kLayers) {
    std::vector<BlockUpdate> told;
    const bool sound = coder.code_layer(layer, told);
    if (!sound || decoder.overrun()) {
      return Error{ErrorCode::corrupt, "patch: a bound is broken; the ends do not agree"};
    }
    blocks.insert(blocks.end(), told.begin(), told.end());
  }
  if (blocks.empty() || !decoder.all_read()) {
    return Error{ErrorCode::corrupt, "patch: ends where it should not"};
  }
  return blocks;
}

}  // namespace cairn::proto
