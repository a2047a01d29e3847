#include "server/world/live_submap.h"

#include <cassert>
#include <utility>

#include "core/map/fold.h"

namespace cairn::server {

LiveSubmap::LiveSubmap(SubmapId id, std::string robot, int cell_size_mm)
    : submap_(id, {}, cell_size_mm) {
  row_.id = id;
  row_.robot = std::move(robot);
}

LiveSubmap::LiveSubmap(const SubmapRow& row, const std::vector<BlockRow>& blocks, int cell_size_mm)
    : row_(row), submap_(row.id, row.T_site_submap, cell_size_mm) {
  submap_.closed = row.state != SubmapState::open;
  for (const BlockRow& block : blocks) {
    [[maybe_unused]] const bool fits =
        apply(layer_of(submap_, block.key.layer), block.key, block.state);
    assert(fits && "stored blocks were applied once before");
    versions_[block.key] = block.version;
    version_sum_ += block.version;
  }
  place();
}

void LiveSubmap::place() {
  site_tiles_.clear();
  if (!placed()) return;
  for (const TileKey& key : touched_tiles(submap_)) site_tiles_.insert(key);
}

bool LiveSubmap::take_head(const proto::SubmapHead& head) {
  if (head.version <= row_.head_version) return false;
  row_.head_version = head.version;
  row_.T_site_submap = head.T_site_submap;
  row_.blocks = head.blocks;
  row_.final_versions = head.final_versions;
  if (head.closed && head.blocks == 0) {  // Whatever is here is all of it.
    row_.blocks = static_cast<std::uint32_t>(versions_.size());
    row_.final_versions = version_sum_;
  }
  row_.edition = head.edition;
  row_.link = head.link;
  if (head.closed) row_.state = SubmapState::closed;
  submap_.T_site_submap = head.T_site_submap;
  submap_.closed = submap_.closed || head.closed;
  place();
  return true;
}

void LiveSubmap::move_to(const SubmapPose& T_site_submap, std::uint32_t edition) {
  row_.T_site_submap = T_site_submap;
  row_.edition = edition;
  submap_.T_site_submap = T_site_submap;
  place();
}

LiveSubmap::Outcome LiveSubmap::take_block(const proto::BlockUpdate& update) {
  const auto found = versions_.find(update.key);
  const std::uint32_t held = found == versions_.end() ? 0 : found->second;
  const proto::Verdict verdict = proto::judge(held, update.base, update.version);
  if (verdict != proto::Verdict::apply) return {verdict, held};
  if (found == versions_.end() && versions_.size() >= kMaxBlocks) {
    return {proto::Verdict::refuse, 0};
  }
  if (!apply(layer_of(submap_, update.key.layer), update.key, update.delta)) {
    return {proto::Verdict::refuse, 0};
  }
  if (placed() && found == versions_.end()) {
    for (const TileKey& tile : site_tiles_under(update.key.tile, submap_)) site_tiles_.insert(tile);
  }
  versions_[update.key] = update.version;
  version_sum_ += update.version - held;
  return {proto::Verdict::apply, update.version};
}

BlockRow LiveSubmap::block_row(const BlockKey& key) const {
  const auto found = versions_.find(key);
  assert(found != versions_.end());
  const Tile* tile = layer_of(submap_, key.layer).find(key.tile);
  return {row_.id, key, found->second, diff(nullptr, tile, key.block)};
}

}  // namespace cairn::server
