#include "robot_agent/drive/field_watch.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cairn::agent {

namespace {

/// [m] The way ahead is looked at this often.
constexpr double kLookEveryM = 2.0;
/// [m] Shorter moves tell no direction.
constexpr double kLeastMoveM = 0.05;

std::int32_t to_mm(double m) { return static_cast<std::int32_t>(std::lround(m * 1000.0)); }

/// Every kLookEveryM of a way, its beginning included, for kAheadM.
std::vector<Eigen::Vector2d> looks_along(const std::vector<Eigen::Vector2d>& way_m) {
  std::vector<Eigen::Vector2d> places_m;
  double next_m = 0.0;
  double begin_m = 0.0;
  for (std::size_t i = 1; i < way_m.size() && next_m <= FieldWatch::kAheadM; ++i) {
    const Eigen::Vector2d leg = way_m[i] - way_m[i - 1];
    const double leg_m = leg.norm();
    for (; next_m < begin_m + leg_m && next_m <= FieldWatch::kAheadM; next_m += kLookEveryM) {
      places_m.push_back(way_m[i - 1] + leg * ((next_m - begin_m) / leg_m));
    }
    begin_m += leg_m;
  }
  return places_m;
}

}  // namespace

void FieldWatch::begin(const proto::Command& command, OrderedPath path) {
  if (command.id != command_) plan_asked_at_.reset();
  command_ = command.id;
  revision_ = command.revision;
  corridor_ = CorridorMap(command, std::move(path));
  last_m_.reset();
  against_m_ = 0.0;
  asked_at_.reset();
  asked_ = 0;
  request_.reset();
}

void FieldWatch::take(const proto::CorridorPart& corridor, int cell_size_mm) {
  (void)corridor_.take(corridor, cell_size_mm);
}

std::uint8_t FieldWatch::direction_at(const Eigen::Vector2d& place_m, int cell_size_mm) const {
  const double cell_m = cell_size_mm / 1000.0;
  return corridor_.direction({static_cast<std::int32_t>(std::floor(place_m.x() / cell_m)),
                              static_cast<std::int32_t>(std::floor(place_m.y() / cell_m))});
}

void FieldWatch::look(const std::vector<Eigen::Vector2d>& ahead_m, int cell_size_mm,
                      MonotonicTime clock) {
  if (corridor_.empty()) return;  // It is on its way, or the server has none.
  if (drives_against(ahead_m.front(), cell_size_mm) &&
      (!plan_asked_at_ || clock - *plan_asked_at_ >= kPlanPeriod)) {
    plan_asked_at_ = clock;
    ask(proto::CorridorWish::plan, ahead_m.front(), kUsualHalfWidth, clock);
    return;
  }
  if (asked_at_ && clock - *asked_at_ < kAskPeriod) return;
  const auto places_m = looks_along(ahead_m);
  const auto bare = std::ranges::find_if(places_m, [&](const Eigen::Vector2d& place_m) {
    return direction_at(place_m, cell_size_mm) == Corridor::outside;
  });
  if (bare != places_m.end()) ask(proto::CorridorWish::corridor, *bare, kUsualHalfWidth, clock);
}

bool FieldWatch::drives_against(const Eigen::Vector2d& place_m, int cell_size_mm) {
  if (!last_m_) last_m_ = place_m;
  const Eigen::Vector2d driven = place_m - *last_m_;
  if (driven.norm() < kLeastMoveM) return false;
  const std::uint8_t direction = direction_at(place_m, cell_size_mm);
  last_m_ = place_m;
  if (direction >= Corridor::at_goal) return false;
  const bool against = driven.dot(Eigen::Vector2d(kStepX[direction], kStepY[direction])) <= 0.0;
  against_m_ = against ? against_m_ + driven.norm() : 0.0;
  return against_m_ >= kAgainstM;
}

void FieldWatch::closed_in(const Eigen::Vector2d& place_m, MonotonicTime clock) {
  last_m_.reset();
  if (asked_at_ && clock - *asked_at_ < kAskPeriod) return;
  ask(proto::CorridorWish::corridor, place_m, kWideHalfWidth, clock);
}

void FieldWatch::ask(proto::CorridorWish wish, const Eigen::Vector2d& place_m,
                     std::uint8_t half_width, MonotonicTime clock) {
  if (asked_ >= kMostAsked) return;
  ++asked_;
  asked_at_ = clock;
  against_m_ = 0.0;
  request_ = {.command = command_,
              .revision = revision_,
              .x_mm = to_mm(place_m.x()),
              .y_mm = to_mm(place_m.y()),
              .half_width = half_width,
              .wish = wish};
}

std::optional<proto::CorridorRequest> FieldWatch::take_request() {
  return std::exchange(request_, {});
}

}  // namespace cairn::agent
