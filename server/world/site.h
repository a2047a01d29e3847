#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "proto/json/messages.h"
#include "server/world/graph_keeper.h"
#include "server/world/world.h"

namespace cairn::server {

/// A world on its strand: gathers the evidence of a few milliseconds into one transaction, and
/// publishes snapshots at a steady pace. All public functions may be called from any thread.
class Site : public std::enable_shared_from_this<Site> {
 public:
  /// What became of one frame's evidence, told on the strand after the commit (or at once when it
  /// was not accepted).
  struct Outcome {
    bool durable = false;
    std::vector<proto::Refusal> refusals;
  };
  using Done = std::function<void(Outcome)>;

  Site(const boost::asio::any_io_executor& executor, std::unique_ptr<World> world);
  /// Begins to keep the map straight: reads the merged submaps, a few at a time. Call once.
  void start();

  void submit(std::string robot, std::uint64_t boot, proto::ServerLink::Evidence evidence,
              Done done);
  void next_command_id(std::function<void(Result<std::uint64_t>)> reply);
  /// `done` is called on the strand when it is durable, or could not be made so.
  void keep_note(std::string name, std::string value, std::function<void(Status)> done);
  [[nodiscard]] const std::map<std::string, std::string>& notes_at_start() const {
    return world_->notes_at_start();
  }
  /// What a robot should be told next of the long-term map, see World::offer.
  void offer(const MapNeed& need, std::shared_ptr<const ToldMap> told,
             std::function<void(PreparedOffer)> reply);
  /// See World::compare.
  void compare(std::uint64_t boot, proto::MapDigest digest,
               std::function<void(std::vector<ComparedTile>)> reply);
  /// Commits what is staged and publishes; for an orderly end.
  void flush(std::function<void()> done);

  [[nodiscard]] std::shared_ptr<const MapSnapshot> snapshot() const { return world_->snapshot(); }
  [[nodiscard]] const SiteInfo& info() const { return world_->site(); }
  void describe(std::function<void(api::SiteJson)> reply);

  /// Evidence of this long shares one transaction.
  static constexpr std::chrono::milliseconds kCommitPeriod{12};
  static constexpr std::chrono::milliseconds kPublishPeriod{250};
  /// [submaps] Read at a time for the pose graph, between other work.
  static constexpr int kLoadSlice = 4;
  /// After a failed commit (a full disk) the next try waits this long.
  static constexpr std::chrono::milliseconds kRetryPeriod{1000};

 private:
  struct Waiting {
    std::vector<proto::Refusal> refusals;
    Done done;
  };
  void schedule_commit(std::chrono::milliseconds delay);
  void schedule_publish();
  void commit();
  void load_graph(std::vector<SubmapId> left);
  void tell_world(GraphFindings findings, GraphKeeper::Told told);

  boost::asio::strand<boost::asio::any_io_executor> strand_;
  boost::asio::any_io_executor executor_;
  std::unique_ptr<World> world_;
  std::shared_ptr<GraphKeeper> graph_;  ///< Null before start().
  boost::asio::steady_timer commit_timer_;
  boost::asio::steady_timer publish_timer_;
  bool graph_loaded_ = false;
  bool commit_scheduled_ = false;
  bool publish_scheduled_ = false;
  std::vector<Waiting> waiting_;  ///< Bounded by World::kMaxStagedBlocks: each has staged evidence.
};

}  // namespace cairn::server
