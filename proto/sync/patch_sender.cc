#include "proto/sync/patch_sender.h"

#include <algorithm>
#include <utility>

#include "proto/sync/flight.h"

namespace cairn::proto {
namespace {

/// [numbers] A frame can be named by those that come not later than this after it.
constexpr std::uint32_t kMostBack = 255;
/// [numbers] So many frames a merged one must still be nameable by: the server may miss some.
constexpr std::uint32_t kNamedFor = 160;
/// [bytes] Of an EvidencePatch before its frames and its patch.
constexpr std::size_t kPatchHeadBytes = 8;

}  // namespace

void PatchSender::begin_round(std::uint32_t last_number) {
  ++tick_;
  for (Acked& acked : acked_) {
    const bool nameable = acked.number + kMostBack - kNamedFor > last_number;
    if (!nameable || unproven_.size() == kMaxGroundFrames) continue;  // The image lacks a little.
    for (const Part& part : acked.parts) {
      for (const ToldBlock& told : part.blocks) image_.merge(part.sequence, told, part.tick);
    }
    unproven_.push_back(acked.number);
    ++merged_;
  }
  acked_.clear();
}

std::vector<std::size_t> PatchSender::fill(FrameWriter& frame, std::uint32_t number,
                                           std::span<const BlockUpdate> blocks,
                                           const std::optional<Viewpoint>& view) {
  while (!sent_.empty() && sent_.begin()->first + Flight::kReach <= number) {
    sent_.erase(sent_.begin());
  }
  if (!unproven_.empty() && unproven_.front() + kMostBack < number) begin_anew();
  EvidencePatch patch{blocks.front().sequence, tick_, ground_for(number), {}};
  const std::size_t head = kPatchHeadBytes + patch.ground.back.size();
  if (frame.room_bytes() <= head) return {};
  const std::size_t room = std::min(frame.room_bytes() - head, kMaxPatchBytes);
  PatchBytes written =
      write_patch(blocks, {patch.sequence, tick_, view}, coarseness_, image_, room);
  patch.bytes = std::move(written.bytes);
  if (written.taken.empty() || !frame.add(patch)) return {};
  Part part{patch.sequence, tick_, {}};
  for (const std::size_t i : written.taken) {
    part.blocks.push_back(told_block(blocks[i].key, blocks[i].version, blocks[i].delta));
  }
  Sent& sent = sent_[number];
  sent.epoch = epoch_;
  sent.merged = merged_;
  sent.parts.push_back(std::move(part));
  return written.taken;
}

CommonGround PatchSender::ground_for(std::uint32_t number) const {
  const auto before = merged_ - static_cast<std::uint32_t>(unproven_.size());
  CommonGround ground{epoch_, static_cast<std::uint8_t>(before), {}};
  for (const std::uint32_t merged : unproven_) {
    ground.back.push_back(static_cast<std::uint8_t>(number - merged));
  }
  return ground;
}

void PatchSender::on_acked(std::uint32_t number) {
  const auto found = sent_.find(number);
  if (found == sent_.end()) return;
  Sent sent = std::move(found->second);
  sent_.erase(found);
  if (sent.epoch != epoch_) return;
  // What this frame was told on, the server has.
  while (!unproven_.empty() && merged_ - unproven_.size() < sent.merged) unproven_.pop_front();
  acked_.push_back({number, std::move(sent.parts)});
  if (acked_.size() > Flight::kReach) acked_.erase(acked_.begin());
}

void PatchSender::on_session() {
  begin_anew();
  epoch_ = 0;
}

void PatchSender::on_ground_lost(std::uint8_t epoch) {
  if (epoch == epoch_) begin_anew();
}

void PatchSender::begin_anew() {
  ++epoch_;
  image_.clear();
  merged_ = 0;
  unproven_.clear();
  acked_.clear();
  sent_.clear();
}

}  // namespace cairn::proto
