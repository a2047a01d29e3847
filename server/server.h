#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/map/sensor_model.h"
#include "server/api/service.h"
#include "server/link/hub.h"
#include "server/mission/mission.h"
#include "server/world/site.h"

namespace cairn::server {

struct ServerConfig {
  std::filesystem::path data;  ///< Folder of the site files, NAME.cairn
  SensorModel sensor_model;
  MissionConfig mission;
  proto::BudgetConfig budget;  ///< Of the way down to each robot.
};

/// The site files of a data folder (made if missing), sorted by name.
Result<std::vector<std::filesystem::path>> site_files(const std::filesystem::path& data);

/// The map server without its API's sockets: sites, robots, missions; answers what operators ask.
/// Thread-safe.
class Server : public Service, public std::enable_shared_from_this<Server> {
 public:
  /// Opens every site of the data folder (made if missing) and starts to listen to robots.
  static Result<std::shared_ptr<Server>> start(
      const boost::asio::any_io_executor& executor, const ServerConfig& config,
      std::vector<std::unique_ptr<proto::Carrier>> carriers);
  /// Stops listening and makes everything received durable; returns when done. The executor's
  /// threads must still be running.
  void stop();

  void status(Reply<api::StatusReply> reply) override;
  void found(const api::FoundRequest& request, Reply<api::SiteJson> reply) override;
  void go_to(const api::GotoRequest& request, Reply<api::CommandReply> reply) override;
  void explore(const api::ExploreRequest& request, Reply<api::CommandReply> reply) override;
  void go_home(const api::ReturnRequest& request, Reply<api::CommandReply> reply) override;
  void stop(const api::StopRequest& request, Reply<api::CommandReply> reply) override;
  void plan(const api::PlanRequestJson& request, Reply<api::PlanReply> reply) override;
  void map(const std::string& site, Reply<Map> reply) override;

  [[nodiscard]] std::vector<std::string> site_names() const;

  /// [sites] In one data folder.
  static constexpr std::size_t kMaxSites = 64;
  static constexpr const char* kSiteSuffix = ".cairn";

 private:
  Server(const boost::asio::any_io_executor& executor, ServerConfig config);
  Status open_sites();
  Status open_site(const std::filesystem::path& file);
  void listen(std::vector<std::unique_ptr<proto::Carrier>> carriers);
  std::shared_ptr<Site> site_named(const std::string& name) const;
  Result<std::shared_ptr<Site>> site_or_only(const std::optional<std::string>& name) const;
  std::vector<std::shared_ptr<Site>> all_sites() const;
  std::vector<api::RobotJson> describe_robots(const std::string& site) const;

  boost::asio::any_io_executor executor_;
  Hub::Strand control_;
  ServerConfig config_;
  MonotonicTime started_;
  mutable std::mutex sites_mutex_;  ///< Guards only the table; each Site guards itself.
  std::map<std::string, std::shared_ptr<Site>> sites_;
  std::shared_ptr<Hub> hub_;
  std::shared_ptr<Mission> mission_;
};

}  // namespace cairn::server
