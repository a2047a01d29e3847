#include "proto/codec/range_coder.h"

namespace cairn::proto {
namespace {

constexpr std::uint32_t kLeastRange = 1U << 24U;
constexpr std::uint64_t kCarry = std::uint64_t{1} << 32U;

/// The part of the range that means a set bit: never empty, never all of it.
std::uint32_t part(std::uint32_t range, std::uint32_t one) {
  return static_cast<std::uint32_t>((std::uint64_t{range} * one) >> 16U);
}

}  // namespace

bool RangeEncoder::code(bool bit, std::uint32_t one) {
  const std::uint32_t split = part(range_, one);
  if (bit) {
    range_ = split;
  } else {
    low_ += split;
    range_ -= split;
  }
  while (range_ < kLeastRange) {
    shift_out();
    range_ <<= 8U;
  }
  return bit;
}

void RangeEncoder::shift_out() {
  // A byte of ones passes a later carry on, so it waits with the byte before it.
  const bool carry = low_ >= kCarry;
  const auto byte = static_cast<std::uint8_t>((low_ >> 24U) & 0xFFU);
  if (carry || byte != 0xFF || held_ == 0) {
    for (; held_ > 0; --held_, ++written_) {
      out_.push_back(static_cast<std::uint8_t>(top_ + (carry ? 1 : 0)));
      top_ = 0xFF;
    }
    top_ = byte;
  }
  ++held_;
  low_ = (low_ & 0x00FF'FFFFU) << 8U;
}

void RangeEncoder::finish() {
  // The number within the range that ends in the most zeros.
  for (unsigned bits = 24; bits > 0; bits -= 8) {
    const std::uint64_t mask = (std::uint64_t{1} << bits) - 1;
    const std::uint64_t rounded = (low_ + mask) & ~mask;
    if (rounded - low_ >= range_) continue;
    low_ = rounded;
    break;
  }
  for (int i = 0; i < 5; ++i) shift_out();
  for (int i = 0; i < 4 && written_ > 0 && out_.back() == 0; ++i, --written_) out_.pop_back();
}

RangeDecoder::RangeDecoder(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
  for (int i = 0; i < 4; ++i) code_ = (code_ << 8U) | next_byte();
}

std::uint32_t RangeDecoder::next_byte() {
  const std::size_t at = next_++;
  return at < bytes_.size() ? bytes_[at] : 0;
}

bool RangeDecoder::code(bool /*bit*/, std::uint32_t one) {
  const std::uint32_t split = part(range_, one);
  const bool bit = code_ < split;
  if (bit) {
    range_ = split;
  } else {
    code_ -= split;
    range_ -= split;
  }
  while (range_ < kLeastRange) {
    code_ = (code_ << 8U) | next_byte();
    range_ <<= 8U;
  }
  return bit;
}

}  // namespace cairn::proto
