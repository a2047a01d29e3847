#include "server/world/site.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <utility>

namespace cairn::server {

namespace asio = boost::asio;

Site::Site(const asio::any_io_executor& executor, std::unique_ptr<World> world)
    : strand_(asio::make_strand(executor)),
      executor_(executor),
      world_(std::move(world)),
      commit_timer_(strand_),
      publish_timer_(strand_) {}

void Site::start() {
  graph_ = std::make_shared<GraphKeeper>(
      executor_, [weak = weak_from_this()](GraphFindings findings, GraphKeeper::Told told) {
        if (const auto self = weak.lock()) self->tell_world(std::move(findings), std::move(told));
      });
  asio::post(strand_,
             [self = shared_from_this()] { self->load_graph(self->world_->merged_in_order()); });
}

void Site::load_graph(std::vector<SubmapId> left) {
  std::ranges::reverse(left);  // The next one stands last.
  std::vector<MergedSubmap> loaded;
  for (int i = 0; i < kLoadSlice && !left.empty(); ++i) {
    auto submap = world_->load_merged(left.back());
    left.pop_back();
    if (submap) loaded.push_back(*std::move(submap));
  }
  graph_->take(std::move(loaded));
  std::ranges::reverse(left);
  if (!left.empty()) {
    asio::post(strand_,
               [self = shared_from_this(), left = std::move(left)] { self->load_graph(left); });
    return;
  }
  auto findings = world_->load_findings();
  if (!findings) {
    spdlog::error("site {}: {}; loops are looked for anew", info().name, findings.error().message);
    findings = GraphFindings{};
  }
  graph_->take(world_->take_merged());
  graph_->resume(*std::move(findings));
  graph_loaded_ = true;
}

void Site::tell_world(GraphFindings findings, GraphKeeper::Told told) {
  asio::post(strand_,
             [self = shared_from_this(), findings = std::move(findings), told = std::move(told)] {
               const Status moved = self->world_->move(findings);
               if (moved && !findings.moves.empty()) {
                 spdlog::info("site {}: loops closed, {} submaps moved", self->info().name,
                              findings.moves.size());
                 self->schedule_publish();
               }
               told(moved);
             });
}

void Site::offer(const MapNeed& need, std::shared_ptr<const ToldMap> told,
                 std::function<void(PreparedOffer)> reply) {
  asio::post(strand_, [self = shared_from_this(), need, told = std::move(told),
                       reply = std::move(reply)] { reply(self->world_->offer(need, *told)); });
}

void Site::compare(std::uint64_t boot, proto::MapDigest digest,
                   std::function<void(std::vector<ComparedTile>)> reply) {
  asio::post(strand_, [self = shared_from_this(), boot, digest = std::move(digest),
                       reply = std::move(reply)] { reply(self->world_->compare(boot, digest)); });
}

void Site::submit(std::string robot, std::uint64_t boot, proto::ServerLink::Evidence evidence,
                  Done done) {
  asio::post(strand_, [self = shared_from_this(), robot = std::move(robot), boot,
                       evidence = std::move(evidence), done = std::move(done)] {
    World::Staged staged = self->world_->stage(robot, boot, evidence);
    if (!staged.accepted) {
      done({});
      return;
    }
    self->waiting_.push_back({std::move(staged.refusals), done});
    self->schedule_commit(kCommitPeriod);
  });
}

void Site::schedule_commit(std::chrono::milliseconds delay) {
  if (commit_scheduled_) return;
  commit_scheduled_ = true;
  commit_timer_.expires_after(delay);
  commit_timer_.async_wait([self = shared_from_this()](const boost::system::error_code& error) {
    self->commit_scheduled_ = false;
    if (!error) self->commit();
  });
}

void Site::commit() {
  if (Status written = world_->commit(); !written) {
    spdlog::error("site {}: {}; evidence is kept in memory and tried again", info().name,
                  written.error().message);
    schedule_commit(kRetryPeriod);
    return;
  }
  for (Waiting& waiting : std::exchange(waiting_, {})) {
    waiting.done({.durable = true, .refusals = std::move(waiting.refusals)});
  }
  if (graph_loaded_) graph_->take(world_->take_merged());
  schedule_publish();
}

void Site::schedule_publish() {
  if (publish_scheduled_) return;
  publish_scheduled_ = true;
  publish_timer_.expires_after(kPublishPeriod);
  publish_timer_.async_wait([self = shared_from_this()](const boost::system::error_code& error) {
    self->publish_scheduled_ = false;
    if (error) return;
    if (self->world_->has_staged()) self->commit();
    self->world_->publish();
  });
}

void Site::next_command_id(std::function<void(Result<std::uint64_t>)> reply) {
  asio::post(strand_, [self = shared_from_this(), reply = std::move(reply)] {
    reply(self->world_->next_command_id());
  });
}

void Site::keep_note(std::string name, std::string value, std::function<void(Status)> done) {
  asio::post(strand_, [self = shared_from_this(), name = std::move(name), value = std::move(value),
                       done = std::move(done)] { done(self->world_->keep_note(name, value)); });
}

void Site::flush(std::function<void()> done) {
  asio::post(strand_, [self = shared_from_this(), done = std::move(done)] {
    self->commit();
    self->world_->publish();
    self->commit_timer_.cancel();
    self->publish_timer_.cancel();
    done();
  });
}

void Site::describe(std::function<void(api::SiteJson)> reply) {
  asio::post(strand_, [self = shared_from_this(), reply = std::move(reply)] {
    const World& world = *self->world_;
    const std::shared_ptr<const MapSnapshot> map = world.snapshot();
    api::SiteJson site;
    site.name = world.site().name;
    site.cell_size_mm = world.site().cell_size_mm;
    site.map_version = map->version;
    site.tiles = map->tiles.size();
    site.known_cells = map->known_cells;
    site.memory_bytes = map->memory_bytes;
    site.submaps = world.submaps();
    site.submaps_merged = world.merged();
    site.commits = world.commits();
    reply(site);
  });
}

}  // namespace cairn::server
