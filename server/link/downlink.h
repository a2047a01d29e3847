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

  Downlink() : told_(std::make_shared<const ToldMap>()) {}

  /// Whether the site should be asked now; counts as asked if so.
  bool should_ask(const proto::ServerLink& link, MonotonicTime now);
  /// The site's answer: it is on its way to the robot.
  void take(PreparedOffer prepared, proto::ServerLink& link);
  [[nodiscard]] std::shared_ptr<const ToldMap> told() const { return told_; }

 private:
  void settle(const proto::ServerLink& link);

  std::shared_ptr<const ToldMap> told_;
  std::optional<ToldMap> on_its_way_;
  bool asked_ = false;
  MonotonicTime next_{};
};

}  // namespace cairn::server
