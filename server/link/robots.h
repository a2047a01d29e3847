#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "core/common/time.h"
#include "proto/json/messages.h"
#include "proto/sync/server_link.h"
#include "server/link/downlink.h"
#include "server/world/site.h"

namespace cairn::server {

/// What the server knows of one robot, whether it is connected now or was once.
struct Robot {
  std::string id;
  std::shared_ptr<Site> site;
  std::unique_ptr<proto::ServerLink> link;  ///< Null before its first session.
  Downlink downlink;                        ///< Of the link's session.
  std::size_t carrier = 0;                  ///< Which carrier its frames come by.
  std::string peer;                         ///< Its name on that carrier.
  std::optional<proto::PoseReport> pose;    ///< Newest by the robot's own clock.
  std::optional<proto::SpoolReport> spool;  ///< Newest; none from a robot that keeps no spool.
  bool pose_of_session = false;  ///< It came in the present session, so its clock can be compared.
  MonotonicTime pose_received{};
  std::optional<MonotonicTime> probed_at;  ///< When it was last asked whether it is there.
  std::uint64_t frames_malformed = 0;      ///< Bytes in its name that are no frame.
  std::deque<api::PointJson> track;        ///< Where it was, newest last.

  /// [points] Beyond it the oldest are forgotten.
  static constexpr std::size_t kMaxTrack = 20'000;
  /// [m] Points of the track are this far apart.
  static constexpr double kTrackSpacing = 0.1;
  /// A robot that was heard this recently is there …
  static constexpr Duration kPresence = std::chrono::seconds(5);
  /// … and one that stands, and has nothing to tell, this recently: it may have been lost once.
  static constexpr Duration kQuietPresence = std::chrono::seconds(45);
  /// Time for a robot that stands to answer whether it is there.
  static constexpr Duration kProbeWait = std::chrono::seconds(3);

  /// It stands and said so: it speaks rarely.
  [[nodiscard]] bool stands() const { return pose_of_session && pose->speed_mm_s == 0; }
  /// Requires: a link.
  [[nodiscard]] bool present(MonotonicTime now) const {
    return link->silence(now) < (stands() ? kQuietPresence : kPresence);
  }
  void take_pose(const proto::PoseReport& report, MonotonicTime now);
  [[nodiscard]] double x_m() const { return pose ? pose->T_site_robot.x_mm / 1000.0 : 0.0; }
  [[nodiscard]] double y_m() const { return pose ? pose->T_site_robot.y_mm / 1000.0 : 0.0; }
};

/// The robot as the API shows it, without its command.
[[nodiscard]] api::RobotJson describe(const Robot& robot, MonotonicTime now);

}  // namespace cairn::server
