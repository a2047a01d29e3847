#pragma once

#include <cassert>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "proto/codec/bytes.h"
#include "proto/codec/text.h"

/// Two visitors with the same face, so that each record's layout and bounds are told once and hold
/// for writing and reading alike.
namespace cairn::proto {

/// Signed numbers of either sign become small ones: 0, −1, 1, −2, …
template <std::integral T>
constexpr std::uint64_t zigzag(T value) {
  if constexpr (std::is_unsigned_v<T>) return value;
  const auto wide = static_cast<std::int64_t>(value);
  return (static_cast<std::uint64_t>(wide) << 1U) ^ static_cast<std::uint64_t>(wide >> 63U);
}
template <std::integral T>
constexpr T unzigzag(std::uint64_t coded) {
  if constexpr (std::is_unsigned_v<T>) return static_cast<T>(coded);
  return static_cast<T>(static_cast<std::int64_t>(coded >> 1U) ^
                        -static_cast<std::int64_t>(coded & 1U));
}

/// Writes fields. What breaks a bound here is our own fault and asserted.
class FieldWriter {
 public:
  template <class T>
  using Ref = const T&;

  explicit FieldWriter(ByteWriter out) : out_(out) {}

  template <std::integral T>
  void number(const char* /*name*/, T value, T least = std::numeric_limits<T>::min(),
              T most = std::numeric_limits<T>::max()) {
    assert(value >= least && value <= most);
    (void)least, (void)most;
    out_.put(value);
  }
  /// Mostly small: seven bits a byte, the low ones first, the top bit set where more follow; signed
  /// ones zigzag (0, −1, 1, −2, …).
  template <std::integral T>
  void compact(const char* /*name*/, T value, T least = std::numeric_limits<T>::min(),
               T most = std::numeric_limits<T>::max()) {
    assert(value >= least && value <= most);
    (void)least, (void)most;
    std::uint64_t left = zigzag(value);
    for (; left >= 0x80; left >>= 7U) out_.put(static_cast<std::uint8_t>(left | 0x80U));
    out_.put(static_cast<std::uint8_t>(left));
  }
  template <class E>
  requires std::is_enum_v<E>
  void one_of(const char* name, E value, E first, E last) {
    using U = std::underlying_type_t<E>;
    number<U>(name, static_cast<U>(value), static_cast<U>(first), static_cast<U>(last));
  }
  void flag(const char* name, bool value) { number<std::uint8_t>(name, value ? 1 : 0, 0, 1); }
  void name(const char* /*name*/, const std::string& value) {
    assert(valid_name(value));
    put_string(value);
  }
  void text(const char* /*name*/, const std::string& value) { put_string(wire_text(value)); }
  /// Counted by a byte.
  void bytes(const char* name, const std::vector<std::uint8_t>& value, std::uint8_t most) {
    assert(value.size() <= most);
    number<std::uint8_t>(name, static_cast<std::uint8_t>(value.size()), 0, most);
    out_.put_bytes(value);
  }
  /// All that is left of the record.
  void rest(const char* /*name*/, const std::vector<std::uint8_t>& value, std::size_t most) {
    assert(!value.empty() && value.size() <= most);
    (void)most;
    out_.put_bytes(value);
  }
  template <class T, class Each>
  void list(const char* name, const std::vector<T>& values, std::uint8_t most, Each each,
            std::uint8_t least = 1) {
    assert(values.size() >= least && values.size() <= most);
    number<std::uint8_t>(name, static_cast<std::uint8_t>(values.size()), least, most);
    for (const T& value : values) each(*this, value);
  }
  template <class T, class Write>
  void optional(const char* name, const std::optional<T>& value, Write write) {
    flag(name, value.has_value());
    if (value) write(*this, *value);
  }
  void require(const char* /*name*/, bool holds) {
    assert(holds);
    (void)holds;
  }

 private:
  void put_string(std::string_view value) {
    out_.put(static_cast<std::uint8_t>(value.size()));
    for (const char c : value) out_.put(static_cast<std::uint8_t>(c));
  }

  ByteWriter out_;
};

/// Reads fields and remembers the first that broke a rule.
class FieldReader {
 public:
  template <class T>
  using Ref = T&;

  explicit FieldReader(ByteReader in) : in_(in) {}

  template <std::integral T>
  void number(const char* name, T& value, T least = std::numeric_limits<T>::min(),
              T most = std::numeric_limits<T>::max()) {
    value = in_.get<T>();
    require(name, value >= least && value <= most);
  }
  template <std::integral T>
  void compact(const char* name, T& value, T least = std::numeric_limits<T>::min(),
               T most = std::numeric_limits<T>::max()) {
    std::uint64_t read = 0;
    for (unsigned shift = 0;; shift += 7) {
      const auto byte = in_.get<std::uint8_t>();
      const std::uint64_t bits = byte & 0x7FU;
      const bool needed = byte != 0 || shift == 0;
      require(name, needed && shift < 64 && (bits << shift) >> shift == bits);
      if (failed()) return;
      read |= bits << shift;
      if ((byte & 0x80U) == 0) break;
    }
    value = static_cast<T>(unzigzag<T>(read));
    require(name, zigzag(value) == read && value >= least && value <= most);
  }
  template <class E>
  requires std::is_enum_v<E>
  void one_of(const char* name, E& value, E first, E last) {
    using U = std::underlying_type_t<E>;
    U raw{};
    number<U>(name, raw, static_cast<U>(first), static_cast<U>(last));
    if (!failed()) value = static_cast<E>(raw);
  }
  void flag(const char* name, bool& value) {
    std::uint8_t raw = 0;
    number<std::uint8_t>(name, raw, 0, 1);
    value = raw == 1;
  }
  void name(const char* name, std::string& value) {
    value = get_string();
    require(name, valid_name(value));
  }
  void text(const char* name, std::string& value) {
    value = get_string();
    require(name, valid_text(value));
  }
  void bytes(const char* name, std::vector<std::uint8_t>& value, std::uint8_t most) {
    std::uint8_t count = 0;
    number<std::uint8_t>(name, count, 0, most);
    if (failed()) return;
    const auto taken = in_.take(count);
    value.assign(taken.begin(), taken.end());
    require(name, true);
  }
  void rest(const char* name, std::vector<std::uint8_t>& value, std::size_t most) {
    require(name, in_.left() >= 1 && in_.left() <= most);
    if (failed()) return;
    const auto taken = in_.take(in_.left());
    value.assign(taken.begin(), taken.end());
  }
  template <class T, class Each>
  void list(const char* name, std::vector<T>& values, std::uint8_t most, Each each,
            std::uint8_t least = 1) {
    std::uint8_t count = 0;
    number<std::uint8_t>(name, count, least, most);
    if (failed()) return;
    values.resize(count);
    for (T& value : values) each(*this, value);
  }
  template <class T, class Read>
  void optional(const char* name, std::optional<T>& value, Read read) {
    bool there = false;
    flag(name, there);
    if (!failed() && there) read(*this, value.emplace());
  }
  void require(const char* name, bool holds) {
    if (broken_ == nullptr && (in_.failed() || !holds)) broken_ = name;
    if (broken_ != nullptr) in_.fail();
  }

  [[nodiscard]] bool failed() const { return broken_ != nullptr; }
  [[nodiscard]] std::size_t left() const { return in_.left(); }
  /// Name of the first field that broke a rule. Requires: failed().
  [[nodiscard]] const char* broken() const { return broken_; }

 private:
  std::string get_string() {
    const auto bytes = in_.take(in_.get<std::uint8_t>());
    return {bytes.begin(), bytes.end()};
  }

  ByteReader in_;
  const char* broken_ = nullptr;
};

}  // namespace cairn::proto
