#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace cairn::proto {

/// Appends numbers to a buffer, little-endian, byte by byte.
class ByteWriter {
 public:
  /// Appends to `out`, which must outlive the writer.
  explicit ByteWriter(std::vector<std::uint8_t>& out) : out_(out) {}

  template <std::integral T>
  void put(T value) {
    auto rest = static_cast<std::make_unsigned_t<T>>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      out_.push_back(static_cast<std::uint8_t>(rest & 0xFFU));
      rest = static_cast<std::make_unsigned_t<T>>(rest >> 4U >> 4U);  // Two steps: T may be 8 bits.
    }
  }
  void put_bytes(std::span<const std::uint8_t> bytes);
  /// Small magnitudes in few bytes: zig-zag, then 7 bits per byte, low ones first.
  void put_varint(std::int32_t value);

 private:
  std::vector<std::uint8_t>& out_;
};

/// Reads what ByteWriter wrote. Instead of reading past the end it becomes `failed` and gives
/// zeros from then on, so that callers may check once at the end.
class ByteReader {
 public:
  /// Reads from `bytes`, which must outlive the reader.
  explicit ByteReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  template <std::integral T>
  [[nodiscard]] T get() {
    const auto bytes = take(sizeof(T));
    std::make_unsigned_t<T> value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      value = static_cast<std::make_unsigned_t<T>>(
          value | static_cast<std::make_unsigned_t<T>>(std::uint64_t{bytes[i]} << (8 * i)));
    }
    return static_cast<T>(value);
  }
  /// `count` bytes, or none when fewer are left.
  [[nodiscard]] std::span<const std::uint8_t> take(std::size_t count);
  /// Fails on more than five bytes, on more than 32 bits and on a form longer than needed.
  [[nodiscard]] std::int32_t get_varint();

  [[nodiscard]] std::size_t left() const { return rest_.size(); }
  [[nodiscard]] bool failed() const { return failed_; }
  void fail();

 private:
  std::span<const std::uint8_t> rest_;
  bool failed_ = false;
};

}  // namespace cairn::proto
