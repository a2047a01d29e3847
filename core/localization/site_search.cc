#include "core/localization/site_search.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/common/angle.h"
#include "core/localization/problem.h"
#include "core/localization/site_places.h"
#include "core/localization/site_points.h"
#include "core/localization/site_pyramid.h"

namespace cairn {

struct SiteSearch::Prepared {
  HeightMap long_term;
  SiteSearchConfig config;
  std::optional<SiteGround> ground;
  std::optional<SitePyramid> pyramid;
  std::string why;  ///< Why there is no ground.
};

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string unusable(const HeightMap& short_term, const Pose& T_submap_robot,
                     const std::optional<SiteDisc>& disc) {
  if (!is_finite(T_submap_robot)) return "the robot's pose in its map is not finite";
  if (disc && !(std::isfinite(disc->x_m) && std::isfinite(disc->y_m) && disc->radius_m >= 0.0)) {
    return "the disc to search is not finite";
  }
  const double far_m = std::max(
      {std::abs(T_submap_robot.x_m), std::abs(T_submap_robot.y_m), std::abs(T_submap_robot.z_m)});
  if (far_m > kMaxRegistrationCells * short_term.cell_size_m()) {
    return "the robot lies far from its map's origin";
  }
  return {};
}

/// The places that may be the robot's: the one that scores best and those that hardly score worse.
struct Possible {
  std::vector<Place> places;     ///< Centred, the best first; its sum is the least.
  double bound_mm = 0.0;         ///< What the best scored before it was centred,
  double second_bound_mm = 0.0;  ///< and the next.
};

Possible possible_places(SitePlaces& search, const SiteSearchConfig& config) {
  Possible found;
  std::vector<Place> taken;
  double limit_mm = config.max_score_mm;
  while (found.places.size() < config.max_places) {
    const std::optional<Place> place = search.next(limit_mm, taken);
    if (!place) break;
    if (found.places.empty()) {
      found.bound_mm = search.score_mm(*place);
      limit_mm = found.bound_mm + config.min_lead_mm;
      found.second_bound_mm = limit_mm;
    } else if (found.places.size() == 1) {
      found.second_bound_mm = search.score_mm(*place);
    }
    found.places.push_back(search.centred(*place));
    taken.insert(taken.end(), {*place, found.places.back()});
  }
  std::stable_sort(found.places.begin(), found.places.end(),
                   [](const Place& a, const Place& b) { return a.sum < b.sum; });
  return found;
}

/// The best that is another place than the first; none: infinity.
double second_mm(const SitePlaces& search, const std::vector<Place>& places) {
  for (const Place& place : places) {
    if (!search.same(place, places.front())) return search.score_mm(place);
  }
  return kInfinity;
}

PlaceSearch place_search(const SiteSearchConfig& config, const std::optional<SiteDisc>& disc) {
  return {.yaw_step_rad = config.yaw_step_rad,
          .far_sigma = config.far_sigma,
          .limit_mm = config.max_score_mm + config.min_lead_mm,
          .max_bounds = config.max_bounds,
          .disc = disc};
}

/// The best place of all, and what speaks for it.
std::optional<Place> best_place(SitePlaces& search, const SiteSearchConfig& config,
                                SiteMatch& match) {
  const Possible found = possible_places(search, config);
  match.bounds = search.bounds();
  match.places = found.places.size();
  if (found.places.empty()) return std::nullopt;
  const Place& best = found.places.front();
  match.bound_mm = found.bound_mm;
  match.second_bound_mm = found.second_bound_mm;
  match.score_mm = search.score_mm(best);
  match.second_best_mm = second_mm(search, found.places);
  match.unknown = search.unknown_share(best);
  match.blocked = search.blocked_share(best);
  return best;
}

/// Where the robot would be, for the last step.
RegistrationPrior prior_at(const Place& place, const SiteGround& ground, double cell_m,
                           const Pose& T_submap_robot) {
  constexpr double kSigmaM = 0.3;
  constexpr double kSigmaRad = 0.05;
  const FloorSpan& floor = ground.floor.at(place.x, place.y);
  const double floor_mm = ground.datum_mm + 0.5 * (floor.lowest + floor.highest) * ground.unit_mm;
  RegistrationPrior prior;
  prior.T_submap_robot = T_submap_robot;
  prior.T_site_submap = submap_pose(prior, {(ground.lowest.x + place.x + 0.5) * cell_m,
                                            (ground.lowest.y + place.y + 0.5) * cell_m,
                                            floor_mm / 1000.0, wrap_angle(place.yaw_rad)});
  prior.covariance = Eigen::Vector4d(kSigmaM * kSigmaM, kSigmaM * kSigmaM, kSigmaM * kSigmaM,
                                     kSigmaRad * kSigmaRad)
                         .asDiagonal();
  return prior;
}

/// Cell by cell around the place, then within the cell.
Registration registered(const HeightMap& short_term, const RegistrationPrior& prior,
                        const HeightMap& long_term, RegistrationConfig config) {
  config.mode = RegistrationMode::cairn;
  config.window = {.reach_m = 0.25, .yaw_rad = 0.026, .yaw_step_rad = 8.7e-3};
  config.widen = false;
  config.max_innovation = kInfinity;  // The place is only where it begins.
  return register_map(short_term, prior, long_term, config);
}

/// Why the best place is not believed; empty when it is.
std::string objection(const SiteMatch& match, bool all_seen, const SiteSearchConfig& config) {
  if (!all_seen || match.places == config.max_places) return "too many places look alike";
  if (match.second_best_mm * (1.0 - config.min_distinctness) <= match.score_mm ||
      match.second_bound_mm < match.bound_mm + config.min_gap_mm) {
    return "another place matches as well";
  }
  if (match.unknown > config.max_unknown) return "too little of the place is known";
  if (match.blocked > config.max_blocked) return "what was seen cannot be seen from there";
  return match.registration.accepted ? "" : match.registration.why;
}

}  // namespace

SiteSearch::SiteSearch(const HeightMap& long_term, const SiteSearchConfig& config,
                       const std::optional<SiteDisc>& disc) {
  assert(config.faces + config.flats <= static_cast<int>(SitePyramid::kMostTopPoints));
  auto prepared = std::make_unique<Prepared>(Prepared{long_term, config, {}, {}, {}});
  const int margin = static_cast<int>(std::ceil(config.reach_m / long_term.cell_size_m())) + 2;
  prepared->ground = read_site_ground(long_term, margin, disc, config.ground, prepared->why);
  if (prepared->ground) prepared->pyramid.emplace(*prepared->ground);
  prepared_ = std::move(prepared);
}

SiteSearch::~SiteSearch() = default;
SiteSearch::SiteSearch(SiteSearch&&) noexcept = default;
SiteSearch& SiteSearch::operator=(SiteSearch&&) noexcept = default;

SiteMatch SiteSearch::find(const HeightMap& short_term, const Pose& T_submap_robot,
                           const std::optional<SiteDisc>& disc) const {
  const SiteSearchConfig& config = prepared_->config;
  assert(short_term.cell_size_mm() == prepared_->long_term.cell_size_mm());
  SiteMatch match;
  match.why = prepared_->ground ? unusable(short_term, T_submap_robot, disc) : prepared_->why;
  if (!match.why.empty()) return match;
  const std::vector<ShownCell> cells =
      shown_cells(short_term, T_submap_robot, config.reach_m, config.faces, config.flats);
  if (cells.size() < static_cast<std::size_t>(config.min_cells)) {
    match.why = "the short-term map shows too little";
    return match;
  }
  const double cell_m = short_term.cell_size_m();
  SitePlaces search(*prepared_->ground, *prepared_->pyramid, cell_m, cells,
                    place_search(config, disc));
  const std::optional<Place> best = best_place(search, config, match);
  if (!best) {
    match.why =
        search.exhausted() ? "too many places look alike" : "it looks like no place of the map";
    return match;
  }
  match.registration =
      registered(short_term, prior_at(*best, *prepared_->ground, cell_m, T_submap_robot),
                 prepared_->long_term, config.registration);
  match.T_site_robot = match.registration.T_site_robot;
  match.covariance = match.registration.covariance;
  match.why = objection(match, !search.exhausted(), config);
  match.accepted = match.why.empty();
  return match;
}

}  // namespace cairn
