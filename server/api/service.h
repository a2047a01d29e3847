#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/common/result.h"
#include "core/map/packed_tile.h"
#include "proto/json/messages.h"

namespace cairn::server {

/// What the API asks of the rest of the server. Thread-safe; an answer may come later, on any
/// thread, exactly once.
class Service {
 public:
  template <class T>
  using Reply = std::function<void(Result<T>)>;

  struct Map {
    api::MapReply head;
    std::vector<std::pair<TileKey, std::shared_ptr<const PackedTile>>> tiles;
  };

  Service() = default;
  virtual ~Service() = default;
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  virtual void status(Reply<api::StatusReply> reply) = 0;
  virtual void found(const api::FoundRequest& request, Reply<api::SiteJson> reply) = 0;
  virtual void go_to(const api::GotoRequest& request, Reply<api::CommandReply> reply) = 0;
  virtual void explore(const api::ExploreRequest& request, Reply<api::CommandReply> reply) = 0;
  virtual void go_home(const api::ReturnRequest& request, Reply<api::CommandReply> reply) = 0;
  virtual void stop(const api::StopRequest& request, Reply<api::CommandReply> reply) = 0;
  virtual void plan(const api::PlanRequestJson& request, Reply<api::PlanReply> reply) = 0;
  /// An empty site name means the only one.
  virtual void map(const std::string& site, Reply<Map> reply) = 0;
};

}  // namespace cairn::server
