#include "proto/sync/evidence_sender.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <utility>

#include "proto/sync/flight.h"

namespace cairn::proto {
namespace {

// No changed cell ever takes less than so many bits of a patch, on the whole: more blocks than that
// lets through would be gathered for nothing.
constexpr std::size_t kLeastBitsPerCell = 3;

}  // namespace

// ---- The open submap ----------------------------------------------------------------------------

EvidenceSender::Outgoing::Outgoing(SubmapId id, SubmapPose pose, int cell_size_mm)
    : submap(id, pose, cell_size_mm) {
  head.newest = {.sequence = id.sequence, .version = 1, .T_site_submap = pose};
}

bool EvidenceSender::Outgoing::head_is_news() const {
  if (blocks.empty() && !submap.closed) return false;  // It may come to nothing.
  return head.newest.version > std::max(head.acked, head.under_way);
}

bool EvidenceSender::Outgoing::held() const {
  return submap.closed && head.acked == head.newest.version && waiting.empty() &&
         blocks_under_way == 0;
}

Submap& EvidenceSender::begin(std::uint64_t boot, SubmapPose T_site_submap, int cell_size_mm) {
  assert(open_submap() == nullptr);
  view_.reset();
  if (submaps_.size() >= kMaxSubmaps) drop_oldest_closed();
  const SubmapId id{boot, ++last_sequence_};
  Outgoing& outgoing =
      submaps_.try_emplace(id.sequence, id, T_site_submap, cell_size_mm).first->second;
  outgoing.head.newest.edition = edition_;
  return outgoing.submap;
}

void EvidenceSender::touch(EvidenceLayer layer, const std::vector<CellIndex>& cells) {
  assert(open_submap() != nullptr);
  Outgoing& outgoing = submaps_.at(last_sequence_);
  if (!cells.empty()) ++outgoing.revision;
  outgoing.versions.touch(layer, cells);
  std::set<BlockKey> touched;
  for (const CellIndex cell : cells) {
    const BlockPlace place = place_in_block(HeightMap::index_in_tile(cell));
    touched.insert({layer, HeightMap::tile_of(cell), place.block});
  }
  for (const BlockKey& key : touched) queue(outgoing, key, outgoing.blocks[key]);
}

void EvidenceSender::close() {
  Submap* open = open_submap();
  assert(open != nullptr);
  Outgoing& outgoing = submaps_.at(last_sequence_);
  open->closed = true;
  ++outgoing.revision;
  SubmapHead& head = outgoing.head.newest;
  ++head.version;
  head.closed = true;
  head.blocks = static_cast<std::uint32_t>(outgoing.blocks.size());
  for (const auto& [key, block] : outgoing.blocks) {
    head.final_versions += outgoing.versions.version(key);
  }
}

void EvidenceSender::discard() {
  assert(open_submap() != nullptr && submaps_.at(last_sequence_).blocks.empty());
  submaps_.erase(last_sequence_--);
}

Submap* EvidenceSender::open_submap() {
  Outgoing* last = find(last_sequence_);
  return last == nullptr || last->submap.closed ? nullptr : &last->submap;
}

void EvidenceSender::drop_oldest_closed() {
  leave(submaps_.begin(), false);  // Only the newest may be open.
  ++dropped_submaps_;
}

void EvidenceSender::leave(std::map<std::uint32_t, Outgoing>::iterator submap, bool held) {
  if (departures_.size() == kMaxSubmaps) departures_.erase(departures_.begin());
  departures_.push_back({submap->second.submap.id, held});
  submaps_.erase(submap);
}

// ---- Copies outside -----------------------------------------------------------------------------

std::vector<EvidenceSender::Unheld> EvidenceSender::unheld() const {
  std::vector<Unheld> all;
  for (const auto& [sequence, outgoing] : submaps_) {
    all.push_back({outgoing.submap.id, outgoing.revision, outgoing.submap.closed});
  }
  return all;
}

std::optional<KeptSubmap> EvidenceSender::copy_of(const SubmapId& id) const {
  const Outgoing* outgoing = find(id);
  if (outgoing == nullptr) return std::nullopt;
  const SubmapHead& head = outgoing->head.newest;
  KeptSubmap kept{id, head.T_site_submap, head.edition, outgoing->submap.link, {}};
  kept.blocks.reserve(outgoing->blocks.size());
  for (const auto& [key, block] : outgoing->blocks) {
    kept.blocks.push_back({id.sequence, key, 0, outgoing->versions.version(key),
                           outgoing->versions.changes_since(key, 0, outgoing->submap)});
  }
  return kept;
}

bool EvidenceSender::adopt(const KeptSubmap& kept, std::uint64_t boot, int cell_size_mm) {
  if (submaps_.size() >= kMaxSubmaps || find(kept.id) != nullptr) return false;
  const bool own = kept.id.boot == boot;
  if (own && kept.id.sequence > last_sequence_) return false;
  Outgoing adopted(kept.id, kept.T_site_submap, cell_size_mm);
  for (const BlockUpdate& block : kept.blocks) {
    if (adopted.blocks.contains(block.key)) return false;
    if (!apply(layer_of(adopted.submap, block.key.layer), block.key, block.delta)) return false;
    adopted.versions.restore(block.key, block.version, block.delta.changed);
    queue(adopted, block.key, adopted.blocks[block.key]);
  }
  adopted.adopted = true;
  adopted.submap.closed = true;
  adopted.submap.link = kept.link;
  SubmapHead& head = adopted.head.newest;
  head.edition = kept.edition;
  if (!own) {
    head.sequence = next_borrowed_++;
    head.earlier = kept.id;
  }
  settle_head(adopted);
  const std::uint32_t sequence = head.sequence;
  submaps_.try_emplace(sequence, std::move(adopted));
  return true;
}

void EvidenceSender::settle_head(Outgoing& outgoing) {
  if (!outgoing.adopted) return;
  SubmapHead& head = outgoing.head.newest;
  head.closed = outgoing.waiting.empty() && outgoing.blocks_under_way == 0;
  head.version = head.closed ? kAdoptedCloses : 1;
}

std::vector<EvidenceSender::Departure> EvidenceSender::take_departures() {
  return std::exchange(departures_, {});
}

// ---- Filling frames -----------------------------------------------------------------------------

void EvidenceSender::begin_round(std::uint32_t last_number) {
  round_turn_ = turn_;
  patches_.begin_round(last_number);
}

int EvidenceSender::fill(FrameWriter& frame, std::uint32_t number) {
  while (!cargoes_.empty() && cargoes_.begin()->first + Flight::kReach <= number) {
    cargoes_.erase(cargoes_.begin());
  }
  Cargo cargo;
  int added = 0;
  for (auto& [sequence, outgoing] : submaps_) {
    added += fill_from(outgoing, frame, number, cargo);
    const bool frame_is_full = outgoing.waits_since(round_turn_) || outgoing.head_is_news();
    if (frame_is_full) break;
  }
  if (added > 0) cargoes_[number] = std::move(cargo);
  return added;
}

int EvidenceSender::fill_from(Outgoing& outgoing, FrameWriter& frame, std::uint32_t number,
                              Cargo& cargo) {
  int added = 0;
  const bool blocks_need_head = outgoing.head.acked == 0 && outgoing.waits_since(round_turn_);
  if (outgoing.head_is_news() || blocks_need_head) {
    if (!add_head(outgoing, frame, number, cargo)) return 0;
    ++added;
  }
  return added + add_blocks(outgoing, frame, number, cargo);
}

bool EvidenceSender::add_head(Outgoing& outgoing, FrameWriter& frame, std::uint32_t number,
                              Cargo& cargo) {
  Head& head = outgoing.head;
  head.newest.link = outgoing.submap.link;
  if (!frame.add(head.newest)) return false;
  head.under_way = head.newest.version;
  head.carrier = number;
  cargo.items.push_back({head.newest.sequence, std::nullopt, head.newest.version});
  return true;
}

int EvidenceSender::add_blocks(Outgoing& outgoing, FrameWriter& frame, std::uint32_t number,
                               Cargo& cargo) {
  const auto updates = next_updates(outgoing, frame.room_bytes());
  if (updates.empty()) return 0;
  const auto view = outgoing.submap.closed ? std::nullopt : view_;
  const auto taken = patches_.fill(frame, number, updates, view);
  for (const std::size_t i : taken) set_out(outgoing, updates[i], number, cargo);
  return taken.empty() ? 0 : 1;
}

/// The round's blocks, the nearest to the robot first; without a place those that waited longest.
std::vector<BlockKey> EvidenceSender::in_turn(const Outgoing& outgoing) const {
  std::vector<BlockKey> keys;
  for (const auto& [turn, key] : outgoing.waiting) {
    if (turn <= round_turn_) keys.push_back(key);
  }
  if (!view_ || outgoing.submap.closed) return keys;
  const auto distance = [this](const BlockKey& key) {
    const int first = index_in_tile(key.block, 0);
    const std::int64_t dx = key.tile.tx * Tile::kSize + first % Tile::kSize + kBlockSize / 2;
    const std::int64_t dy = key.tile.ty * Tile::kSize + first / Tile::kSize + kBlockSize / 2;
    return std::max(std::abs(dx - view_->at.x), std::abs(dy - view_->at.y));
  };
  std::ranges::stable_sort(keys, {}, distance);
  return keys;
}

/// The blocks whose turn it is, as many as could fit into so much room.
std::vector<BlockUpdate> EvidenceSender::next_updates(const Outgoing& outgoing,
                                                      std::size_t room_bytes) const {
  std::vector<BlockUpdate> updates;
  std::size_t cells = 0;
  for (const BlockKey& key : in_turn(outgoing)) {
    if (cells * kLeastBitsPerCell > room_bytes * 8 || updates.size() == kMaxPatchBlocks) break;
    const std::uint32_t acked = outgoing.blocks.at(key).acked;
    BlockUpdate update{
        outgoing.head.newest.sequence, key, acked, outgoing.versions.version(key), {}};
    update.delta = outgoing.versions.changes_since(key, acked, outgoing.submap);
    cells += update.delta.changed.count();
    updates.push_back(update);
  }
  return updates;
}

void EvidenceSender::set_out(Outgoing& outgoing, const BlockUpdate& update, std::uint32_t number,
                             Cargo& cargo) {
  Block& block = outgoing.blocks.at(update.key);
  outgoing.versions.told(update.key);
  outgoing.waiting.erase({block.last_sent, update.key});
  block.under_way = update.version;
  block.carrier = number;
  block.last_sent = ++turn_;
  ++outgoing.blocks_under_way;
  cargo.items.push_back({update.sequence, update.key, update.version});
}

// ---- What became of them ------------------------------------------------------------------------

void EvidenceSender::on_acked(std::uint32_t number) {
  patches_.on_acked(number);
  const auto cargo = cargoes_.find(number);
  if (cargo == cargoes_.end()) return;
  for (const auto& item : cargo->second.items) item_acked(item);
  cargoes_.erase(cargo);
}

void EvidenceSender::item_acked(const Cargo::Item& item) {
  Outgoing* outgoing = find(item.sequence);
  if (outgoing == nullptr) return;
  if (!item.block) {
    outgoing->head.acked = std::max(outgoing->head.acked, item.version);
  } else {
    const auto found = outgoing->blocks.find(*item.block);
    if (found == outgoing->blocks.end()) return;  // Taken up again with less since it was sent.
    Block& block = found->second;
    block.acked = std::max(block.acked, item.version);
    if (block.under_way != 0 && block.under_way <= block.acked)
      no_longer_under_way(*outgoing, block);
    queue(*outgoing, *item.block, block);
  }
  settle_head(*outgoing);
  if (outgoing->held()) leave(submaps_.find(item.sequence), true);
}

void EvidenceSender::on_lost(std::uint32_t number) {
  const auto cargo = cargoes_.find(number);
  if (cargo == cargoes_.end()) return;
  for (const auto& item : cargo->second.items) item_lost(item, number);
}

void EvidenceSender::item_lost(const Cargo::Item& item, std::uint32_t number) {
  Outgoing* outgoing = find(item.sequence);
  if (outgoing == nullptr) return;
  if (!item.block) {
    if (outgoing->head.carrier == number) outgoing->head.under_way = 0;
    return;
  }
  const auto found = outgoing->blocks.find(*item.block);
  if (found == outgoing->blocks.end()) return;
  Block& block = found->second;
  if (block.under_way == 0 || block.carrier != number) return;
  no_longer_under_way(*outgoing, block);
  block.last_sent = std::min(block.last_sent, round_turn_);  // It was not told in this round.
  queue(*outgoing, *item.block, block);
}

void EvidenceSender::on_refused(const Refusal& refusal) {
  Outgoing* outgoing = find(refusal.sequence);
  if (outgoing == nullptr) return;
  const auto found = outgoing->blocks.find(refusal.key);
  // What the peer claims to hold beyond what it acknowledged is not yet durable there.
  if (found == outgoing->blocks.end() || refusal.held >= found->second.acked) return;
  Block& block = found->second;
  if (block.under_way != 0) no_longer_under_way(*outgoing, block);
  block.acked = refusal.held;
  queue(*outgoing, refusal.key, block);
  settle_head(*outgoing);
}

void EvidenceSender::on_session(bool forget_acked) {
  patches_.on_session();
  cargoes_.clear();
  for (auto& [sequence, outgoing] : submaps_) {
    outgoing.head.under_way = 0;
    const bool name_is_forgotten = outgoing.head.newest.earlier.has_value();
    if (forget_acked || name_is_forgotten) outgoing.head.acked = 0;
    for (auto& [key, block] : outgoing.blocks) {
      if (block.under_way != 0) no_longer_under_way(outgoing, block);
      if (forget_acked) block.acked = 0;
      queue(outgoing, key, block);
    }
    settle_head(outgoing);
  }
}

void EvidenceSender::queue(Outgoing& outgoing, const BlockKey& key, Block& block) {
  const bool news = outgoing.versions.version(key) > block.acked && block.under_way == 0;
  if (news) {
    outgoing.waiting.insert({block.last_sent, key});
  } else {
    outgoing.waiting.erase({block.last_sent, key});
  }
}

void EvidenceSender::no_longer_under_way(Outgoing& outgoing, Block& block) {
  block.under_way = 0;
  --outgoing.blocks_under_way;
}

// ---- How far the peer is ------------------------------------------------------------------------

bool EvidenceSender::has_news() const {
  return std::ranges::any_of(submaps_, [](const auto& entry) {
    return entry.second.head_is_news() || !entry.second.waiting.empty();
  });
}

bool EvidenceSender::round_has_news() const {
  return std::ranges::any_of(submaps_, [this](const auto& entry) {
    return entry.second.head_is_news() || entry.second.waits_since(round_turn_);
  });
}

bool EvidenceSender::synchronised() const {
  return std::ranges::all_of(submaps_, [](const auto& entry) {
    const Outgoing& outgoing = entry.second;
    const bool nothing_to_tell = outgoing.blocks.empty() && !outgoing.submap.closed;
    return nothing_to_tell || (outgoing.head.acked == outgoing.head.newest.version &&
                               outgoing.waiting.empty() && outgoing.blocks_under_way == 0);
  });
}

std::uint32_t EvidenceSender::held_up_to() const {
  const bool none = submaps_.empty() || submaps_.begin()->first >= kFirstBorrowedSequence;
  return none ? last_sequence_ : submaps_.begin()->first - 1;
}

std::size_t EvidenceSender::backlog_blocks() const {
  std::size_t blocks = 0;
  for (const auto& [sequence, outgoing] : submaps_) {
    blocks += outgoing.waiting.size() + outgoing.blocks_under_way;
  }
  return blocks;
}

std::size_t EvidenceSender::submaps() const { return submaps_.size(); }

std::uint64_t EvidenceSender::dropped_submaps() const { return dropped_submaps_; }

EvidenceSender::Outgoing* EvidenceSender::find(std::uint32_t sequence) {
  const auto found = submaps_.find(sequence);
  return found == submaps_.end() ? nullptr : &found->second;
}

const EvidenceSender::Outgoing* EvidenceSender::find(const SubmapId& id) const {
  const auto found = std::ranges::find_if(
      submaps_, [&](const auto& entry) { return entry.second.submap.id == id; });
  return found == submaps_.end() ? nullptr : &found->second;
}

}  // namespace cairn::proto
