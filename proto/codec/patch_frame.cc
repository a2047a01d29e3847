#include "proto/codec/patch_frame.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstdlib>

namespace cairn::proto::patch {
namespace {

constexpr int kBlocksPerRow = Tile::kSize / kBlockSize;

/// Contexts of the table for what is rare (0 is CellCoder's).
constexpr std::size_t kLayerThere = 2;  // and 3
constexpr std::size_t kOtherLevel = 4;
constexpr std::size_t kDatumExpected = 5;
constexpr std::size_t kBaseExpected = 6;
constexpr std::size_t kNextVersion = 7;
constexpr std::size_t kView = 8;
constexpr std::size_t kOriginLengths = 32;  // to 63
constexpr std::size_t kSizeLengths = 64;    // to 95
constexpr std::size_t kViewLengths = 96;    // to 127

constexpr std::size_t z(int value) { return static_cast<std::size_t>(value); }

std::uint32_t zig_zag(std::int32_t value) {
  return (static_cast<std::uint32_t>(value) << 1U) ^ static_cast<std::uint32_t>(value >> 31);
}

std::int32_t un_zig_zag(std::uint32_t value) {
  return static_cast<std::int32_t>((value >> 1U) ^ (~(value & 1U) + 1U));
}

template <class Coder>
std::uint32_t plain(Coder& coder, std::uint32_t value, int bits) {
  std::uint32_t coded = 0;
  for (int bit = bits - 1; bit >= 0; --bit) {
    coded = coded * 2 + (coder.code(((value >> bit) & 1U) != 0, 32768) ? 1 : 0);
  }
  return coded;
}

}  // namespace

BlockAt block_at(const BlockKey& key) {
  return {key.tile.tx * kBlocksPerRow + key.block % kBlocksPerRow,
          key.tile.ty * kBlocksPerRow + key.block / kBlocksPerRow};
}

BlockKey key_at(EvidenceLayer layer, std::int8_t level, BlockAt at) {
  const auto block = static_cast<std::uint8_t>((at.y & 3) * kBlocksPerRow + (at.x & 3));
  return {layer, {level, at.x >> 2, at.y >> 2}, block};
}

template <class Coder>
Manner PatchCoder<Coder>::code_manner(Coder& coder, const Manner& manner) {
  constexpr std::uint32_t kUsual = 60000;
  if (coder.code(manner.coarseness == Coarseness{} && !manner.plain, kUsual)) return {};
  Manner coded;
  const Coarseness& coarseness = manner.coarseness;
  coded.coarseness.quantum_mm =
      static_cast<int>(plain(coder, static_cast<unsigned>(coarseness.quantum_mm), 8));
  coded.coarseness.levels =
      static_cast<int>(plain(coder, static_cast<unsigned>(coarseness.levels), 5));
  coded.plain = plain(coder, manner.plain ? 1 : 0, 1) != 0;
  return coded;
}

template <class Coder>
void PatchCoder<Coder>::code_view() {
  constexpr int kHeadingBits = 6;
  view_ = setting_.view;
  if (manner_.plain || !cells_.rare(view_.has_value(), kView)) {
    view_.reset();
    return;
  }
  if (!view_) view_.emplace();
  static constexpr std::int32_t kFarthest = 1 << 28;
  const auto even = [this](std::int32_t at) {
    return 2 * std::clamp(number(at >> 1, kViewLengths), -kFarthest, kFarthest);
  };
  view_->at = {even(view_->at.x), even(view_->at.y)};
  view_->heading = static_cast<std::uint8_t>(cells_.raw(view_->heading, kHeadingBits));
}

template <class Coder>
std::optional<Place> PatchCoder<Coder>::place_of(BlockAt at) const {
  if (!view_) return std::nullopt;
  return place_from(*view_, std::int64_t{frame_.x0 + at.x} * kBlockSize + kBlockSize / 2,
                    std::int64_t{frame_.y0 + at.y} * kBlockSize + kBlockSize / 2);
}

template <class Coder>
bool PatchCoder<Coder>::code_layer(EvidenceLayer layer, std::vector<BlockUpdate>& blocks) {
  layer_ = layer;
  const bool writing = !blocks.empty();
  if (!cells_.rare(writing, kLayerThere + static_cast<std::size_t>(layer))) return true;
  enclose(blocks);
  if (!code_frame(frame_)) return false;
  slots_.assign(z(frame_.width * frame_.height), -1);
  told_.clear();
  datums_.clear();
  look_up_ages();
  std::size_t next = 0;
  for (std::int32_t i = 0; i < frame_.width * frame_.height; ++i) {
    const BlockAt at{i % frame_.width, i / frame_.width};
    const BlockKey key = key_at(layer, frame_.level, {frame_.x0 + at.x, frame_.y0 + at.y});
    const bool there = writing && next < blocks.size() && blocks[next].key == key;
    if (!code_flag(at, there)) continue;
    if (++blocks_told_ > kMaxPatchBlocks) return false;
    if (!writing) blocks.push_back({setting_.sequence, key, 0, 0, {}});
    if (!code_there(at, writing ? blocks[next++] : blocks.back())) return false;
  }
  return !blocks.empty();
}

/// Codes a block that is in the patch.
template <class Coder>
bool PatchCoder<Coder>::code_there(BlockAt at, BlockUpdate& update) {
  if (!code_head(update)) return false;
  lay_window(at);
  cells_.set_origin({(frame_.x0 + at.x) * kBlockSize, (frame_.y0 + at.y) * kBlockSize});
  const bool sound = manner_.plain ? cells_.code_plain_block(update.delta)
                                   : cells_.code_block(window_, update.delta);
  if (!sound) return false;
  const std::size_t changed = update.delta.changed.count();
  cells_told_ += changed;
  slot(at) = static_cast<std::int32_t>(told_.size());
  told_.push_back(window_.middle());
  return changed > 0 && cells_told_ <= kMaxPatchCells;
}

/// The frame around the blocks to be written.
template <class Coder>
void PatchCoder<Coder>::enclose(const std::vector<BlockUpdate>& blocks) {
  frame_ = {};
  if (blocks.empty()) return;
  const BlockAt first = block_at(blocks.front().key);
  frame_ = {blocks.front().key.tile.level, first.x, first.y, 1, 1};
  std::int32_t last_x = first.x;
  for (const BlockUpdate& update : blocks) {
    frame_.x0 = std::min(frame_.x0, block_at(update.key).x);
    last_x = std::max(last_x, block_at(update.key).x);
  }
  frame_.width = last_x - frame_.x0 + 1;
  frame_.height = block_at(blocks.back().key).y - frame_.y0 + 1;
}

template <class Coder>
bool PatchCoder<Coder>::code_frame(Frame& frame) {
  if (cells_.rare(frame.level != 0, kOtherLevel)) {
    const auto level = static_cast<std::uint8_t>(frame.level);
    frame.level = static_cast<std::int8_t>(cells_.raw(level, 8));
  }
  frame.x0 = number(frame.x0, kOriginLengths);
  frame.y0 = number(frame.y0, kOriginLengths);
  frame.width = number(frame.width, kSizeLengths);
  frame.height = number(frame.height, kSizeLengths);
  constexpr std::int32_t kFarthest = kMaxTileCoordinate * kBlocksPerRow;
  const auto sound = [](std::int32_t first, std::int32_t size) {
    return size >= 1 && size <= kMaxPatchSpan && first >= -kFarthest &&
           first + size <= kFarthest + kBlocksPerRow;
  };
  return sound(frame.x0, frame.width) && sound(frame.y0, frame.height);
}

/// How many bits its zig-zag form has, in a tree of five bits, then those below the first.
template <class Coder>
std::int32_t PatchCoder<Coder>::number(std::int32_t value, std::size_t first_context) {
  const std::uint32_t positive = zig_zag(value);
  const int bits = std::min(static_cast<int>(std::bit_width(positive)), 31);
  std::size_t node = 1;
  for (int bit = 4; bit >= 0; --bit) {
    node = node * 2 + (cells_.rare(((bits >> bit) & 1) != 0, first_context + node) ? 1 : 0);
  }
  const int coded_bits = static_cast<int>(node) - 32;
  if (coded_bits == 0) return 0;
  const std::uint32_t top = std::uint32_t{1} << static_cast<unsigned>(coded_bits - 1);
  return un_zig_zag(top | (coded_bits > 1 ? cells_.raw(positive & (top - 1), coded_bits - 1) : 0));
}

template <class Coder>
bool PatchCoder<Coder>::code_flag(BlockAt at, bool there) {
  const int near = told({at.x - 1, at.y}) + 2 * told({at.x, at.y - 1}) +
                   4 * told({at.x - 1, at.y - 1}) + 8 * told({at.x + 1, at.y - 1});
  const int age = age_of(at);
  const int east = age_of({at.x + 1, at.y});
  const int south = age_of({at.x, at.y + 1});
  int recent = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if ((dx != 0 || dy != 0) && age_of({at.x + dx, at.y + dy}) <= 1) ++recent;
    }
  }
  const int border = (at.x == 0 ? 1 : 0) + (at.y == 0 ? 2 : 0) +
                     (at.x == frame_.width - 1 ? 4 : 0) + (at.y == frame_.height - 1 ? 8 : 0);
  const auto& element = kElements.block;
  BitMixer& mixer = cells_.mixer();
  mixer.begin();
  mixer.add(element.tables[0].at(z(near * 8 + age)));
  mixer.add(element.tables[1].at(z(near * 9 + recent)));
  mixer.add(element.tables[2].at(z((age * 8 + std::min(east, south)) * 4 + (near & 3))));
  mixer.add(element.tables[3].at(z(near * 16 + border)));
  if (const auto place = place_of(at)) {
    mixer.add(element.tables[4].at((place->polar() * 2 + (age <= 1 ? 1 : 0)) * 4 + z(near & 3)));
    mixer.add(element.tables[5].at(place->square() * 2 + (recent > 0 ? 1 : 0)));
  }
  return mixer.code(cells_.coder(), there, element.first_set + z(near),
                    element.first_set + 16 + z(age));
}

template <class Coder>
bool PatchCoder<Coder>::code_head(BlockUpdate& update) {
  const auto* held = image_.find(setting_.sequence, update.key);
  const std::uint32_t held_version = held == nullptr ? 0 : held->version;
  const bool base_expected = cells_.rare(update.base == held_version, kBaseExpected);
  update.base = base_expected ? held_version : cells_.raw(update.base, 32);
  const bool next = cells_.rare(update.version == update.base + 1, kNextVersion);
  update.version = next ? update.base + 1 : cells_.raw(update.version, 32);
  const std::int32_t expected = expected_datum(update.key);
  std::int32_t& datum = update.delta.datum_mm;
  if (cells_.rare(datum == expected, kDatumExpected)) {
    datum = expected;
  } else {
    datum = static_cast<std::int32_t>(cells_.raw(static_cast<std::uint32_t>(datum), 32));
  }
  last_datum_mm_ = datum;
  datums_.emplace_back(update.key.tile, datum);
  if (blocks_told_ == 1) running_.last_height = datum / manner_.coarseness.quantum_mm;
  return update.version > update.base && HeightMap::storable(datum);
}

/// The datum of the tile if anything of it was told before, else the last one told.
template <class Coder>
std::int32_t PatchCoder<Coder>::expected_datum(const BlockKey& key) const {
  const auto told = std::ranges::find(datums_, key.tile, &std::pair<TileKey, std::int32_t>::first);
  if (told != datums_.end()) return told->second;
  for (std::uint8_t block = 0; block < kBlocksPerTile; ++block) {
    const auto* held = image_.find(setting_.sequence, {key.layer, key.tile, block});
    if (held != nullptr) return held->datum_mm;
  }
  return last_datum_mm_;
}

// ---- What is known around a block ---------------------------------------------------------------

template <class Coder>
std::int32_t& PatchCoder<Coder>::slot(BlockAt at) {
  return slots_[z(at.y * frame_.width + at.x)];
}

template <class Coder>
int PatchCoder<Coder>::told(BlockAt at) const {
  if (at.x < 0 || at.y < 0 || at.x >= frame_.width || at.y >= frame_.height) return 0;
  return slots_[z(at.y * frame_.width + at.x)] >= 0 ? 1 : 0;
}

template <class Coder>
const ContextImage::Block* PatchCoder<Coder>::in_image(BlockAt at) const {
  return image_.find(setting_.sequence,
                     key_at(layer_, frame_.level, {frame_.x0 + at.x, frame_.y0 + at.y}));
}

template <class Coder>
void PatchCoder<Coder>::look_up_ages() {
  ages_.clear();
  for (std::int32_t y = -1; y <= frame_.height; ++y) {
    for (std::int32_t x = -1; x <= frame_.width; ++x) {
      const auto* block = in_image({x, y});
      const int age = block == nullptr ? 0 : setting_.tick - block->tick;
      ages_.push_back(block == nullptr ? kUnknownAge : age_class(static_cast<std::uint8_t>(age)));
    }
  }
}

template <class Coder>
std::uint8_t PatchCoder<Coder>::age_of(BlockAt at) const {
  return ages_[z((at.y + 1) * (frame_.width + 2) + at.x + 1)];
}

template <class Coder>
void PatchCoder<Coder>::lay_window(BlockAt at) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const BlockAt there{at.x + dx, at.y + dy};
      if (told(there) != 0) {
        window_.put(dx, dy, &told_[z(slot(there))]);
        continue;
      }
      const auto* block = in_image(there);
      if (block == nullptr) {
        window_.put(dx, dy, nullptr);
        continue;
      }
      const Told cells = cells_of(*block, setting_.tick, manner_.coarseness);
      window_.put(dx, dy, &cells);
    }
  }
}

template class PatchCoder<RangeEncoder>;
template class PatchCoder<RangeDecoder>;

}  // namespace cairn::proto::patch
