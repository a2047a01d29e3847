#include "server/server.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/post.hpp>
#include <chrono>
#include <future>
#include <random>
#include <utility>

#include "proto/codec/text.h"
#include "server/mission/planning.h"
#include "server/store/sqlite_store.h"

namespace cairn::server {

namespace asio = boost::asio;
namespace fs = std::filesystem;

namespace {

std::string to_string(PathStatus status) {
  if (status == PathStatus::complete) return "complete";
  return status == PathStatus::partial ? "partial" : "none";
}

api::PlanReply to_reply(const Path& path) {
  api::PlanReply reply;
  reply.status = to_string(path.status);
  reply.why = path.why;
  reply.length_m = path.length_m;
  reply.cost_m = path.cost_m;
  for (const Eigen::Vector2d& p : path.points_m) reply.path.push_back({p.x(), p.y()});
  return reply;
}

}  // namespace

Server::Server(const asio::any_io_executor& executor, ServerConfig config)
    : executor_(executor),
      control_(asio::make_strand(executor)),
      config_(std::move(config)),
      started_(Hub::now()) {}

Result<std::shared_ptr<Server>> Server::start(
    const asio::any_io_executor& executor, const ServerConfig& config,
    std::vector<std::unique_ptr<proto::Carrier>> carriers) {
  std::shared_ptr<Server> server(new Server(executor, config));
  if (Status opened = server->open_sites(); !opened) return opened.error();
  server->listen(std::move(carriers));
  return server;
}

Result<std::vector<fs::path>> site_files(const fs::path& data) {
  std::error_code error;
  fs::create_directories(data, error);
  if (error) {
    return Error{ErrorCode::io,
                 fmt::format("cannot make the data folder {}: {}; choose another with --data",
                             data.string(), error.message())};
  }
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(data, error)) {
    if (entry.path().extension() == Server::kSiteSuffix) files.push_back(entry.path());
  }
  if (error) {
    return Error{ErrorCode::io,
                 fmt::format("cannot read the data folder {}: {}", data.string(), error.message())};
  }
  std::ranges::sort(files);
  return files;
}

Status Server::open_sites() {
  const auto files = site_files(config_.data);
  if (!files) return files.error();
  if (files->size() > kMaxSites) {
    return Error{ErrorCode::exhausted,
                 fmt::format("{} holds {} sites, the limit is {}: move some to another data folder",
                             config_.data.string(), files->size(), kMaxSites)};
  }
  for (const fs::path& file : *files) {
    if (Status opened = open_site(file); !opened) return opened;
  }
  return {};
}

Status Server::open_site(const fs::path& file) {
  auto store = SqliteStore::open(file);
  if (!store) return store.error();
  auto world = World::open(std::move(*store), config_.sensor_model);
  if (!world) {
    return Error{world.error().code, fmt::format("{}: {}", file.string(), world.error().message)};
  }
  auto site = std::make_shared<Site>(executor_, std::move(*world));
  spdlog::info("site {}: {} known cells", site->info().name, site->snapshot()->known_cells);
  site->start();
  const std::lock_guard lock(sites_mutex_);
  sites_[site->info().name] = std::move(site);
  return {};
}

void Server::listen(std::vector<std::unique_ptr<proto::Carrier>> carriers) {
  const std::weak_ptr<Server> weak = weak_from_this();
  Hub::Listener listener;
  listener.site_named = [weak](const std::string& name) {
    const auto self = weak.lock();
    return self ? self->site_named(name) : nullptr;
  };
  listener.connected = [weak](Robot& robot) {
    if (const auto self = weak.lock()) self->mission_->connected(robot);
  };
  listener.reported = [weak](Robot& robot, const proto::CommandReport& report) {
    if (const auto self = weak.lock()) self->mission_->reported(robot, report);
  };
  listener.asked = [weak](Robot& robot, const proto::CorridorRequest& request) {
    if (const auto self = weak.lock()) self->mission_->asked(robot, request);
  };
  hub_ = std::make_shared<Hub>(control_, std::move(carriers), std::move(listener), config_.budget);
  mission_ = std::make_shared<Mission>(control_, executor_, hub_, config_.mission);
  asio::post(control_, [mission = mission_, sites = all_sites()] {
    for (const std::shared_ptr<Site>& site : sites) mission->restore(*site);
    mission->start();
  });
  hub_->start();
}

void Server::stop() {
  hub_->stop();
  asio::post(control_, [mission = mission_] { mission->halt(); });
  for (const std::shared_ptr<Site>& site : all_sites()) {
    std::promise<void> flushed;
    site->flush([&flushed] { flushed.set_value(); });
    flushed.get_future().wait();
  }
}

std::shared_ptr<Site> Server::site_named(const std::string& name) const {
  const std::lock_guard lock(sites_mutex_);
  const auto found = sites_.find(name);
  return found == sites_.end() ? nullptr : found->second;
}

std::vector<std::shared_ptr<Site>> Server::all_sites() const {
  const std::lock_guard lock(sites_mutex_);
  std::vector<std::shared_ptr<Site>> sites;
  for (const auto& [name, site] : sites_) sites.push_back(site);
  return sites;
}

std::vector<std::string> Server::site_names() const {
  std::vector<std::string> names;
  for (const std::shared_ptr<Site>& site : all_sites()) names.push_back(site->info().name);
  return names;
}

Result<std::shared_ptr<Site>> Server::site_or_only(const std::optional<std::string>& name) const {
  if (name && !name->empty()) {
    if (auto site = site_named(*name)) return site;
    return Error{ErrorCode::not_found,
                 fmt::format("no site '{}' here: see `cairn status`, or found it with "
                             "`cairn found {}`",
                             *name, *name)};
  }
  const auto sites = all_sites();
  if (sites.size() == 1) return sites.front();
  if (sites.empty()) {
    return Error{ErrorCode::not_found, "no site has been founded: begin with `cairn found NAME`"};
  }
  return Error{ErrorCode::invalid_argument, "there are several sites: say which with --site NAME"};
}

std::vector<api::RobotJson> Server::describe_robots(const std::string& site) const {
  std::vector<api::RobotJson> robots;
  for (const auto& [id, robot] : hub_->robots()) {
    if (!robot.pose) continue;  // Where it is will be known in a moment.
    if (!site.empty() && robot.site->info().name != site) continue;
    api::RobotJson json = describe(robot, Hub::now());
    json.command = mission_->describe(id);
    json.task = mission_->describe_task(id);
    robots.push_back(std::move(json));
  }
  return robots;
}

void Server::status(Reply<api::StatusReply> reply) {
  asio::post(control_, [self = shared_from_this(), reply = std::move(reply)] {
    auto status = std::make_shared<api::StatusReply>();
    status->version = CAIRN_VERSION;
    status->uptime_s = to_seconds(Hub::now() - self->started_);
    status->robots = self->describe_robots({});
    const auto sites = self->all_sites();
    if (sites.empty()) return reply(*status);
    status->sites.resize(sites.size());
    auto missing = std::make_shared<std::atomic<std::size_t>>(sites.size());
    for (std::size_t i = 0; i < sites.size(); ++i) {
      sites[i]->describe([status, missing, i, reply](api::SiteJson site) {
        status->sites[i] = std::move(site);
        if (missing->fetch_sub(1) == 1) reply(*status);
      });
    }
  });
}

void Server::found(const api::FoundRequest& request, Reply<api::SiteJson> reply) {
  asio::post(control_, [self = shared_from_this(), request, reply = std::move(reply)] {
    if (!proto::valid_name(request.site)) {
      return reply(Error{ErrorCode::invalid_argument,
                         fmt::format("'{}' is no site name: use 1 to {} of a-z, 0-9, '-' and '_'",
                                     request.site, proto::kMaxNameBytes)});
    }
    if (request.cell_size_mm < 10 || request.cell_size_mm > 2000) {
      return reply(Error{ErrorCode::invalid_argument,
                         fmt::format("cells of {} mm: choose 10 to 2000", request.cell_size_mm)});
    }
    if (self->all_sites().size() >= kMaxSites) {
      return reply(Error{ErrorCode::exhausted,
                         fmt::format("this server holds {} sites, its limit", kMaxSites)});
    }
    SiteInfo info;
    info.name = request.site;
    std::random_device random;
    info.epoch = (std::uint64_t{random()} << 32) | random();
    info.cell_size_mm = request.cell_size_mm;
    info.founded_unix_s = std::chrono::duration_cast<std::chrono::seconds>(
                              std::chrono::system_clock::now().time_since_epoch())
                              .count();
    const fs::path file = self->config_.data / (info.name + kSiteSuffix);
    {
      auto store = SqliteStore::create(file, info);
      if (!store) return reply(store.error());
    }
    if (Status opened = self->open_site(file); !opened) return reply(opened.error());
    self->site_named(info.name)->describe([reply](const api::SiteJson& site) { reply(site); });
  });
}

void Server::go_to(const api::GotoRequest& request, Reply<api::CommandReply> reply) {
  asio::post(control_, [self = shared_from_this(), request, reply = std::move(reply)] {
    self->mission_->go_to(request, reply);
  });
}

void Server::explore(const api::ExploreRequest& request, Reply<api::CommandReply> reply) {
  asio::post(control_, [self = shared_from_this(), request, reply = std::move(reply)] {
    self->mission_->explore(request, reply);
  });
}

void Server::go_home(const api::ReturnRequest& request, Reply<api::CommandReply> reply) {
  asio::post(control_, [self = shared_from_this(), request, reply = std::move(reply)] {
    self->mission_->go_home(request, reply);
  });
}

void Server::stop(const api::StopRequest& request, Reply<api::CommandReply> reply) {
  asio::post(control_, [self = shared_from_this(), request, reply = std::move(reply)] {
    self->mission_->stop(request, reply);
  });
}

void Server::plan(const api::PlanRequestJson& request, Reply<api::PlanReply> reply) {
  const auto site = site_or_only(request.site);
  if (!site) return reply(site.error());
  asio::post(
      executor_, [self = shared_from_this(), site = *site, request, reply = std::move(reply)] {
        const MonotonicTime began = Hub::now();
        PlanTarget target{site->info().name, site->snapshot(), {}, self->config_.mission.planner};
        target.planner.unknown =
            request.unknown == "allowed" ? UnknownGround::allowed : UnknownGround::blocked;
        target.request.start_m = {request.from.x_m, request.from.y_m};
        target.request.goal_m = {request.to.x_m, request.to.y_m};
        target.request.allow_partial = request.allow_partial;
        api::PlanReply answer;
        const Status followed = self->mission_->fields().with(
            target, [&](const KeptField& field) { answer = to_reply(field.plan(target)); });
        if (!followed) return reply(followed.error());
        answer.map_version = target.map->version;
        answer.seconds = to_seconds(Hub::now() - began);
        reply(answer);
      });
}

void Server::map(const std::string& site, Reply<Map> reply) {
  const auto found = site_or_only(site);
  if (!found) return reply(found.error());
  asio::post(control_, [self = shared_from_this(), site = *found, reply = std::move(reply)] {
    const std::shared_ptr<const MapSnapshot> snapshot = site->snapshot();
    Map map;
    map.head.site = site->info().name;
    map.head.cell_size_mm = snapshot->cell_size_mm;
    map.head.map_version = snapshot->version;
    map.head.tiles = snapshot->tiles.size();
    map.head.climb_mm = self->config_.mission.planner.limits.climb_mm;
    map.head.descend_mm = self->config_.mission.planner.limits.descend_mm;
    map.head.robots = self->describe_robots(map.head.site);
    for (const api::RobotJson& robot : map.head.robots) {
      const auto& track = self->hub_->find(robot.id)->track;
      map.head.tracks.emplace_back(track.begin(), track.end());
    }
    map.tiles.assign(snapshot->tiles.begin(), snapshot->tiles.end());
    reply(std::move(map));
  });
}

}  // namespace cairn::server
