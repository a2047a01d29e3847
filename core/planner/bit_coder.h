#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cairn {

/// How likely a bit is to be 0, learned from the bits seen so far.
struct BitChance {
  std::uint16_t zero = 1 << 11;  ///< [1/4096]

  void learn(bool bit) {
    zero = static_cast<std::uint16_t>(bit ? zero - (zero >> 4) : zero + ((4096 - zero) >> 4));
  }
};

/// Adaptive binary range coder (Martin 1979), carry by byte stuffing.
class BitEncoder {
 public:
  void put(BitChance& chance, bool bit) {
    const std::uint32_t bound = (range_ >> 12) * chance.zero;
    if (bit) {
      low_ += bound;
      range_ -= bound;
    } else {
      range_ = bound;
    }
    chance.learn(bit);
    while (range_ < (1U << 24)) {
      range_ <<= 8;
      shift();
    }
  }
  /// Ends it. The decoder takes missing bytes for 0.
  [[nodiscard]] std::vector<std::uint8_t> finish() {
    for (int i = 0; i < 5; ++i) shift();
    bytes_.erase(bytes_.begin());
    while (!bytes_.empty() && bytes_.back() == 0) bytes_.pop_back();
    return std::move(bytes_);
  }

 private:
  void shift() {
    if (low_ < 0xFF000000U || low_ > 0xFFFFFFFFU) {
      const auto carry = static_cast<std::uint8_t>(low_ >> 32);
      bytes_.push_back(static_cast<std::uint8_t>(held_ + carry));
      for (; waiting_ > 0; --waiting_) bytes_.push_back(static_cast<std::uint8_t>(0xFF + carry));
      held_ = static_cast<std::uint8_t>(low_ >> 24);
    } else {
      ++waiting_;
    }
    low_ = (low_ & 0x00FFFFFFU) << 8;
  }

  std::uint64_t low_ = 0;
  std::uint32_t range_ = 0xFFFFFFFFU;
  std::uint8_t held_ = 0;
  std::size_t waiting_ = 0;
  std::vector<std::uint8_t> bytes_;
};

class BitDecoder {
 public:
  explicit BitDecoder(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
    for (int i = 0; i < 4; ++i) code_ = code_ << 8 | next();
  }

  bool get(BitChance& chance) {
    const std::uint32_t bound = (range_ >> 12) * chance.zero;
    const bool bit = code_ >= bound;
    if (bit) {
      code_ -= bound;
      range_ -= bound;
    } else {
      range_ = bound;
    }
    chance.learn(bit);
    while (range_ < (1U << 24)) {
      range_ <<= 8;
      code_ = code_ << 8 | next();
    }
    return bit;
  }
  /// All that was given has been read.
  [[nodiscard]] bool at_end() const { return at_ >= bytes_.size(); }

 private:
  std::uint32_t next() { return at_ < bytes_.size() ? bytes_[at_++] : 0U; }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  std::uint32_t code_ = 0;
  std::uint32_t range_ = 0xFFFFFFFFU;
};

}  // namespace cairn
