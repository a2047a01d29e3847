#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "proto/codec/frame.h"

/// Takes what the fuzzer invents apart.
namespace cairn::fuzz {

class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : left_(data, size) {}

  [[nodiscard]] bool empty() const { return left_.empty(); }
  /// 0 at the end.
  std::uint8_t byte() {
    const auto one = take(1);
    return one.empty() ? std::uint8_t{0} : one[0];
  }
  std::span<const std::uint8_t> take(std::size_t most) {
    const auto taken = left_.first(std::min(most, left_.size()));
    left_ = left_.subspan(taken.size());
    return taken;
  }
  std::span<const std::uint8_t> rest() { return take(left_.size()); }
  /// A stretch with its length (16 bits, little-endian) before it.
  std::span<const std::uint8_t> stretch() {
    const std::size_t low = byte();
    return take(low | (std::size_t{byte()} << 8U));
  }

 private:
  std::span<const std::uint8_t> left_;
};

/// The same with a right checksum at the end: chance would not find one.
inline std::vector<std::uint8_t> with_checksum(std::span<const std::uint8_t> frame) {
  std::vector<std::uint8_t> bytes(frame.begin(), frame.end());
  if (bytes.size() < proto::kChecksumBytes) return bytes;
  bytes.resize(bytes.size() - proto::kChecksumBytes);
  const std::uint32_t sum = proto::crc32c(bytes);
  for (unsigned i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(sum >> (8 * i)));
  return bytes;
}

/// Bug traps stay in whatever way the fuzzer is built.
inline void require(bool holds) {
  if (!holds) __builtin_trap();
}

}  // namespace cairn::fuzz
