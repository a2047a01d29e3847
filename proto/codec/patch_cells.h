#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/delta/block.h"
#include "core/delta/coarseness.h"
#include "proto/codec/patch_contexts.h"
#include "proto/codec/patch_predictor.h"
#include "proto/codec/patch_view.h"
#include "proto/codec/patch_window.h"
#include "proto/codec/range_coder.h"

namespace cairn::proto::patch {

/// A bit for each cell and, if it changed, its probability and its height above the datum.
inline constexpr std::size_t kMaxPlainBits = std::size_t{kBlockCells} * (1 + 8 + 17);

/// [mm] The grid on which the coarse heights lie that maps are made from (Coarseness).
inline constexpr std::int32_t kGridMm = 10;

/// What is remembered from cell to cell through a packet.
struct Running {
  std::int32_t last_height = 0;                 ///< [quanta] Of the cell told last.
  std::optional<std::int32_t> alt_height;       ///< [quanta] Of the last cell told in alt mode.
  std::array<std::int32_t, 2> error16{32, 32};  ///< [1/16 step] Mean miss of new heights, by step.
  std::int32_t grid_height = 0;                 ///< [mm] Of the last exact height on a grid.
  int grid_history = 7;  ///< Whether the last three exact heights were, the last one lowest.
};

/// The steps in which a new height is told: quanta; but exact heights that lie on the grid of the
/// coarse ones from which maps are made are told in the grid's.
struct Steps {
  std::int32_t size = 1;   ///< [quanta]
  std::int32_t phase = 0;  ///< [quanta] A height that is on the grid.
  bool fine = false;       ///< Exact, and on no grid.

  /// [quanta] The height of these steps nearest to one in 1/16 quanta.
  [[nodiscard]] std::int32_t nearest(std::int64_t height16) const;
  /// A difference of heights, in steps.
  [[nodiscard]] std::int64_t of(std::int64_t difference) const;
};

/// Codes the changed cells of one block, one after the other. The same code writes and reads:
/// `Coder` is RangeEncoder or RangeDecoder, and what it returns is what counts.
template <class Coder>
class CellCoder {
 public:
  CellCoder(Coder& coder, MixerState& state, const Learning& learning, const Coarseness& coarseness,
            Running& running, const std::optional<Viewpoint>& view)
      : coder_(coder),
        mixer_(state, learning),
        coarseness_(coarseness),
        running_(running),
        view_(view) {}

  /// The first cell of the block that comes next, in the submap's grid.
  void set_origin(CellIndex origin) { origin_ = origin; }

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

  /// Requires: a viewpoint.
  [[nodiscard]] Place place_of(int x, int y) const {
    return place_from(*view_, std::int64_t{origin_.x} + x, std::int64_t{origin_.y} + y);
  }
  bool quarter(const Window& window, int quarter, const bool* coded, bool changed);
  bool mask(const Here& here, bool changed, int in_block);
  bool code_cell(const Here& here, Cell& cell, std::int32_t datum_mm);
  bool clear(const Here& here, bool cleared);
  void note_grid(const Here& here, std::int32_t height_mm);
  Steps steps(const Here& here, const Prediction& prediction, std::int64_t height);
  std::int64_t new_height(const Here& here, std::int64_t height);
  std::int64_t new_height(const Here& here, const Prediction& prediction, const Steps& steps,
                          std::int64_t height);
  bool alt_mode(const Here& here, const Prediction& prediction, std::int32_t alt, bool is_alt);
  std::int64_t alt_height(const Here& here, std::int32_t alt, const Steps& steps,
                          std::int64_t height);
  std::int64_t changed_height(const Here& here, std::int64_t height, int& how);
  std::uint8_t probability(const Here& here, int how, std::uint8_t probability);
  std::uint8_t exact_probability(const Here& here, int how, std::uint8_t probability);
  int level(const Here& here, int how, int level, int levels);
  bool plain_level(const Here& here, int how, int level, bool is);
  int rest(const Here& here, int level, int rest);
  template <class Contexts>
  std::int64_t signed_number(std::int64_t value, std::size_t first_set, std::size_t second_set,
                             const Contexts& contexts);

  Coder& coder_;
  BitMixer mixer_;
  Coarseness coarseness_;
  Running& running_;
  const std::optional<Viewpoint>& view_;
  CellIndex origin_;
  /// Marks and residual of the cell being told.
  struct {
    std::uint8_t marks = 0;
    std::uint8_t residual = 0;
    std::uint8_t probability = 0;  ///< If it is told before the height.
  } told_;
};

extern template class CellCoder<RangeEncoder>;
extern template class CellCoder<RangeDecoder>;

}  // namespace cairn::proto::patch
