#include "proto/json/envelope.h"

#include <algorithm>
#include <array>
#include <utility>

namespace cairn::api {

namespace {

constexpr std::array<std::pair<ErrorCode, std::string_view>, 8> kCodes = {{
    {ErrorCode::invalid_argument, "invalid_argument"},
    {ErrorCode::not_found, "not_found"},
    {ErrorCode::conflict, "conflict"},
    {ErrorCode::corrupt, "corrupt"},
    {ErrorCode::unsupported_version, "unsupported_version"},
    {ErrorCode::exhausted, "exhausted"},
    {ErrorCode::io, "io"},
    {ErrorCode::unavailable, "unavailable"},
}};

Error invalid(std::string message) { return {ErrorCode::invalid_argument, std::move(message)}; }

/// Brackets deep inside brackets, outside of strings. Deep documents are refused before they are
/// parsed, since a parsed one is copied and freed by recursion.
bool nests_too_deep(std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMaxNesting) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

/// nlohmann's message without its "[json.exception.…] " and without the bytes last read, which may
/// be anything.
std::string reason(const nlohmann::json::exception& fault) {
  std::string text = fault.what();
  if (const auto end = text.find("] "); end != std::string::npos) text.erase(0, end + 2);
  if (const auto read = text.find("; last read"); read != std::string::npos) text.erase(read);
  return text.substr(0, 160);
}

std::optional<std::uint32_t> id_in(const nlohmann::json& json) {
  const auto found = json.find("id");
  if (found == json.end() || !found->is_number_unsigned()) return std::nullopt;
  const auto id = found->get<std::uint64_t>();
  if (id > UINT32_MAX) return std::nullopt;
  return static_cast<std::uint32_t>(id);
}

template <std::size_t N>
std::optional<std::string> key_outside(const nlohmann::json& json,
                                       const std::array<std::string_view, N>& known) {
  for (const auto& [key, value] : json.items()) {
    if (std::ranges::find(known, key) == known.end()) return key.substr(0, 64);
  }
  return std::nullopt;
}

void append_le(std::uint32_t value, std::string& bytes) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(value >> shift));
}

std::uint32_t read_le(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value |= std::uint32_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
  }
  return value;
}

}  // namespace

Result<nlohmann::json> parse_json(std::string_view text, std::size_t max_bytes) {
  if (text.size() > max_bytes) {
    return invalid("message of " + std::to_string(text.size()) + " bytes: expected at most " +
                   std::to_string(max_bytes));
  }
  if (nests_too_deep(text)) {
    return invalid("message nested too deep: expected at most " + std::to_string(kMaxNesting) +
                   " levels");
  }
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::exception& fault) {
    return invalid("message is not JSON: " + reason(fault));
  }
}

std::string to_text(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string_view code_name(ErrorCode code) {
  const auto* found = std::ranges::find(kCodes, code, &decltype(kCodes)::value_type::first);
  return found == kCodes.end() ? "unavailable" : found->second;
}

ErrorCode code_of(std::string_view name) {
  const auto* found = std::ranges::find(kCodes, name, &decltype(kCodes)::value_type::second);
  return found == kCodes.end() ? ErrorCode::unavailable : found->first;
}

std::string request_text(const Request& request) {
  return to_text({{"id", request.id}, {"method", request.method}, {"params", request.params}});
}

std::optional<RequestFault> parse_request(std::string_view text, Request& request) {
  auto json = parse_json(text, kMaxRequestBytes);
  if (!json) return RequestFault{std::nullopt, json.error()};
  if (!json->is_object()) {
    return RequestFault{std::nullopt, invalid("message: expected an object")};
  }
  const auto id = id_in(*json);
  if (!id) return RequestFault{id, invalid("id: expected a whole number from 0 to 4294967295")};
  if (const auto key =
          key_outside(*json, std::array<std::string_view, 3>{"id", "method", "params"})) {
    return RequestFault{
        id, invalid("unknown key \"" + *key + "\": expected \"id\", \"method\", \"params\"")};
  }
  const auto method = json->find("method");
  if (method == json->end() || !method->is_string()) {
    return RequestFault{id, invalid("method: expected a text")};
  }
  request.id = *id;
  request.method = method->get<std::string>();
  if (const auto params = json->find("params"); params != json->end()) request.params = *params;
  if (!request.params.is_object()) {
    return RequestFault{id, invalid("params: expected an object")};
  }
  return std::nullopt;
}

std::string result_text(std::uint32_t id, const nlohmann::json& result) {
  return to_text({{"id", id}, {"result", result}});
}

std::string error_text(std::optional<std::uint32_t> id, const Error& error) {
  nlohmann::json json{{"id", nullptr},
                      {"error", {{"code", code_name(error.code)}, {"message", error.message}}}};
  if (id) json["id"] = *id;
  return to_text(json);
}

std::string event_text(std::string_view event, const nlohmann::json& data) {
  return to_text({{"event", event}, {"data", data}});
}

Result<Answer> parse_answer(std::string_view text) {
  auto json = parse_json(text, kMaxAnswerBytes);
  if (!json) return json.error();
  const Error strange{ErrorCode::corrupt, "the server sent an answer that is none: is it Cairn's?"};
  if (!json->is_object()) return strange;
  Answer answer{.id = id_in(*json), .event = {}, .body = {}, .error = std::nullopt};
  if (json->contains("event") && (*json)["event"].is_string() && json->contains("data")) {
    answer.event = (*json)["event"].get<std::string>();
    answer.body = std::move((*json)["data"]);
  } else if (json->contains("result") && answer.id) {
    answer.body = std::move((*json)["result"]);
  } else if (json->contains("error") && (*json)["error"].is_object()) {
    const auto& error = (*json)["error"];
    const auto text_of = [&error](const char* key) {
      const auto found = error.find(key);
      return found != error.end() && found->is_string() ? found->get<std::string>() : std::string();
    };
    answer.error = Error{code_of(text_of("code")), text_of("message")};
  } else {
    return strange;
  }
  return answer;
}

void append_tile_head(const TileHead& head, std::string& bytes) {
  append_le(head.request, bytes);
  bytes.push_back(static_cast<char>(head.key.level));
  append_le(static_cast<std::uint32_t>(head.key.tx), bytes);
  append_le(static_cast<std::uint32_t>(head.key.ty), bytes);
}

std::optional<TileHead> read_tile_head(std::string_view bytes) {
  if (bytes.size() < TileHead::kBytes) return std::nullopt;
  return TileHead{read_le(bytes, 0),
                  {static_cast<std::int8_t>(bytes[4]), static_cast<std::int32_t>(read_le(bytes, 5)),
                   static_cast<std::int32_t>(read_le(bytes, 9))}};
}

}  // namespace cairn::api
