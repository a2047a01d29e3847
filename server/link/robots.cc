#include "server/link/robots.h"

#include <cmath>

namespace cairn::server {

namespace {

const char* name_of(proto::DriveState state) {
  switch (state) {
    case proto::DriveState::idle:
      return "idle";
    case proto::DriveState::driving:
      return "driving";
    case proto::DriveState::blocked:
      return "blocked";
    case proto::DriveState::stopped:
      return "stopped";
  }
  return "idle";
}

const char* name_of(proto::Localization state) {
  switch (state) {
    case proto::Localization::localized:
      return "localized";
    case proto::Localization::unsure:
      return "unsure";
    case proto::Localization::lost:
      return "lost";
  }
  return "lost";
}

api::TrafficJson by_kind(const proto::TrafficBytes& bytes) {
  const auto of = [&](proto::Traffic kind) { return bytes[static_cast<std::size_t>(kind)]; };
  return {of(proto::Traffic::control), of(proto::Traffic::pose), of(proto::Traffic::map)};
}

double share(std::uint64_t missed, std::uint64_t received) {
  return missed == 0 ? 0.0 : static_cast<double>(missed) / static_cast<double>(missed + received);
}

api::SpoolJson describe_spool(const proto::SpoolReport& spool) {
  return {.state = spool.failed ? "failed" : "ok",
          .submaps = spool.submaps,
          .bytes = spool.bytes,
          .thinned = spool.thinned,
          .dropped = spool.dropped};
}

api::LinkJson describe_link(const Robot& robot, MonotonicTime now) {
  api::LinkJson link;
  if (!robot.link) return link;
  const proto::LinkCounters& counters = robot.link->counters();
  link.silence_s = to_seconds(robot.link->silence(now));
  link.connected = robot.present(now);
  link.round_trip_s = to_seconds(robot.link->round_trip().value_or(Duration{}));
  link.bytes_up = counters.bytes_received;
  link.bytes_down = counters.bytes_sent;
  link.frames_lost = counters.frames_missed;
  link.frames_down_lost = counters.frames_lost;
  link.loss_up = share(counters.frames_missed, counters.frames_received);
  link.loss_down = robot.link->budget().loss();
  link.budget_down_bit_s = robot.link->budget().rate_bit_s();
  link.unacknowledged_bytes = robot.link->bytes_under_way();
  link.up = by_kind(counters.received_bytes);
  link.down = by_kind(robot.link->budget().sent_bytes());
  link.frames_malformed = robot.frames_malformed;
  if (robot.pose) link.backlog_blocks = robot.pose->backlog_blocks;
  if (robot.spool) link.spool = describe_spool(*robot.spool);
  link.queue_s = to_seconds(robot.link->budget().queue());
  return link;
}

}  // namespace

void Robot::take_pose(const proto::PoseReport& report, MonotonicTime now) {
  if (pose_of_session && report.clock_ms < pose->clock_ms) return;  // Overtaken on the way.
  pose_of_session = true;
  pose = report;
  pose_received = now;
  if (!track.empty() &&
      std::hypot(track.back().x_m - x_m(), track.back().y_m - y_m()) < kTrackSpacing) {
    return;
  }
  track.push_back({x_m(), y_m()});
  if (track.size() > kMaxTrack) track.pop_front();
}

api::RobotJson describe(const Robot& robot, MonotonicTime now) {
  api::RobotJson json;
  json.id = robot.id;
  json.site = robot.site->info().name;
  json.link = describe_link(robot, now);
  json.drive = name_of(proto::DriveState::idle);
  json.localization = name_of(proto::Localization::localized);
  if (!robot.pose) return json;
  const proto::PoseReport& pose = *robot.pose;
  json.x_m = robot.x_m();
  json.y_m = robot.y_m();
  json.z_m = pose.T_site_robot.z_mm / 1000.0;
  json.yaw_rad = pose.T_site_robot.yaw_1e4rad * 1e-4;
  json.roll_rad = pose.roll_1e4rad * 1e-4;
  json.pitch_rad = pose.pitch_1e4rad * 1e-4;
  json.sigma_m = pose.sigma_mm / 1000.0;
  json.speed_m_s = pose.speed_mm_s / 1000.0;
  json.pose_age_s = to_seconds(now - robot.pose_received);
  json.drive = name_of(pose.drive);
  json.localization = name_of(pose.localization);
  return json;
}

}  // namespace cairn::server
