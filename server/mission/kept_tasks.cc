#include "server/mission/kept_tasks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/common/angle.h"
#include "proto/codec/bytes.h"
#include "proto/codec/text.h"

namespace cairn::server {

namespace {

using proto::ByteReader;
using proto::ByteWriter;

constexpr std::uint8_t kVersion = 1;
/// One more than may be asked for at once: the first place and those after it.
constexpr std::uint16_t kMostWaypoints = 257;

std::int32_t to_mm(double m) {
  return static_cast<std::int32_t>(std::clamp<double>(
      std::round(m * 1000.0), -proto::kMaxCoordinateMm, proto::kMaxCoordinateMm));
}

void put_place(ByteWriter& out, const Eigen::Vector2d& place_m) {
  out.put(to_mm(place_m.x()));
  out.put(to_mm(place_m.y()));
}

Eigen::Vector2d get_place(ByteReader& in) {
  const double x_m = in.get<std::int32_t>() / 1000.0;
  return {x_m, in.get<std::int32_t>() / 1000.0};
}

void put_text(ByteWriter& out, const std::string& text) {
  const std::string cut = proto::wire_text(text);
  out.put(static_cast<std::uint8_t>(cut.size()));
  out.put_bytes({reinterpret_cast<const std::uint8_t*>(cut.data()), cut.size()});
}

std::string get_text(ByteReader& in) {
  const auto bytes = in.take(in.get<std::uint8_t>());
  return {bytes.begin(), bytes.end()};
}

/// A value of an enumeration whose last is given.
template <class E>
E get_one_of(ByteReader& in, E last) {
  const auto value = in.get<std::uint8_t>();
  if (value > static_cast<std::uint8_t>(last)) in.fail();
  return static_cast<E>(value);
}

void put_waypoints(ByteWriter& out, const Task& task) {
  out.put(static_cast<std::uint16_t>(task.waypoints.size()));
  for (const Waypoint& waypoint : task.waypoints) {
    put_place(out, waypoint.place_m);
    out.put(static_cast<std::uint8_t>(waypoint.heading_rad ? 1 : 0));
    if (!waypoint.heading_rad) continue;
    out.put(static_cast<std::int16_t>(std::lround(wrap_angle(*waypoint.heading_rad) * 1e4)));
  }
}

void get_waypoints(ByteReader& in, Task& task) {
  const auto count = in.get<std::uint16_t>();
  if (count > kMostWaypoints) in.fail();
  for (std::uint16_t i = 0; i < count && !in.failed(); ++i) {
    Waypoint waypoint{get_place(in), {}};
    if (in.get<std::uint8_t>() != 0) waypoint.heading_rad = in.get<std::int16_t>() * 1e-4;
    task.waypoints.push_back(waypoint);
  }
}

void put_task(ByteWriter& out, const Task& task, const ClockPair& clocks, bool with_avoided) {
  out.put(task.id);
  out.put(static_cast<std::uint8_t>(task.kind));
  out.put(static_cast<std::uint8_t>(task.state));
  put_text(out, task.why);
  put_waypoints(out, task);
  out.put(static_cast<std::uint8_t>(task.loop ? 1 : 0));
  out.put(static_cast<std::uint8_t>(task.area ? 1 : 0));
  if (task.area) {
    put_place(out, {task.area->west_m, task.area->south_m});
    put_place(out, {task.area->east_m, task.area->north_m});
  }
  out.put(static_cast<std::uint8_t>(task.planner.unknown));
  out.put(static_cast<std::uint8_t>(task.allow_partial ? 1 : 0));
  out.put(static_cast<std::uint8_t>(task.on_link_loss));
  const Duration left = task.expires - clocks.monotonic;
  out.put(clocks.unix_ms + std::chrono::duration_cast<std::chrono::milliseconds>(left).count());
  out.put(static_cast<std::uint16_t>(task.next));
  out.put(task.legs);
  out.put(task.rounds);
  out.put(static_cast<std::uint8_t>(task.failures));
  out.put(static_cast<std::uint16_t>(with_avoided ? task.avoided_m.size() : 0));
  if (!with_avoided) return;
  for (const Eigen::Vector2d& place_m : task.avoided_m) put_place(out, place_m);
}

/// [ms] Longer than any task lives; a file's clock must not overflow ours.
constexpr std::int64_t kLongestMs = std::int64_t{1000} * 60 * 60 * 24 * 3650;

Task get_task(ByteReader& in, const ClockPair& clocks, const PlannerConfig& planner) {
  Task task;
  task.planner = planner;
  task.id = in.get<std::uint64_t>();
  task.kind = get_one_of(in, TaskKind::go_home);
  task.state = get_one_of(in, TaskState::expired);
  task.why = get_text(in);
  get_waypoints(in, task);
  task.loop = in.get<std::uint8_t>() != 0;
  if (in.get<std::uint8_t>() != 0) {
    const Eigen::Vector2d low_m = get_place(in);
    const Eigen::Vector2d high_m = get_place(in);
    task.area = AreaM{low_m.x(), low_m.y(), high_m.x(), high_m.y()};
  }
  task.planner.unknown = get_one_of(in, UnknownGround::explore);
  task.allow_partial = in.get<std::uint8_t>() != 0;
  task.on_link_loss = get_one_of(in, proto::OnLinkLoss::retrace);
  const std::int64_t expires_ms = in.get<std::int64_t>();
  const bool far_off = expires_ms > clocks.unix_ms + kLongestMs || expires_ms < 0;
  task.expires =
      clocks.monotonic +
      std::chrono::milliseconds(far_off ? 0 : std::max(expires_ms - clocks.unix_ms, -kLongestMs));
  task.next = in.get<std::uint16_t>();
  if (task.kind != TaskKind::explore &&
      task.next >= std::max<std::size_t>(task.waypoints.size(), 1) +
                       (task.state == TaskState::active ? 0 : 1)) {
    in.fail();
  }
  if (task.kind != TaskKind::explore && task.waypoints.empty()) in.fail();
  task.legs = in.get<std::uint64_t>();
  task.rounds = in.get<std::uint64_t>();
  task.failures = in.get<std::uint8_t>();
  const auto avoided = in.get<std::uint16_t>();
  if (avoided > Task::kMaxAvoided) in.fail();
  for (std::uint16_t i = 0; i < avoided && !in.failed(); ++i) task.avoid(get_place(in));
  return task;
}

}  // namespace

std::string encode(const KeptDuty& duty, const ClockPair& clocks) {
  std::vector<std::uint8_t> bytes;
  ByteWriter out(bytes);
  out.put(kVersion);
  out.put(duty.newest_task);
  out.put(duty.boot);
  put_place(out, duty.home_m);
  out.put(static_cast<std::uint8_t>(duty.tasks.last() ? 1 : 0));
  if (duty.tasks.last()) put_task(out, *duty.tasks.last(), clocks, false);
  out.put(static_cast<std::uint8_t>(duty.tasks.all().size()));
  bool first = true;
  for (const Task& task : duty.tasks.all()) {
    put_task(out, task, clocks, std::exchange(first, false));
  }
  return {bytes.begin(), bytes.end()};
}

Result<KeptDuty> decode_duty(const std::string& bytes, const ClockPair& clocks,
                             const PlannerConfig& planner) {
  ByteReader in({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  const auto version = in.get<std::uint8_t>();
  if (version > kVersion) {
    return Error{ErrorCode::unsupported_version, "tasks were kept by a newer Cairn: update it"};
  }
  KeptDuty duty;
  duty.newest_task = in.get<std::uint64_t>();
  duty.boot = in.get<std::uint64_t>();
  duty.home_m = get_place(in);
  std::optional<Task> last;
  if (in.get<std::uint8_t>() != 0) last = get_task(in, clocks, planner);
  const auto count = in.get<std::uint8_t>();
  if (count > 1 + TaskQueue::kMaxWaiting) in.fail();
  std::deque<Task> tasks;
  for (std::uint8_t i = 0; i < count && !in.failed(); ++i) {
    tasks.push_back(get_task(in, clocks, planner));
  }
  if (version == 0 || in.failed() || in.left() > 0) {
    return Error{ErrorCode::corrupt, "these bytes are no tasks"};
  }
  duty.tasks = TaskQueue(std::move(tasks), std::move(last));
  return duty;
}

}  // namespace cairn::server
