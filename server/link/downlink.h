#pragma once

#include <memory>
#include <optional>

#include "core/common/time.h"
#include "proto/sync/server_link.h"
#include "server/world/offer.h"

namespace cairn::server {

/// One session's view of the long-term map: what the robot was told, and when to look for news.
class Downlink {
 public:
  /// How often it is looked for something to tell.
  static constexpr Duration kPeriod = std::chrono::milliseconds(500);
  /// A robot that holds a map already says so within this time of the first question …
  static constexpr Duration kFirstWord = std::chrono::seconds(3);
  /// … and goes on at least so often, over a slow link.
  static constexpr Duration kNextWord = std::chrono::seconds(10);

  Downlink() : told_(std::make_shared<const ToldMap>()) {}

  /// Whether the site should be asked now; counts as asked if so.
  bool should_ask(const proto::ServerLink& link, MonotonicTime now);
  /// The robot began to say what it holds: until it has said all, nothing is told.
  void hear(const proto::MapDigest& digest, MonotonicTime now);
  /// How what it said compares.
  void take(const std::vector<ComparedTile>& compared);
  /// The site's answer: it is on its way to the robot.
  void take(PreparedOffer prepared, proto::ServerLink& link);
  [[nodiscard]] std::shared_ptr<const ToldMap> told() const { return told_; }

 private:
  void settle(const proto::ServerLink& link);

  std::shared_ptr<const ToldMap> told_;
  std::optional<ToldMap> on_its_way_;
  std::optional<MonotonicTime> listens_until_;
  bool heard_all_ = false;
  int comparing_ = 0;  ///< [digests] Heard and not compared yet.
  bool asked_ = false;
  MonotonicTime next_{};
};

}  // namespace cairn::server
