#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace cairn::proto {

/// Where one record is on its way to the peer: it waits, is under way, or was acknowledged. A
/// record that is sent again before its first copies can have been answered is acknowledged by any
/// of them.
class Transit {
 public:
  [[nodiscard]] bool waits() const { return where_ == Where::waiting; }
  [[nodiscard]] bool acknowledged() const { return where_ == Where::acknowledged; }

  /// Frame `number`, greater than those before, carries it.
  void sent(std::uint32_t number) {
    where_ = Where::under_way;
    copies_[sent_++ % copies_.size()] = number;
  }
  void on_acked(std::uint32_t number) {
    if (acknowledged() || !carried(number)) return;
    where_ = Where::acknowledged;
  }
  void on_lost(std::uint32_t number) {
    const bool newest = sent_ > 0 && copies_[(sent_ - 1) % copies_.size()] == number;
    if (newest && where_ == Where::under_way) where_ = Where::waiting;
  }
  /// It must be said anew; what was said before counts no more.
  void again() { *this = {}; }

 private:
  enum class Where : std::uint8_t { waiting, under_way, acknowledged };

  [[nodiscard]] bool carried(std::uint32_t number) const {
    const std::size_t known = std::min(sent_, copies_.size());
    const auto end = copies_.begin() + static_cast<std::ptrdiff_t>(known);
    return std::find(copies_.begin(), end, number) != end;
  }

  Where where_ = Where::waiting;
  std::array<std::uint32_t, 8> copies_{};  ///< Frames that carried it, the last ones.
  std::size_t sent_ = 0;
};

}  // namespace cairn::proto
