#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "core/common/result.h"
#include "core/map/tile.h"

/// What carries the messages over the WebSocket (API.md): requests, answers, events, map tiles.
namespace cairn::api {

inline constexpr std::size_t kMaxRequestBytes = std::size_t{64} * 1024;
inline constexpr std::size_t kMaxAnswerBytes = std::size_t{64} * 1024 * 1024;
inline constexpr int kMaxNesting = 16;

/// Text → JSON with bounded size and nesting. invalid_argument says where it is malformed.
[[nodiscard]] Result<nlohmann::json> parse_json(std::string_view text, std::size_t max_bytes);
/// JSON → text; bytes that are not UTF-8 (names from outside) are replaced, never thrown over.
[[nodiscard]] std::string to_text(const nlohmann::json& json);

[[nodiscard]] std::string_view code_name(ErrorCode code);
/// `unavailable` for a name of no code.
[[nodiscard]] ErrorCode code_of(std::string_view name);

struct Request {
  std::uint32_t id = 0;
  std::string method;
  nlohmann::json params = nlohmann::json::object();  ///< May be left out.
};

/// A request that cannot be read; `id` when at least that could be.
struct RequestFault {
  std::optional<std::uint32_t> id;
  Error error;
};

[[nodiscard]] std::string request_text(const Request& request);
[[nodiscard]] std::optional<RequestFault> parse_request(std::string_view text, Request& request);

[[nodiscard]] std::string result_text(std::uint32_t id, const nlohmann::json& result);
[[nodiscard]] std::string error_text(std::optional<std::uint32_t> id, const Error& error);
[[nodiscard]] std::string event_text(std::string_view event, const nlohmann::json& data);

/// What a client receives as text: an answer (with the request's id, or without when the server
/// could not read one) or an event.
struct Answer {
  std::optional<std::uint32_t> id;
  std::string event;    ///< Not empty: an event with `body` as data.
  nlohmann::json body;  ///< Result or data.
  std::optional<Error> error;
};
[[nodiscard]] Result<Answer> parse_answer(std::string_view text);

/// Before a tile's bytes in a binary message, little-endian:
/// request id u32 | level i8 | tx i32 | ty i32.
struct TileHead {
  std::uint32_t request = 0;
  TileKey key;
  static constexpr std::size_t kBytes = 4 + 1 + 4 + 4;
};
void append_tile_head(const TileHead& head, std::string& bytes);
[[nodiscard]] std::optional<TileHead> read_tile_head(std::string_view bytes);

}  // namespace cairn::api
