#include "proto/codec/text.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "proto/codec/records.h"

namespace cairn::proto {
namespace {

struct CodePoint {
  std::uint32_t value = 0;
  std::size_t bytes = 0;  // 0: not UTF-8.
};

std::uint32_t byte_at(std::string_view text, std::size_t i) {
  return static_cast<std::uint8_t>(text[i]);
}

std::size_t length_by_first_byte(std::uint32_t first) {
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first < 0xE0) return 2;
  if (first >= 0xE0 && first < 0xF0) return 3;
  if (first >= 0xF0 && first < 0xF5) return 4;
  return 0;
}

bool assigned_to_characters(std::uint32_t value, std::size_t bytes) {
  constexpr std::array<std::uint32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = value >= 0xD800 && value < 0xE000;
  return value >= kLeast.at(bytes) && value <= 0x10FFFF && !surrogate;
}

/// The code point that `text` begins with. Requires: not empty.
CodePoint first_code_point(std::string_view text) {
  const std::uint32_t first = byte_at(text, 0);
  const std::size_t bytes = length_by_first_byte(first);
  if (bytes == 0 || bytes > text.size()) return {};
  std::uint32_t value = bytes == 1 ? first : first & (0x7FU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    const std::uint32_t next = byte_at(text, i);
    if ((next & 0xC0U) != 0x80U) return {};
    value = (value << 6U) | (next & 0x3FU);
  }
  return assigned_to_characters(value, bytes) ? CodePoint{value, bytes} : CodePoint{};
}

bool is_control(std::uint32_t value) { return value < 0x20 || (value >= 0x7F && value < 0xA0); }

}  // namespace

bool valid_name(std::string_view name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !name.empty() && name.size() <= kMaxNameBytes && std::ranges::all_of(name, allowed);
}

std::string wire_text(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const CodePoint point = first_code_point(text);
    const std::size_t used = std::max<std::size_t>(point.bytes, 1);
    std::string_view piece = text.substr(0, used);
    if (point.bytes == 0) piece = "?";
    if (point.bytes != 0 && is_control(point.value)) piece = " ";
    if (out.size() + piece.size() > kMaxTextBytes) break;
    out += piece;
    text.remove_prefix(used);
  }
  return out;
}

bool valid_text(std::string_view text) { return wire_text(text) == text; }

}  // namespace cairn::proto
