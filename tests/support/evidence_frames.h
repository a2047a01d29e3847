#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <utility>
#include <variant>
#include <vector>

#include "proto/codec/frame.h"
#include "proto/sync/evidence_sender.h"
#include "proto/sync/server_link.h"

/// Evidence as it leaves the robot, through real frames, and what it says once all of it is there.
namespace cairn::proto::testing {

/// Fills frames numbered from `number` + 1 on, encodes and decodes each, until the sender has
/// nothing more to say. Acknowledges nothing.
inline std::vector<ServerLink::Evidence> frames_of(EvidenceSender& sender, std::uint32_t& number) {
  std::vector<ServerLink::Evidence> frames;
  PatchReceiver patches;
  while (sender.has_news()) {
    FrameWriter writer({.direction = Direction::up, .session = 1, .number = ++number});
    if (sender.fill(writer, number) == 0) break;
    const auto frame = decode_frame(std::move(writer).finish(), Direction::up);
    if (!frame) {
      ADD_FAILURE() << frame.error().message;
      break;
    }
    ServerLink::Evidence& evidence = frames.emplace_back();
    evidence.number = number;
    for (const Record& record : frame->records) {
      if (const auto* head = std::get_if<SubmapHead>(&record)) {
        evidence.heads.push_back(*head);
      } else if (const auto* patch = std::get_if<EvidencePatch>(&record)) {
        const auto read = patches.read(number, *patch);
        EXPECT_EQ(read.outcome, PatchReceiver::Outcome::read);
        evidence.blocks.insert(evidence.blocks.end(), read.blocks.begin(), read.blocks.end());
      }
    }
  }
  return frames;
}

/// Every submap that the sender still owns, put together again from its frames.
inline std::map<std::uint32_t, Submap> delivered(EvidenceSender& sender, int cell_size_mm) {
  std::map<std::uint32_t, Submap> submaps;
  std::uint32_t number = 0;
  for (const auto& frame : frames_of(sender, number)) {
    for (const SubmapHead& head : frame.heads) {
      const SubmapId id{0, head.sequence};
      Submap& submap =
          submaps.try_emplace(head.sequence, id, head.T_site_submap, cell_size_mm).first->second;
      submap.closed = head.closed;
    }
    for (const BlockUpdate& block : frame.blocks) {
      Submap& submap = submaps.at(block.sequence);
      EXPECT_TRUE(apply(layer_of(submap, block.key.layer), block.key, block.delta));
    }
  }
  return submaps;
}

}  // namespace cairn::proto::testing
