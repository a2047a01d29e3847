#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/graph/submap_graph.h"

namespace cairn {
namespace {

/// [0 … 1] How much of `a` lies on `b`, the mean over where it may be: the believed place and one
/// sigma off, either way along both main axes.
double expected_overlap(const Footprint& a, const Footprint& b, const LevelPose& T_b_a,
                        const Eigen::Matrix4d& covariance_at_middle) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(
      covariance_at_middle.topLeftCorner<2, 2>());
  double sum = 2.0 * a.overlap_on(b, T_b_a);
  for (int axis = 0; axis < 2; ++axis) {
    const double sigma_m = std::sqrt(std::max(eigen.eigenvalues()[axis], 0.0));
    for (const double way : {-sigma_m, sigma_m}) {
      LevelPose off = T_b_a;
      off.x_m += way * eigen.eigenvectors()(0, axis);
      off.y_m += way * eigen.eigenvectors()(1, axis);
      sum += a.overlap_on(b, off);
    }
  }
  return sum / 6.0;
}

}  // namespace

Ties SubmapGraph::ties() const {
  Ties ties(nodes_.size());
  for (const Edge& edge : edges_) {
    if (edge.status != EdgeStatus::accepted || !edge.laid) continue;
    const GraphConstraint& c = edge.constraint;
    ties.add({c.from, c.to, covariance_of(c.information)});
  }
  return ties;
}

bool SubmapGraph::worth_a_try(std::size_t from, std::size_t to, double sigma_m) const {
  const Pair pair = std::minmax(from, to);
  if (matched_.contains(pair)) return false;
  const auto tried = tried_.find(pair);
  if (tried == tried_.end()) return tried_.size() < kMaxTriedPairs;
  return tried->second.count < config_.max_tries && sigma_m < 0.5 * tried->second.sigma_m;
}

std::vector<SubmapGraph::Candidate> SubmapGraph::candidates_of(std::size_t from,
                                                               const Ties& ties) const {
  const LoopMatchConfig& match = config_.match;
  const Footprint& mine = nodes_[from].footprint;
  std::vector<Candidate> candidates;
  const double limit_m = 2.0 * std::hypot(match.max_reach_m, 5.0 * match.max_yaw_rad);
  for (const Relation& relation : ties.from(from, places(), limit_m)) {
    const Footprint& theirs = nodes_[relation.node].footprint;
    if (relation.node == from || theirs.empty()) continue;
    const Eigen::Matrix4d covariance =
        covariance_at(theirs.middle_m(), relation.T_from_node, relation.covariance);
    const PlaceSigma sigma = sigma_of(covariance);
    if (sigma.m > match.max_reach_m / 1.5 || sigma.rad > match.max_yaw_rad / 1.5) continue;
    if (sigma.m < config_.tied_m && sigma.rad < config_.tied_rad) continue;
    if (!worth_a_try(from, relation.node, sigma.m)) continue;
    const double overlap = expected_overlap(theirs, mine, relation.T_from_node, covariance);
    if (overlap < match.min_overlap) continue;
    candidates.push_back({relation.node, relation, sigma.m, overlap / (1.0 + sigma.m)});
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
    return a.promise != b.promise ? a.promise > b.promise : a.to < b.to;
  });
  if (candidates.size() > config_.max_candidates) candidates.resize(config_.max_candidates);
  return candidates;
}

bool SubmapGraph::try_candidate(std::size_t from, const Candidate& candidate) {
  const Node& to = nodes_[candidate.to];
  Try& tried = tried_[std::minmax(from, candidate.to)];
  ++tried.count;
  tried.sigma_m = candidate.sigma_m;
  const LoopMatch match =
      match_loop(*to.surface, to.footprint.middle_m(), *nodes_[from].surface,
                 candidate.from_to.T_from_node, candidate.from_to.covariance, config_.match);
  if (!match.accepted || edges_.size() >= kMaxEdges) return false;
  add_edge({EdgeKind::loop,
            EdgeStatus::held_back,
            {from, candidate.to, match.T_from_to, match.information, true},
            false});
  return true;
}

LoopSearch SubmapGraph::find_loops(int max_registrations) {
  LoopSearch search;
  const Ties known = ties();
  while (!to_search_.empty() && search.accepted == 0) {
    const std::size_t node = to_search_.front();
    for (const Candidate& candidate : candidates_of(node, known)) {
      if (search.registrations >= max_registrations) return search;
      ++search.registrations;
      search.matched += try_candidate(node, candidate) ? 1 : 0;
    }
    to_search_.pop_front();
    waits_[node] = false;
    search.accepted += confirm();
  }
  search.done = to_search_.empty();
  return search;
}

int SubmapGraph::confirm() {
  const Ties known = ties();
  std::vector<std::size_t> good;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    if (edges_[i].status == EdgeStatus::held_back && confirmed(edges_[i], known)) good.push_back(i);
  }
  for (const std::size_t i : good) edges_[i].status = EdgeStatus::accepted;
  return static_cast<int>(good.size());
}

bool SubmapGraph::confirmed(const Edge& loop, const Ties& known) const {
  constexpr double kFarM = 1000.0;
  const GraphConstraint& c = loop.constraint;
  const std::vector<Relation> by_from = known.from(c.from, places(), kFarM);
  const auto end = std::find_if(by_from.begin(), by_from.end(),
                                [&](const Relation& r) { return r.node == c.to; });
  if (end == by_from.end()) return false;
  const Eigen::Vector4d off = difference(c.T_from_to, end->T_from_node);
  const Eigen::Matrix4d information = blurred(c.information, end->covariance);
  if (off.dot(information * off) > config_.consistent) return false;
  const PlaceSigma sigma =
      sigma_of(covariance_at(nodes_[c.to].footprint.middle_m(), end->T_from_node, end->covariance));
  if (sigma.m < config_.self_evident_m && sigma.rad < config_.self_evident_rad) return true;

  std::unordered_map<std::size_t, const Relation*> near_from;
  for (const Relation& r : by_from) near_from[r.node] = &r;
  std::unordered_map<std::size_t, const Relation*> near_to;
  const std::vector<Relation> by_to = known.from(c.to, places(), kFarM);
  for (const Relation& r : by_to) near_to[r.node] = &r;
  const double bold_m = spread_m(end->covariance);
  for (const Edge& other : edges_) {
    if (&other == &loop || other.kind != EdgeKind::loop) continue;
    if (other.status == EdgeStatus::switched_off) continue;
    for (const bool turned : {false, true}) {
      const std::size_t a = turned ? other.constraint.to : other.constraint.from;
      const std::size_t b = turned ? other.constraint.from : other.constraint.to;
      if (b == c.to || !near_from.contains(a) || !near_to.contains(b)) continue;
      if (agree(loop, other, *near_from.at(a), *near_to.at(b), bold_m)) return true;
    }
  }
  return false;
}

/// Whether the ring loop → at_to → other → at_from closes, and would not close by itself.
bool SubmapGraph::agree(const Edge& loop, const Edge& other, const Relation& at_from,
                        const Relation& at_to, double bold_m) const {
  const GraphConstraint& c = loop.constraint;
  const GraphConstraint& o = other.constraint;
  const bool turned = at_from.node != o.from;
  const LevelPose T_other = turned ? inverse(o.T_from_to) : o.T_from_to;
  const Eigen::Matrix4d own = covariance_of(o.information);
  const Eigen::Matrix4d cov_other = turned ? inverted(o.T_from_to, own) : own;
  // from → a → b → to, against the loop's from → to.
  const LevelPose T_from_b = at_from.T_from_node * T_other;
  const Eigen::Matrix4d cov_from_b =
      compounded(at_from.T_from_node, at_from.covariance, T_other, cov_other);
  const LevelPose T_b_to = inverse(at_to.T_from_node);
  const Eigen::Matrix4d cov_b_to = inverted(at_to.T_from_node, at_to.covariance);
  const Eigen::Matrix4d around = compounded(T_from_b, cov_from_b, T_b_to, cov_b_to);
  if (spread_m(around) > 0.5 * bold_m) return false;
  const Eigen::Vector4d off = difference(c.T_from_to, T_from_b * T_b_to);
  return off.dot(blurred(c.information, around) * off) <= config_.consistent;
}

}  // namespace cairn
