#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "server/api/limits.h"
#include "server/api/service.h"

namespace cairn::server {

/// What waits to be written to one WebSocket, most urgent first: answers, then the newest status,
/// then tiles of maps, so that a map under way never delays an answer. Bounded by what the session
/// admits: kMaxOpenRequests answers, one status, kMaxMapTransfers maps.
class Outbox {
 public:
  struct Message {
    bool binary = false;
    std::string bytes;
    bool ends_request = false;  ///< With it, one request of the peer is done.
  };

  void answer(std::string text, bool ends_request);
  /// Replaces a status that still waits: a slow reader gets only the newest.
  void status(std::string text) { status_ = std::move(text); }
  void forget_status() { status_.reset(); }
  /// The map's tiles, after its head was given to answer().
  void map(std::uint32_t request, Service::Map map);
  [[nodiscard]] std::size_t maps() const { return maps_.size(); }

  /// Takes the next message; nothing when empty.
  [[nodiscard]] std::optional<Message> next();

 private:
  struct Transfer {
    std::uint32_t request = 0;
    Service::Map map;
    std::size_t sent = 0;
  };
  Message next_tile();

  std::deque<Message> answers_;
  std::optional<std::string> status_;
  std::deque<Transfer> maps_;
};

}  // namespace cairn::server
