#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace cairn {

/// What kind of thing went wrong, for code that must choose; people read `Error::message`.
enum class ErrorCode {
  invalid_argument,     ///< The caller's (operator's, peer's) value is not acceptable.
  not_found,            ///< A named thing does not exist.
  conflict,             ///< Somebody else holds it: a lock, a port, a robot id.
  corrupt,              ///< Bytes that fail a checksum, a bound or a rule of their format.
  unsupported_version,  ///< Written by a version this one does not know.
  exhausted,            ///< A written bound was hit.
  io,                   ///< The operating system said no.
  unavailable,          ///< Not now: try again later.
};

/// An error value. `message` is one line for a person and says what to do about it.
struct Error {
  ErrorCode code;
  std::string message;
};

/// A value or an error: what a peer, a disk or an operator can cause is returned, not thrown.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}      // NOLINT: implicit
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT: implicit

  [[nodiscard]] bool has_value() const { return state_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  /// Requires: has_value().
  T& value() & { return assert(has_value()), std::get<0>(state_); }
  const T& value() const& { return assert(has_value()), std::get<0>(state_); }
  T&& value() && { return assert(has_value()), std::get<0>(std::move(state_)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  /// Requires: !has_value().
  [[nodiscard]] const Error& error() const { return assert(!has_value()), std::get<1>(state_); }

 private:
  std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT: implicit

  [[nodiscard]] bool has_value() const { return !error_.has_value(); }
  explicit operator bool() const { return has_value(); }
  /// Requires: !has_value().
  [[nodiscard]] const Error& error() const { return assert(error_), *error_; }

 private:
  std::optional<Error> error_;
};

using Status = Result<void>;

}  // namespace cairn
