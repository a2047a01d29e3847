#include "proto/codec/bytes.h"

namespace cairn::proto {
namespace {

constexpr std::uint32_t kMore = 0x80;  // Another byte follows.
constexpr std::uint32_t kSeven = 0x7F;
constexpr int kLastShift = 28;  // Of a 32-bit number's fifth byte, which has four bits of it.

std::uint32_t zig_zag(std::int32_t value) {
  const std::uint32_t sign = value < 0 ? ~0U : 0U;
  return (static_cast<std::uint32_t>(value) << 1U) ^ sign;
}

std::int32_t un_zig_zag(std::uint32_t value) {
  return static_cast<std::int32_t>((value >> 1U) ^ (~(value & 1U) + 1U));
}

}  // namespace

void ByteWriter::put_bytes(std::span<const std::uint8_t> bytes) {
  out_.insert(out_.end(), bytes.begin(), bytes.end());
}

void ByteWriter::put_varint(std::int32_t value) {
  std::uint32_t rest = zig_zag(value);
  for (; rest > kSeven; rest >>= 7U) {
    out_.push_back(static_cast<std::uint8_t>((rest & kSeven) | kMore));
  }
  out_.push_back(static_cast<std::uint8_t>(rest));
}

std::span<const std::uint8_t> ByteReader::take(std::size_t count) {
  if (count > rest_.size()) fail();
  if (failed_) return {};
  const auto taken = rest_.first(count);
  rest_ = rest_.subspan(count);
  return taken;
}

std::int32_t ByteReader::get_varint() {
  std::uint32_t value = 0;
  for (int shift = 0; shift <= kLastShift; shift += 7) {
    const std::uint32_t byte = get<std::uint8_t>();
    const bool too_big = shift == kLastShift && byte > 0xF;
    const bool longer_than_needed = shift > 0 && byte == 0;
    if (failed_ || too_big || longer_than_needed) break;
    value |= (byte & kSeven) << static_cast<unsigned>(shift);
    if ((byte & kMore) == 0) return un_zig_zag(value);
  }
  fail();
  return 0;
}

void ByteReader::fail() {
  failed_ = true;
  rest_ = {};
}

}  // namespace cairn::proto
