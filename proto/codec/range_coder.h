#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cairn::proto {

/// Binary range coding (Martin 1979) with carries, in whole numbers: each bit costs what the
/// probability that both ends assume for it says. `one` is the probability of a set bit [1/65536],
/// 1 … 65535.
class RangeEncoder {
 public:
  /// Appends to `out`, which must outlive the encoder.
  explicit RangeEncoder(std::vector<std::uint8_t>& out) : out_(out) {}

  bool code(bool bit, std::uint32_t one);
  /// Writes what is still held back; up to four trailing zeros are left out, as the reader supposes
  /// them.
  void finish();
  /// [bytes] Written if it were finished now; at most four too many.
  [[nodiscard]] std::size_t bytes_at_most() const { return written_ + held_ + 4; }

 private:
  void shift_out();

  std::vector<std::uint8_t>& out_;
  std::uint64_t low_ = 0;  ///< 32 bits and a carry.
  std::uint32_t range_ = 0xFFFF'FFFFU;
  std::uint8_t top_ = 0;  ///< Held back, as a carry may still reach it …
  std::size_t held_ = 0;  ///< … with this many bytes: itself and 0xFF after it.
  std::size_t written_ = 0;
};

/// Reads what RangeEncoder wrote; beyond the end it reads zeros.
class RangeDecoder {
 public:
  explicit RangeDecoder(std::span<const std::uint8_t> bytes);

  /// The argument `bit` is there for encoders and decoders to look alike; it is ignored.
  bool code(bool bit, std::uint32_t one);
  /// Bits were taken that cannot have been written: the bytes end too early.
  [[nodiscard]] bool overrun() const { return next_ > bytes_.size() + kAhead; }
  /// Every byte was looked at.
  [[nodiscard]] bool all_read() const { return next_ >= bytes_.size(); }

 private:
  static constexpr std::size_t kAhead = 4;
  std::uint32_t next_byte();

  std::span<const std::uint8_t> bytes_;
  std::size_t next_ = 0;
  std::uint32_t range_ = 0xFFFF'FFFFU;
  std::uint32_t code_ = 0;
};

}  // namespace cairn::proto
