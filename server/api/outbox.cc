#include "server/api/outbox.h"

#include <utility>

#include "proto/codec/tile_snapshot.h"
#include "proto/json/envelope.h"

namespace cairn::server {

void Outbox::answer(std::string text, bool ends_request) {
  answers_.push_back({.binary = false, .bytes = std::move(text), .ends_request = ends_request});
}

void Outbox::map(std::uint32_t request, Service::Map map) {
  maps_.push_back({.request = request, .map = std::move(map)});
}

std::optional<Outbox::Message> Outbox::next() {
  if (!answers_.empty()) {
    auto message = std::move(answers_.front());
    answers_.pop_front();
    return message;
  }
  if (status_) {
    Message message{.binary = false, .bytes = std::move(*status_), .ends_request = false};
    status_.reset();
    return message;
  }
  if (!maps_.empty()) return next_tile();
  return std::nullopt;
}

Outbox::Message Outbox::next_tile() {
  auto& transfer = maps_.front();
  const auto& [key, tile] = transfer.map.tiles[transfer.sent++];
  Message message{.binary = true, .bytes = {}, .ends_request = false};
  const auto bytes = proto::write_tile_snapshot(*tile);
  message.bytes.reserve(api::TileHead::kBytes + bytes.size());
  api::append_tile_head({transfer.request, key}, message.bytes);
  message.bytes.append(bytes.begin(), bytes.end());
  if (transfer.sent == transfer.map.tiles.size()) {
    message.ends_request = true;
    maps_.pop_front();
  }
  return message;
}

}  // namespace cairn::server
