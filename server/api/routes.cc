#include "server/api/routes.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include "proto/codec/tile_snapshot.h"
#include "proto/json/envelope.h"
#include "server/api/metrics.h"

namespace cairn::server {

namespace {

using Reply = std::function<void(HttpAnswer)>;

int http_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::invalid_argument:
      return 400;
    case ErrorCode::not_found:
      return 404;
    case ErrorCode::conflict:
      return 409;
    case ErrorCode::exhausted:
    case ErrorCode::unavailable:
      return 503;
    default:
      return 500;
  }
}

HttpAnswer failed(const Error& error) {
  return json_answer(http_code(error.code), error.code, error.message);
}

HttpAnswer not_found(const std::string& what) {
  return json_answer(404, ErrorCode::not_found, what);
}

struct TileTarget {
  std::string site;
  TileKey key;
};

/// Cuts the text up to the next '/' off `rest`.
std::string_view next_part(std::string_view& rest) {
  const auto end = std::min(rest.find('/'), rest.size());
  const auto part = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return part;
}

template <class T>
bool read_number(std::string_view text, T& value) {
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  return fault == std::errc() && end == text.data() + text.size();
}

/// /api/v1/sites/NAME/tiles/LEVEL/TX/TY
std::optional<TileTarget> tile_target(std::string_view target) {
  constexpr std::string_view kStart = "/api/v1/sites/";
  if (!target.starts_with(kStart)) return std::nullopt;
  target.remove_prefix(kStart.size());
  TileTarget found;
  found.site = next_part(target);
  int level = 0;
  if (found.site.empty() || next_part(target) != "tiles" ||
      !read_number(next_part(target), level) || !read_number(next_part(target), found.key.tx) ||
      !read_number(target, found.key.ty) || level < INT8_MIN || level > INT8_MAX) {
    return std::nullopt;
  }
  found.key.level = static_cast<std::int8_t>(level);
  return found;
}

HttpAnswer tile_answer(const Result<Service::Map>& map, const TileKey& key) {
  if (!map) return failed(map.error());
  const auto& tiles = map->tiles;
  const auto found = std::ranges::find_if(tiles, [&](const auto& t) { return t.first == key; });
  if (found == tiles.end()) return not_found("nothing is known in this tile");
  const auto bytes = proto::write_tile_snapshot(*found->second);
  return {200, "application/octet-stream", std::string(bytes.begin(), bytes.end())};
}

void respond_status(Service& service, Reply reply) {
  service.status([reply = std::move(reply)](Result<api::StatusReply> status) {
    reply(status ? HttpAnswer{200, "application/json", api::to_text(*status)}
                 : failed(status.error()));
  });
}

void respond_metrics(Service& service, const Connections& connections, Reply reply) {
  const ApiCounts counts{connections.count(), connections.refused()};
  service.status([counts, reply = std::move(reply)](Result<api::StatusReply> status) {
    reply(status ? HttpAnswer{200, "text/plain; version=0.0.4", metrics_text(*status, counts)}
                 : failed(status.error()));
  });
}

}  // namespace

HttpAnswer json_answer(int http_code, ErrorCode code, const std::string& message) {
  const nlohmann::json body{{"error", {{"code", api::code_name(code)}, {"message", message}}}};
  return {http_code, "application/json", api::to_text(body)};
}

void respond(Service& service, const Connections& connections, const std::string& target,
             Reply reply) {
  if (target == "/healthz") return reply({200, "text/plain", "ok\n"});
  if (target == "/metrics") return respond_metrics(service, connections, std::move(reply));
  if (target == "/api/v1/status") return respond_status(service, std::move(reply));
  if (const auto tile = tile_target(target)) {
    return service.map(
        tile->site, [key = tile->key, reply = std::move(reply)](const Result<Service::Map>& map) {
          reply(tile_answer(map, key));
        });
  }
  reply(
      not_found("no such page: try /healthz, /metrics, /api/v1/status, "
                "/api/v1/sites/NAME/tiles/LEVEL/TX/TY or the WebSocket /api/v1/ws"));
}

}  // namespace cairn::server
