#pragma once

#include <cstdint>
#include <optional>

#include "core/delta/block.h"
#include "core/delta/coarseness.h"
#include "proto/codec/patch_contexts.h"
#include "proto/codec/patch_predictor.h"
#include "proto/codec/patch_window.h"
#include "proto/codec/range_coder.h"

namespace cairn::proto::patch {

/// A bit for each cell and, if it changed, its probability and its height above the datum.
inline constexpr std::size_t kMaxPlainBits = std::size_t{kBlockCells} * (1 + 8 + 17);

/// What is remembered from cell to cell through a packet.
struct Running {
  std::int32_t last_height = 0;            ///< [quanta] Of the cell told last.
  std::optional<std::int32_t> alt_height;  ///< [quanta] Of the last cell told in alt mode.
  std::int32_t error16 = 32;               ///< [1/16 quanta] Mean miss of new heights.
};

/// Codes the changed cells of one block, one after the other. The same code writes and reads:
/// `Coder` is RangeEncoder or RangeDecoder, and what it returns is what counts.
template <class Coder>
class CellCoder {
 public:
  CellCoder(Coder& coder, MixerState& state, const Learning& learning, const Coarseness& coarseness,
            Running& running)
      : coder_(coder), mixer_(state, learning), coarseness_(coarseness), running_(running) {}

  /// Codes which cells of the window's middle changed and their values; `delta` gives them or takes
  /// them, the window takes them. False when what was read breaks a bound: a height that does not
  /// fit the datum.
  bool code_block(Window& window, BlockDelta& delta);
  /// The same without any statistics, so that no block takes more than kMaxPlainBits.
  bool code_plain_block(BlockDelta& delta);

  /// One bit under one context of the table for what is rare.
  bool rare(bool bit, std::size_t context);
  /// A number without statistics. Requires: 1 ≤ bits ≤ 32, value < 2^bits.
  std::uint32_t raw(std::uint32_t value, int bits);
  /// A block flag.
  BitMixer& mixer() { return mixer_; }
  Coder& coder() { return coder_; }

 private:
  struct Here {
    Window* window;
    int x;
    int y;
  };

  bool quarter(const Window& window, int quarter, const bool* coded, bool changed);
  bool mask(const Here& here, bool changed, int in_block);
  bool code_cell(const Here& here, Cell& cell, std::int32_t datum_mm);
  bool clear(const Here& here, bool cleared);
  std::int64_t new_height(const Here& here, std::int64_t height);
  bool alt_mode(const Here& here, const Prediction& prediction, std::int32_t alt, bool is_alt);
  std::int64_t alt_height(const Here& here, std::int32_t alt, std::int64_t height);
  std::int64_t changed_height(const Here& here, std::int64_t height, int& how);
  std::uint8_t probability(const Here& here, int how, std::uint8_t probability);
  std::uint8_t exact_probability(const Here& here, int how, std::uint8_t probability);
  int level(const Here& here, int how, int level);
  template <class Contexts>
  std::int64_t signed_number(std::int64_t value, std::size_t first_set, std::size_t second_set,
                             const Contexts& contexts);

  Coder& coder_;
  BitMixer mixer_;
  Coarseness coarseness_;
  Running& running_;
  /// Marks and residual of the cell being told.
  struct {
    std::uint8_t marks = 0;
    std::uint8_t residual = 0;
  } told_;
};

extern template class CellCoder<RangeEncoder>;
extern template class CellCoder<RangeDecoder>;

}  // namespace cairn::proto::patch
