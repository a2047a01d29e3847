#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "proto/codec/patch.h"
#include "proto/codec/patch_cells.h"

namespace cairn::proto::patch {

/// A block's place in its submap, counted in blocks.
struct BlockAt {
  std::int32_t x = 0;
  std::int32_t y = 0;
};
[[nodiscard]] BlockAt block_at(const BlockKey& key);
[[nodiscard]] BlockKey key_at(EvidenceLayer layer, std::int8_t level, BlockAt at);

/// The frame around the blocks of one layer of a patch.
struct Frame {
  std::int8_t level = 0;
  std::int32_t x0 = 0;
  std::int32_t y0 = 0;
  std::int32_t width = 1;
  std::int32_t height = 1;
};

/// How the values of a patch are written.
struct Manner {
  Coarseness coarseness;
  bool plain = false;  ///< Without statistics: for a block that would not fit otherwise.
};

/// Codes a patch. `Coder` is RangeEncoder or RangeDecoder; see CellCoder.
template <class Coder>
class PatchCoder {
 public:
  PatchCoder(Coder& coder, MixerState& state, const Learning& learning, const PatchSetting& setting,
             const Manner& manner, const ContextImage& image)
      : cells_(coder, state, learning, manner.coarseness, running_, view_),
        setting_(setting),
        manner_(manner),
        image_(image) {}

  /// Codes the manner that the rest is in.
  static Manner code_manner(Coder& coder, const Manner& manner);

  /// Codes whether there is a viewpoint, and it.
  void code_view();
  /// Codes one layer: writes `blocks` (of this layer and one level, sorted by y, then x), or
  /// appends to them what it reads. False when a bound is broken.
  bool code_layer(EvidenceLayer layer, std::vector<BlockUpdate>& blocks);

 private:
  using Told = Window::BlockCells;

  void enclose(const std::vector<BlockUpdate>& blocks);
  bool code_frame(Frame& frame);
  bool code_there(BlockAt in_frame, BlockUpdate& update);
  void look_up_ages();
  std::int32_t number(std::int32_t value, std::size_t first_context);
  bool code_flag(BlockAt in_frame, bool there);
  bool code_head(BlockUpdate& update);
  [[nodiscard]] std::int32_t expected_datum(const BlockKey& key) const;
  void lay_window(BlockAt in_frame);
  [[nodiscard]] const ContextImage::Block* in_image(BlockAt in_frame) const;
  /// Requires: within the frame or next to it.
  [[nodiscard]] std::uint8_t age_of(BlockAt in_frame) const;
  [[nodiscard]] int told(BlockAt in_frame) const;
  std::int32_t& slot(BlockAt in_frame);

  /// A block's middle, or a quarter's.
  [[nodiscard]] std::optional<Place> place_of(BlockAt in_frame) const;

  Running running_;
  std::optional<Viewpoint> view_;
  CellCoder<Coder> cells_;
  PatchSetting setting_;
  Manner manner_;
  const ContextImage& image_;
  EvidenceLayer layer_ = EvidenceLayer::surface;
  Frame frame_;
  std::vector<std::int32_t> slots_;  ///< By place in the frame: index into told_, -1 none.
  std::vector<std::uint8_t> ages_;   ///< Classes; of the frame and one block around it.
  std::vector<Told> told_;
  std::vector<std::pair<TileKey, std::int32_t>> datums_;  ///< Of the layer's told tiles.
  std::int32_t last_datum_mm_ = 0;
  Window window_;
  std::size_t cells_told_ = 0;
  std::size_t blocks_told_ = 0;
};

extern template class PatchCoder<RangeEncoder>;
extern template class PatchCoder<RangeDecoder>;

}  // namespace cairn::proto::patch
