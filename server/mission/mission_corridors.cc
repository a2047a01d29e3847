#include <spdlog/spdlog.h>

#include <boost/asio/post.hpp>
#include <utility>

#include "server/mission/corridors.h"
#include "server/mission/mission.h"

/// The part of Mission that gives robots the field around their way.
namespace cairn::server {

namespace asio = boost::asio;

void Mission::asked(Robot& robot, const proto::CorridorRequest& request) {
  const auto found = goals_.find(robot.id);
  if (found == goals_.end()) return;
  Goal& goal = found->second;
  const bool present =
      goal.command.id == request.command && goal.command.revision == request.revision;
  if (!present || !goal.active()) return;  // Of an older path; the robot asks anew if it must.
  spdlog::info("robot {}: command {}: asks for {} at {:.1f}, {:.1f}", robot.id, request.command,
               request.wish == proto::CorridorWish::plan ? "a new plan" : "more of its field",
               request.x_mm / 1000.0, request.y_mm / 1000.0);
  const bool map_changed = robot.site->snapshot()->version != goal.command.map_version;
  if (request.wish == proto::CorridorWish::plan && map_changed) {
    goal.wants_plan = true;
    return;
  }
  if (goal.corridor_busy || Hub::now() < goal.next_corridor) return;
  offer_corridor(robot, goal, request);
}

void Mission::offer_corridor(const Robot& robot, Goal& goal,
                             const std::optional<proto::CorridorRequest>& request) {
  if (goal.command.kind != proto::CommandKind::go_to || goal.path_m.empty()) return;
  goal.corridor_busy = true;
  goal.next_corridor = Hub::now() + kCorridorPeriod;
  PlanTarget target = target_of(robot, goal);
  target.request.allow_partial = false;
  CorridorNeed need{goal.command.id, goal.command.revision, target.map->version, kOrderHalfWidth,
                    kOrderStretches};
  if (request) {
    target.request.start_m = {request->x_mm / 1000.0, request->y_mm / 1000.0};
    need.half_width = request->half_width;
    need.stretches = 1;
  }
  asio::post(executor_, [self = shared_from_this(), target = std::move(target),
                         path_m = goal.path_m, need, asked = request.has_value(), id = robot.id] {
    std::vector<proto::CorridorPart> parts;
    const CodedPath path = to_wire(path_m, target.map->cell_size_mm).path;
    // Without a field there is no corridor: the robot drives by its path.
    (void)self->fields_.with(target, [&](const KeptField& field) {
      parts =
          asked ? corridor_from(path, target, field, need) : corridor_along(path, 0, field, need);
    });
    asio::post(self->strand_, [self, id, command = need.command, parts = std::move(parts)] {
      self->corridor_made(id, command, parts);
    });
  });
}

void Mission::corridor_made(const std::string& id, std::uint64_t command,
                            std::vector<proto::CorridorPart> parts) {
  const auto found = goals_.find(id);
  Robot* robot = hub_->find(id);
  if (found == goals_.end() || robot == nullptr || found->second.command.id != command) return;
  Goal& goal = found->second;
  goal.corridor_busy = false;
  std::erase_if(parts, [&](const proto::CorridorPart& part) {
    return part.revision != goal.command.revision;
  });
  if (goal.active()) hub_->corridor(*robot, std::move(parts));
}

}  // namespace cairn::server
