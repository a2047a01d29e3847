#pragma once

#include <array>
#include <cstdint>

namespace cairn::proto {

/// Which packet counters were seen, as in IPsec (RFC 6479): a sliding window below the highest.
class ReplayWindow {
 public:
  static constexpr std::uint64_t kBits = 2048;

  /// The full counter of a packet that carries only its low 24 bits: the one nearest to what is
  /// expected next. A wrong guess fails to authenticate, nothing else.
  [[nodiscard]] std::uint64_t expand(std::uint32_t low) const;
  /// Whether a packet of this counter may still be accepted.
  [[nodiscard]] bool is_new(std::uint64_t counter) const;
  /// The packet was authentic. True when it is the highest so far. Requires: is_new(counter).
  bool accept(std::uint64_t counter);

 private:
  static constexpr std::uint64_t kWordBits = 64;
  static constexpr std::uint64_t kWords = kBits / kWordBits;
  [[nodiscard]] static std::uint64_t bit(std::uint64_t counter) {
    return std::uint64_t{1} << (counter % kWordBits);
  }
  [[nodiscard]] static std::size_t word(std::uint64_t counter) {
    return (counter / kWordBits) % kWords;
  }

  std::uint64_t next_ = 0;  ///< One above the highest accepted.
  std::array<std::uint64_t, kWords> seen_{};
};

}  // namespace cairn::proto
