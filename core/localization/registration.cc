#include "core/localization/registration.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/common/angle.h"
#include "core/localization/problem.h"
#include "core/localization/wide_search.h"

namespace cairn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Basins that are looked at when the best is not alone.
constexpr std::size_t kMaxBasins = 32;
/// Of these so many are refined.
constexpr std::size_t kMostRefined = 6;
/// Candidates this near to each other are one place.
constexpr int kBasinCells = 3;
constexpr double kBasinRad = 0.05;

bool is_covariance(const Eigen::Matrix4d& matrix) {
  constexpr double kRounding = 1e-9;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(matrix, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().minCoeff() >= -kRounding;
}

std::string unusable(const HeightMap& short_term, const RegistrationPrior& prior) {
  if (!is_finite(prior.T_site_submap) || !is_finite(prior.T_submap_robot) ||
      !prior.covariance.allFinite()) {
    return "the prior is not finite";
  }
  if (!is_covariance(prior.covariance)) return "the prior's covariance is none";
  const double far_m =
      std::max({std::abs(prior.T_site_submap.x_m), std::abs(prior.T_site_submap.y_m),
                std::abs(prior.T_site_submap.z_m)});
  if (far_m > 0.9 * HeightMap::kMaxExtentM) return "the prior lies beyond 90 km";
  const auto box = known_box(short_term);
  if (!box) return "the short-term map is empty";
  const std::int64_t width = std::int64_t{box->highest.x} - box->lowest.x + 1;
  const std::int64_t height = std::int64_t{box->highest.y} - box->lowest.y + 1;
  if (std::max(width, height) > kMaxRegistrationCells) return "the short-term map is too large";
  const double robot_m = std::hypot(prior.T_submap_robot.x_m, prior.T_submap_robot.y_m);
  const double reach_m = kMaxRegistrationCells * short_term.cell_size_m();
  const bool box_near = std::abs(box->lowest.x) < kMaxRegistrationCells &&
                        std::abs(box->lowest.y) < kMaxRegistrationCells;
  if (robot_m > reach_m || !box_near) return "the short-term map lies far from its origin or robot";
  return {};
}

/// No prior is surer than the floor; the inverse exists.
Eigen::Matrix4d floored(const Eigen::Matrix4d& covariance, const RegistrationConfig& config) {
  Eigen::Vector4d floor;
  floor << config.prior_floor_m, config.prior_floor_m, config.prior_floor_m, config.prior_floor_rad;
  return 0.5 * (covariance + covariance.transpose()) +
         Eigen::Matrix4d(floor.cwiseProduct(floor).asDiagonal());
}

RobotPlace difference(const RobotPlace& a, const RobotPlace& b) {
  RobotPlace d = a - b;
  d[3] = wrap_angle(d[3]);
  return d;
}

Registration refused(const RegistrationPrior& prior, const std::string& why) {
  Registration answer;
  answer.T_site_submap = prior.T_site_submap;
  answer.T_site_robot = robot_pose(prior, prior.T_site_submap);
  answer.best_cell = prior.T_site_submap;
  answer.covariance = prior.covariance;
  answer.why = why;
  return answer;
}

/// One registration's way from problem to answer.
class Registering {
 public:
  Registering(const HeightMap& short_term, const RegistrationPrior& prior,
              const HeightMap& long_term, const RegistrationConfig& config)
      : short_term_(short_term),
        long_term_(long_term),
        prior_(prior),
        config_(config),
        prior_covariance_(floored(prior.covariance, config)) {}

  Registration narrow() {
    set_problem(config_.window);
    MatchVolume volume = search_all(problem_, fastest_kernels());
    if (best_at_other_height(volume)) volume = search_all(problem_, fastest_kernels());
    Registration answer = refused("no place in the window overlaps enough");
    const std::vector<Candidate> places = basins(volume, kMaxBasins);
    if (places.empty()) return answer;
    return config_.mode == RegistrationMode::thesis ? by_mean(volume, places)
                                                    : by_refinement(places, false);
  }

  Registration wide() {
    set_problem(config_.wide_window);
    const MatchKernels& kernels = fastest_kernels();
    const WideMatch best = search_wide(problem_, kernels, kInfinity, std::nullopt);
    if (!best.best) return refused("nothing within the wide window overlaps enough");
    std::vector<Candidate> places{*best.best};
    const Excluded basin{*best.best, kBasinCells, basin_turns()};
    const double rival_mm = best.best->score_mm() / (1.0 - config_.min_wide_distinctness);
    if (const auto rival = search_wide(problem_, kernels, rival_mm, basin).best) {
      places.push_back(*rival);
    }
    return by_refinement(places, true);
  }

 private:
  void set_problem(const SearchWindow& window) {
    window_ = window;
    problem_ = make_problem(short_term_, prior_, long_term_, window, config_, 0);
    const auto centre_yaw = problem_.yaw_reach;
    offset_mm_ = median_offset_mm(problem_, {centre_yaw, problem_.reach, problem_.reach, {}});
    if (offset_mm_ != 0) raise_problem();
  }

  /// The ground around the prior lies at another height than at the best match: try from there.
  bool best_at_other_height(const MatchVolume& volume) {
    constexpr int kSameMm = 30;
    const std::vector<Candidate> best = basins(volume, 1);
    if (best.empty()) return false;
    const int more_mm = median_offset_mm(problem_, best.front());
    if (std::abs(more_mm) <= kSameMm) return false;
    offset_mm_ += more_mm;
    raise_problem();
    return true;
  }

  void raise_problem() {
    const double limit_mm = config_.z_window_m * 1000.0;
    offset_mm_ = static_cast<int>(std::clamp<double>(offset_mm_, -limit_mm, limit_mm));
    problem_ = make_problem(short_term_, prior_, long_term_, window_, config_, offset_mm_);
  }

  [[nodiscard]] int basin_turns() const {
    return static_cast<int>(std::ceil(kBasinRad / problem_.yaw_step_rad));
  }

  [[nodiscard]] RobotPlace prior_place() const { return robot_place(prior_); }

  [[nodiscard]] RobotPlace place_of(double yaw, double y, double x) const {
    const double cell_m = long_term_.cell_size_m();
    RobotPlace place = prior_place();
    place[0] += (x - problem_.reach) * cell_m;
    place[1] += (y - problem_.reach) * cell_m;
    place[2] += offset_mm_ / 1000.0;
    place[3] = wrap_angle(place[3] + (yaw - problem_.yaw_reach) * problem_.yaw_step_rad);
    return place;
  }
  [[nodiscard]] RobotPlace place_of(const Candidate& c) const { return place_of(c.yaw, c.y, c.x); }

  [[nodiscard]] double distance2(const RobotPlace& place) const {
    RobotPlace d = place - prior_place();
    d[3] = wrap_angle(d[3]);
    return d.dot(prior_covariance_.ldlt().solve(d));
  }

  [[nodiscard]] bool same_basin(const Candidate& a, const Candidate& b) const {
    return Excluded{a, kBasinCells, basin_turns()}.holds(b.yaw, b.y, b.x);
  }

  /// Best match, and how far the next one that is not the same place lies behind it.
  void note_scores(const std::vector<Candidate>& places, Registration& answer) const {
    answer.score = places.front().score_mm();
    answer.distinctness = 1.0;
    for (const Candidate& other : places) {
      if (same_basin(places.front(), other)) continue;
      answer.second_best = other.score_mm();
      answer.distinctness = 1.0 - answer.score / std::max(answer.second_best, 1e-9);
      return;
    }
  }

  /// Places that are as good as the best, as far as whole cells can tell.
  [[nodiscard]] std::vector<Candidate> rivals(const std::vector<Candidate>& places) const {
    const double limit_mm = places.front().score_mm() / (1.0 - config_.min_distinctness);
    std::vector<Candidate> equals;
    for (const Candidate& place : places) {
      const bool taken = std::any_of(equals.begin(), equals.end(),
                                     [&](const Candidate& c) { return same_basin(c, place); });
      if (!taken && place.score_mm() <= limit_mm) equals.push_back(place);
      if (equals.size() == kMostRefined) break;
    }
    return equals;
  }

  Registration by_mean(const MatchVolume& volume, const std::vector<Candidate>& places) {
    Registration answer = refused("");
    note_scores(places, answer);
    const WeightedMean mean = fourth_power_mean(volume, config_.good_match);
    RobotPlace place = place_of(mean.yaw, mean.y, mean.x);
    const Cell ground = long_term_.cell(long_term_.cell_at(place[0], place[1]));
    if (ground.known()) place[2] = ground.height_mm / 1000.0;
    answer.best_cell = submap_pose(prior_, place_of(places.front()));
    answer.overlap = overlap_share(places.front().sum.overlap);
    answer.covariance = prior_.covariance;
    move_to(place, answer);
    answer.accepted = true;
    return answer;
  }

  Registration by_refinement(const std::vector<Candidate>& places, bool wide) {
    Registration answer = refused("");
    answer.wide = wide;
    note_scores(places, answer);
    answer.best_cell = submap_pose(prior_, place_of(places.front()));
    const std::vector<Refined> found = refined(rivals(places), wide);
    if (found.empty()) return refused("the maps do not overlap where they match best");
    const Candidate start = found.front().start;
    answer.margin = found.size() > 1 ? found[1].chi2 - found.front().chi2 : kInfinity;
    // Beyond the prior's reach one of several places must be the right one; within it, what they
    // have in common is right whichever it is.
    const Refinement match = wide ? found.front().match : common(found);
    answer.misfit = match.misfit;
    answer.discord = match.discord;
    answer.information = match.information;
    answer.covariance = match.covariance;
    answer.overlap = overlap_share(match.overlap);
    answer.comparable = answer.overlap >= config_.min_overlap &&
                        match.overlap >= static_cast<std::size_t>(config_.min_overlap_cells);
    answer.inliers = match.inliers;
    answer.residual_mm = match.residual_mm;
    answer.innovation = innovation(match);
    answer.supports_prior = !wide && answer.comparable && answer.inliers >= config_.min_inliers &&
                            answer.innovation <= config_.prior_supported;
    answer.position_observable = observable(match);
    answer.why = objection(answer, match, start);
    answer.accepted = answer.why.empty();
    if (answer.accepted) {
      move_to(match.place, answer);
      if (!answer.position_observable) answer.why = "x and y are not observable here";
    } else {
      answer.covariance = prior_.covariance;
    }
    return answer;
  }

  /// A place after refinement, and how unlikely it is.
  struct Refined {
    Candidate start;
    Refinement match;
    double chi2 = 0.0;
  };

  /// The best place, without what distinguishes it from others that are nearly as likely: along
  /// the way from one to the other the prior stays.
  [[nodiscard]] Refinement common(const std::vector<Refined>& found) const {
    Refinement match = found.front().match;
    // The information as Aᵀ·A: what is taken away in this form never leaves a negative rest.
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(match.information);
    Eigen::Matrix4d A = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
                        eigen.eigenvectors().transpose();
    bool alone = true;
    for (const Refined& other : found) {
      if (other.chi2 - found.front().chi2 >= config_.min_margin) break;
      const Eigen::Vector4d told = A * difference(other.match.place, match.place);
      constexpr double kToldAlready = 1e-3;  // [-] Sigmas between two places.
      if (told.norm() < kToldAlready) continue;
      A -= told * (told.transpose() * A) / told.squaredNorm();
      alone = false;
    }
    if (alone) return match;
    const Eigen::Matrix4d information = A.transpose() * A;
    match.information = information;
    const Eigen::Matrix4d counted = information / config_.refine.registered_times;
    match.covariance = (counted + prior_covariance_.inverse()).inverse();
    const RobotPlace off = difference(match.place, prior_place());
    match.place = prior_place() + match.covariance * counted * off;
    match.place[3] = wrap_angle(match.place[3]);
    return match;
  }

  /// The most likely one first; what ran into the same place counts once.
  [[nodiscard]] std::vector<Refined> refined(const std::vector<Candidate>& starts,
                                             bool wide) const {
    // A wide search begins where the prior is not trusted any more.
    const Eigen::Matrix4d information =
        (wide ? Eigen::Matrix4d(prior_covariance_ + window_covariance()) : prior_covariance_)
            .inverse();
    const double cell_m = long_term_.cell_size_m();
    const LongTermRelief relief =
        make_relief(problem_.long_term, face_search(cell_m, config_), cell_m);
    const std::vector<ShortTermCell> cells = short_term_cells(problem_.short_term, cell_m, prior_);
    std::vector<Refined> found;
    for (const Candidate& start : starts) {
      const auto match =
          refine(cells, relief, prior_place(), information, place_of(start), config_.refine);
      if (!match) continue;
      found.push_back({start, *match});
    }
    // Compared over equally many cells: to overlap less is no merit.
    double opinions = kInfinity;
    for (const Refined& place : found) opinions = std::min(opinions, place.match.opinions);
    for (Refined& place : found) {
      const RobotPlace off = difference(place.match.place, prior_place());
      place.chi2 = place.match.misfit * opinions + off.dot(information * off);
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const Refined& a, const Refined& b) { return a.chi2 < b.chi2; });
    if (found.size() > 1) {
      const RobotPlace best = found.front().match.place;
      found.erase(
          std::remove_if(found.begin() + 1, found.end(),
                         [&](const Refined& other) { return same_place(best, other.match.place); }),
          found.end());
    }
    return found;
  }

  [[nodiscard]] bool same_place(const RobotPlace& a, const RobotPlace& b) const {
    const RobotPlace d = difference(a, b);
    return d.head<2>().norm() < long_term_.cell_size_m() &&
           std::abs(d[3]) < 2.0 * problem_.yaw_step_rad;
  }

  [[nodiscard]] std::string objection(const Registration& answer, const Refinement& match,
                                      const Candidate& start) const {
    if (!answer.comparable) return "too little overlap";
    if (answer.inliers < config_.min_inliers || answer.residual_mm > config_.max_residual_mm ||
        answer.misfit > config_.max_misfit) {
      return "the heights do not agree";
    }
    const double most = is_small_step(match.place) ? config_.max_discord : config_.max_bold_discord;
    if (answer.discord > most) return "one part of the map contradicts another";
    if (beyond_window(match.place)) return "it is best beyond the window";
    if (!answer.wide && answer.innovation > config_.max_innovation) {
      return "too far from where the robot can be";
    }
    return answer.wide ? wide_objection(answer, start) : "";
  }

  [[nodiscard]] bool is_small_step(const RobotPlace& place) const {
    const RobotPlace off = difference(place, prior_place());
    return off.head<2>().norm() < config_.small_step_m && std::abs(off[3]) < config_.small_step_rad;
  }

  /// The wide search trusts the match more than the prior, so the match must be beyond doubt.
  [[nodiscard]] std::string wide_objection(const Registration& answer,
                                           const Candidate& start) const {
    const int last = problem_.side() - 1;
    const auto at_edge = [](int i, int end) { return i <= 1 || i >= end - 1; };
    if (at_edge(start.x, last) || at_edge(start.y, last)) return "it is best at the window's edge";
    if (!answer.position_observable) return "x and y are not observable here";
    if (answer.margin < config_.min_margin) return "another place matches as well";
    if (answer.distinctness < config_.min_wide_distinctness) return "another place matches as well";
    if (answer.innovation > config_.max_wide_innovation)
      return "too far from where the robot can be";
    return {};
  }

  /// Refinement ran out of what was searched: nothing is known of other places there.
  [[nodiscard]] bool beyond_window(const RobotPlace& place) const {
    constexpr int kMarginCells = 2;
    const RobotPlace off = difference(place, prior_place());
    const double reach_m = (problem_.reach + kMarginCells) * long_term_.cell_size_m();
    const double reach_rad = (problem_.yaw_reach + kMarginCells) * problem_.yaw_step_rad;
    return off.head<2>().cwiseAbs().maxCoeff() > reach_m || std::abs(off[3]) > reach_rad;
  }

  /// How far match and prior disagree, in the directions that the match shows.
  [[nodiscard]] double innovation(const Refinement& match) const {
    RobotPlace d = match.place - prior_place();
    d[3] = wrap_angle(d[3]);
    return d.dot(prior_covariance_.ldlt().solve(d));
  }

  static bool observable(const Refinement& match) {
    constexpr double kKnownM = 0.1;
    const Eigen::Matrix4d covariance =
        (match.information + 1e-6 * Eigen::Matrix4d::Identity()).inverse();
    return std::max(covariance(0, 0), covariance(1, 1)) < kKnownM * kKnownM;
  }

  [[nodiscard]] Eigen::Matrix4d window_covariance() const {
    Eigen::Vector4d sigma;
    sigma << window_.reach_m, window_.reach_m, config_.z_window_m, window_.yaw_rad;
    return Eigen::Matrix4d(sigma.cwiseProduct(sigma).asDiagonal());
  }

  [[nodiscard]] double overlap_share(std::size_t cells) const {
    return static_cast<double>(cells) / static_cast<double>(short_term_.known_count());
  }

  void move_to(const RobotPlace& place, Registration& answer) const {
    answer.T_site_submap = submap_pose(prior_, place);
    answer.T_site_robot = robot_pose(prior_, answer.T_site_submap);
  }

  [[nodiscard]] Registration refused(const std::string& why) const {
    return cairn::refused(prior_, why);
  }

  const HeightMap& short_term_;
  const HeightMap& long_term_;
  const RegistrationPrior& prior_;
  const RegistrationConfig& config_;
  Eigen::Matrix4d prior_covariance_;
  SearchWindow window_;
  MatchProblem problem_;
  int offset_mm_ = 0;
};

}  // namespace

Registration register_map(const HeightMap& short_term, const RegistrationPrior& prior,
                          const HeightMap& long_term, const RegistrationConfig& config) {
  assert(short_term.cell_size_mm() == long_term.cell_size_mm());
  if (std::string why = unusable(short_term, prior); !why.empty()) return refused(prior, why);
  Registering registering(short_term, prior, long_term, config);
  Registration answer = registering.narrow();
  if (answer.accepted || !config.widen || config.mode == RegistrationMode::thesis) return answer;
  Registration wide = registering.wide();
  wide.comparable = wide.comparable || answer.comparable;
  wide.supports_prior = answer.supports_prior;
  if (!wide.accepted) wide.why = answer.why + "; in the wide window: " + wide.why;
  return wide;
}

}  // namespace cairn
