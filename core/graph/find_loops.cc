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

/// [m] Ties that are worse than this tell nothing.
constexpr double kFarM = 1000.0;

std::unordered_map<std::size_t, Relation> by_node(const std::vector<Relation>& relations) {
  std::unordered_map<std::size_t, Relation> found;
  for (const Relation& relation : relations) found.emplace(relation.node, relation);
  return found;
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
  if (nodes_[from].cells < config_.min_cells) return candidates;
  const double limit_m = 2.0 * std::hypot(match.max_reach_m, 5.0 * match.max_yaw_rad);
  for (const Relation& relation : ties.from(from, places(), limit_m)) {
    const Footprint& theirs = nodes_[relation.node].footprint;
    if (relation.node == from || nodes_[relation.node].cells < config_.min_cells) continue;
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
  return candidates;
}

bool SubmapGraph::try_candidate(std::size_t from, const Candidate& candidate) {
  const Node& to = nodes_[candidate.to];
  Try& tried = tried_[std::minmax(from, candidate.to)];
  ++tried.count;
  tried.sigma_m = candidate.sigma_m;
  const Node& with = nodes_[from];
  const LoopMatch match =
      match_loop({*to.surface, to.footprint, to.faces}, {*with.surface, with.footprint, with.faces},
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
    if (tried_here_ == 0) first_new_ = edges_.size();
    std::vector<Candidate> candidates;
    if (tried_here_ < config_.max_candidates) candidates = candidates_of(node, known);
    for (const Candidate& candidate : candidates) {
      if (search.registrations >= max_registrations) return search;
      if (tried_here_++ >= config_.max_candidates) break;
      ++search.registrations;
      search.matched += try_candidate(node, candidate) ? 1 : 0;
    }
    tried_here_ = 0;
    to_search_.pop_front();
    waits_[node] = false;
    search.accepted += confirm(first_new_);
  }
  search.done = to_search_.empty();
  return search;
}

std::vector<std::size_t> SubmapGraph::to_confirm(std::size_t first_new) {
  constexpr std::size_t kOldOnes = 32;
  std::vector<std::size_t> held;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    if (edges_[i].status == EdgeStatus::held_back) held.push_back(i);
  }
  const auto old = std::lower_bound(held.begin(), held.end(), first_new);
  std::vector<std::size_t> chosen(old, held.end());
  held.erase(old, held.end());
  for (std::size_t i = 0; i < std::min(kOldOnes, held.size()); ++i) {
    chosen.push_back(held[next_held_++ % held.size()]);
  }
  return chosen;
}

int SubmapGraph::confirm(std::size_t first_new) {
  const Ties known = ties();
  std::vector<std::size_t> good;
  for (const std::size_t i : to_confirm(first_new)) {
    if (confirmed(edges_[i], known)) good.push_back(i);
  }
  for (const std::size_t i : good) edges_[i].status = EdgeStatus::accepted;
  return static_cast<int>(good.size());
}

bool SubmapGraph::confirmed(const Edge& loop, const Ties& known) const {
  const GraphConstraint& c = loop.constraint;
  const RelationsByNode by_from = by_node(known.from(c.from, places(), kFarM));
  const auto end = by_from.find(c.to);
  if (end == by_from.end()) return false;
  const auto& [node, T_from_to, covariance] = end->second;
  const Eigen::Vector4d off = difference(c.T_from_to, T_from_to);
  if (off.dot(blurred(c.information, covariance) * off) > config_.consistent) return false;
  const PlaceSigma sigma =
      sigma_of(covariance_at(nodes_[c.to].footprint.middle_m(), T_from_to, covariance));
  if (sigma.m < config_.self_evident_m && sigma.rad < config_.self_evident_rad) return true;

  const RelationsByNode by_to = by_node(known.from(c.to, places(), kFarM));
  const auto supports = [&](const Edge& other) {
    if (other.kind != EdgeKind::loop || other.status == EdgeStatus::switched_off) return false;
    return agrees(loop, other, by_from, by_to) || agrees(loop, reversed(other), by_from, by_to);
  };
  return std::any_of(edges_.begin(), edges_.end(),
                     [&](const Edge& other) { return &other != &loop && supports(other); });
}

SubmapGraph::Edge SubmapGraph::reversed(const Edge& edge) {
  const GraphConstraint& c = edge.constraint;
  Edge back = edge;
  const Eigen::Matrix4d covariance = inverted(c.T_from_to, covariance_of(c.information));
  back.constraint = {c.to, c.from, inverse(c.T_from_to), information_of(covariance), c.robust};
  return back;
}

bool SubmapGraph::agrees(const Edge& loop, const Edge& other, const RelationsByNode& by_from,
                         const RelationsByNode& by_to) const {
  const GraphConstraint& c = loop.constraint;
  const GraphConstraint& o = other.constraint;
  if (o.to == c.to) return false;  // The same surface again is no second opinion.
  const auto at_from = by_from.find(o.from);
  const auto at_to = by_to.find(o.to);
  if (at_from == by_from.end() || at_to == by_to.end()) return false;
  // from → other's from → other's to → to, against the loop's from → to.
  const LevelPose T_from_b = at_from->second.T_from_node * o.T_from_to;
  const Eigen::Matrix4d cov_from_b =
      compounded(at_from->second.T_from_node, at_from->second.covariance, o.T_from_to,
                 covariance_of(o.information));
  const LevelPose T_b_to = inverse(at_to->second.T_from_node);
  const Eigen::Matrix4d cov_b_to = inverted(at_to->second.T_from_node, at_to->second.covariance);
  const Eigen::Matrix4d around = compounded(T_from_b, cov_from_b, T_b_to, cov_b_to);
  const double bold_m = spread_m(by_from.at(c.to).covariance);
  if (spread_m(around) > 0.5 * bold_m) return false;  // It would agree with anything.
  const Eigen::Vector4d off = difference(c.T_from_to, T_from_b * T_b_to);
  return off.dot(blurred(c.information, around) * off) <= config_.consistent;
}

}  // namespace cairn
