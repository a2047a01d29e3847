#pragma once

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "client/cli/options.h"
#include "core/common/result.h"
#include "core/map/tile.h"
#include "proto/json/messages.h"

namespace cairn::cli {

/// A site's map as the server sent it.
struct SiteMap {
  api::MapReply head;
  std::vector<std::pair<TileKey, Tile>> tiles;
  /// [tiles] More are refused: 65 km² of 0.125 m cells, 12.5 GB.
  static constexpr std::size_t kMaxTiles = 1'000'000;
};

/// A synchronous WebSocket client of the server's API; every wait ends by the time-out. One thread.
class Connection {
 public:
  /// unavailable: nobody listens there, or it does not answer in time.
  static Result<std::unique_ptr<Connection>> open(const ServerAddress& server,
                                                  std::chrono::milliseconds timeout);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Sends a request and waits for its answer, passing over events.
  Result<nlohmann::json> call(const std::string& method, const nlohmann::json& params);
  /// The same with messages: `call<api::StatusReply>("status", api::Empty{})`.
  template <class Answer, class Params>
  Result<Answer> call(const std::string& method, const Params& params) {
    auto answer = call(method, nlohmann::json(params));
    if (!answer) return answer.error();
    return api::from_json<Answer>(*answer);
  }
  Result<SiteMap> map(const std::optional<std::string>& site);

  /// After `watch`: waits for the next status. Nothing when the operator pressed Ctrl-C.
  Result<std::optional<api::StatusReply>> next_status();
  /// From now on Ctrl-C ends next_status() instead of the program.
  void catch_interrupt();

 private:
  class Socket;
  explicit Connection(std::unique_ptr<Socket> socket);

  std::unique_ptr<Socket> socket_;
  std::uint32_t last_request_ = 0;
};

}  // namespace cairn::cli
