#include "proto/sync/patch_receiver.h"

#include <algorithm>
#include <utility>

namespace cairn::proto {
namespace {

/// How far the count `a` is ahead of `b`; both wrap at 256.
int difference(std::uint8_t a, std::uint8_t b) {
  const auto ahead = static_cast<std::uint8_t>(a - b);
  return ahead < 128 ? ahead : ahead - 256;
}

}  // namespace

PatchReceiver::Reading PatchReceiver::read(std::uint32_t number, const EvidencePatch& patch) {
  const Outcome ground = stand_on(number, patch.ground);
  if (ground != Outcome::read) return {ground, {}};
  auto blocks = read_patch(patch.bytes, {patch.sequence, patch.tick}, image_);
  if (!blocks) return {Outcome::lost, {}};
  keep(number, patch, *blocks);
  return {Outcome::read, *std::move(blocks)};
}

/// Brings the image to where the patch was told on. It only ever moves on.
PatchReceiver::Outcome PatchReceiver::stand_on(std::uint32_t number, const CommonGround& ground) {
  const auto newer = static_cast<std::int8_t>(ground.epoch - epoch_);
  if (newer < 0) return Outcome::late;
  if (newer > 0) begin_anew(ground.epoch);
  const int merged_of_named = difference(static_cast<std::uint8_t>(merged_), ground.before);
  if (merged_of_named < 0) return Outcome::lost;
  if (merged_of_named > static_cast<int>(ground.back.size())) return Outcome::late;
  std::vector<std::uint32_t> frames;
  for (std::size_t i = static_cast<std::size_t>(merged_of_named); i < ground.back.size(); ++i) {
    frames.push_back(number - ground.back[i]);
  }
  const bool all_here =
      std::ranges::all_of(frames, [&](std::uint32_t frame) { return pending_.contains(frame); });
  if (!all_here) return Outcome::lost;
  for (const std::uint32_t frame : frames) {
    for (const Part& part : pending_[frame]) {
      for (const ToldBlock& told : part.blocks) image_.merge(part.sequence, told, part.tick);
    }
    drop(pending_.find(frame));
    ++merged_;
  }
  return Outcome::read;
}

void PatchReceiver::keep(std::uint32_t number, const EvidencePatch& patch,
                         const std::vector<BlockUpdate>& blocks) {
  Part part{patch.sequence, patch.tick, {}};
  for (const BlockUpdate& update : blocks) {
    part.blocks.push_back(told_block(update.key, update.version, update.delta));
    pending_cells_ += part.blocks.back().cells.size();
  }
  pending_[number].push_back(std::move(part));
  while (pending_.size() > kMaxPending || pending_cells_ > kMaxPendingCells) {
    drop(pending_.begin());
  }
}

void PatchReceiver::begin_anew(std::uint8_t epoch) {
  image_.clear();
  pending_.clear();
  pending_cells_ = 0;
  merged_ = 0;
  epoch_ = epoch;
}

void PatchReceiver::drop(std::map<std::uint32_t, std::vector<Part>>::iterator pending) {
  for (const Part& part : pending->second) {
    for (const ToldBlock& told : part.blocks) pending_cells_ -= told.cells.size();
  }
  pending_.erase(pending);
}

}  // namespace cairn::proto
