#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/map/tile.h"
#include "server/api/service.h"

namespace cairn::server {

/// A server without a world: fixed answers, and it remembers what it was asked.
class FakeService final : public Service {
 public:
  void status(Reply<api::StatusReply> reply) override {
    const std::lock_guard lock(mutex_);
    ++statuses_asked;
    if (holds_back) {
      held_back.push_back([reply, status = status_reply] { reply(status); });
    } else {
      reply(status_reply);
    }
  }
  void found(const api::FoundRequest& request, Reply<api::SiteJson> reply) override {
    if (request.site == "taken") return reply(Error{ErrorCode::conflict, "taken is founded"});
    api::SiteJson site;
    site.name = request.site;
    site.cell_size_mm = request.cell_size_mm;
    reply(site);
  }
  void go_to(const api::GotoRequest& request, Reply<api::CommandReply> reply) override {
    const std::lock_guard lock(mutex_);
    last_goto = request;
    reply(api::CommandReply{7, request.robot.value_or("r1"), "complete", "", 5.0, 6.0, {{1, 2}}});
  }
  void explore(const api::ExploreRequest& request, Reply<api::CommandReply> reply) override {
    const std::lock_guard lock(mutex_);
    last_explore = request;
    reply(api::CommandReply{9, request.robot.value_or("r1"), "complete", "", 5.0, 6.0, {}, 2});
  }
  void go_home(const api::ReturnRequest& request, Reply<api::CommandReply> reply) override {
    reply(api::CommandReply{10, request.robot.value_or("r1"), "complete", "", 5.0, 6.0, {}, 3});
  }
  void stop(const api::StopRequest& request, Reply<api::CommandReply> reply) override {
    if (request.robot == "ghost") {
      return reply(Error{ErrorCode::not_found, "no robot ghost: see `cairn status`"});
    }
    reply(api::CommandReply{8, request.robot.value_or("r1"), "complete", "", 0.0, 0.0, {}});
  }
  /// Answers from another thread, as the planner does.
  void plan(const api::PlanRequestJson& request, Reply<api::PlanReply> reply) override {
    std::thread([request, reply] {
      reply(api::PlanReply{"complete", "", 5.0, 6.0, 3, 0.01, {request.from, request.to}});
    }).detach();
  }
  void map(const std::string& site, Reply<Map> reply) override {
    if (!site.empty() && site != "yard") {
      return reply(Error{ErrorCode::not_found, "no site " + site});
    }
    Map answer;
    answer.head.site = "yard";
    answer.head.cell_size_mm = 125;
    answer.head.map_version = 3;
    answer.head.climb_mm = answer.head.descend_mm = 100;
    const std::lock_guard lock(mutex_);
    answer.tiles = tiles;
    reply(std::move(answer));
  }

  /// Lets the answers go that were held back; they come on the caller's thread.
  void release() {
    std::vector<std::function<void()>> replies;
    {
      const std::lock_guard lock(mutex_);
      replies.swap(held_back);
    }
    for (const auto& reply : replies) reply();
  }
  [[nodiscard]] std::size_t held_back_count() {
    const std::lock_guard lock(mutex_);
    return held_back.size();
  }
  [[nodiscard]] int status_count() {
    const std::lock_guard lock(mutex_);
    return statuses_asked;
  }

  api::StatusReply status_reply{"0.1.0", 1.5, {}, {}};
  std::vector<std::pair<TileKey, std::shared_ptr<const PackedTile>>> tiles;
  std::optional<api::GotoRequest> last_goto;
  std::optional<api::ExploreRequest> last_explore;
  bool holds_back = false;

 private:
  std::mutex mutex_;
  int statuses_asked = 0;
  std::vector<std::function<void()>> held_back;
};

/// A full tile whose heights differ by `seed`.
inline std::shared_ptr<const PackedTile> full_tile(int seed) {
  Tile tile(0);
  for (int i = 0; i < Tile::kCells; ++i) tile.set(i, {(i * 7 + seed) % 1000, 200});
  return std::make_shared<const PackedTile>(PackedTile::pack(tile));
}

}  // namespace cairn::server
