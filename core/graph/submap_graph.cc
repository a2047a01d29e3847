#include "core/graph/submap_graph.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

namespace cairn {
namespace {

bool is_covariance(const Eigen::Matrix4d& m) {
  return m.allFinite() && (m - m.transpose()).norm() <= 1e-9 * m.norm() &&
         m.llt().info() == Eigen::Success;
}

bool is_sound(const SubmapEdge& edge) {
  return is_finite(edge.T_from_to) && edge.information.allFinite();
}

}  // namespace

Eigen::Matrix4d odometry_covariance(const LevelPose& T_previous_submap,
                                    const Eigen::Vector2d& robot_in_submap_m, double way_m,
                                    double turned_rad) {
  // A tracked or wheeled robot with a gyro (T3.2); the floor is what maps are good for anyway.
  constexpr double kPerM = 0.02;
  constexpr double kRadPerM = 0.002;
  constexpr double kRadPerRad = 0.005;
  constexpr double kFloorM = 0.03;
  constexpr double kFloorRad = 0.005;
  const double yaw = kFloorRad + kRadPerM * way_m + kRadPerRad * turned_rad;
  const double along = kFloorM + kPerM * way_m;
  const double across = along + 0.5 * way_m * yaw;  // Which way the robot drove is not told.
  const Eigen::Matrix4d at_robot =
      Eigen::Vector4d(across, across, along, yaw).cwiseAbs2().asDiagonal();
  const double c = std::cos(T_previous_submap.yaw_rad);
  const double s = std::sin(T_previous_submap.yaw_rad);
  const Eigen::Matrix4d J = lever(-c * robot_in_submap_m.x() + s * robot_in_submap_m.y(),
                                  -s * robot_in_submap_m.x() - c * robot_in_submap_m.y());
  return J * at_robot * J.transpose();
}

std::string SubmapGraph::objection_to(const SubmapNode& node) const {
  if (index_.contains(node.id)) return "is known already";
  if (node.surface == nullptr) return "has no surface";
  if (!nodes_.empty() && node.surface->cell_size_mm() != nodes_.front().surface->cell_size_mm()) {
    return "has another cell size than the graph";
  }
  if (!is_finite(node.T_site_submap)) return "lies nowhere: its pose is not finite";
  if (node.link && !index_.contains(node.link->previous)) return "follows an unknown submap";
  if (node.link && !is_finite(node.link->T_previous_submap)) return "has a link that is not finite";
  if (!is_covariance(node.link ? node.link->covariance : node.prior_covariance)) {
    return "has a covariance that is not positive definite";
  }
  return {};
}

Status SubmapGraph::add_submap(SubmapNode node) {
  if (nodes_.size() >= kMaxSubmaps || edges_.size() >= kMaxEdges) {
    return Error{ErrorCode::exhausted, "the submap graph is full"};
  }
  if (const std::string objection = objection_to(node); !objection.empty()) {
    return Error{ErrorCode::invalid_argument, "the submap " + objection};
  }
  const std::size_t i = nodes_.size();
  LevelPose place = node.T_site_submap;
  if (node.link) {
    const std::size_t previous = index_.at(node.link->previous);
    place = nodes_[previous].T_site_submap * node.link->T_previous_submap;
    add_edge(
        {EdgeKind::chain,
         EdgeStatus::accepted,
         {previous, i, node.link->T_previous_submap, information_of(node.link->covariance), false},
         true});
  } else if (i > 0) {
    const LevelPose& oldest = nodes_.front().T_site_submap;
    const Eigen::Matrix4d R = turned_axes(-oldest.yaw_rad);
    const Eigen::Matrix4d covariance = R * node.prior_covariance * R.transpose();
    add_edge({EdgeKind::prior,
              EdgeStatus::accepted,
              {0, i, between(oldest, place), information_of(covariance), false},
              true});
  }
  Footprint footprint(*node.surface);
  index_.emplace(node.id, i);
  Faces faces(*node.surface);
  const std::size_t cells = node.surface->known_count();
  nodes_.push_back({node.id, std::move(node.surface), std::move(footprint), std::move(faces), cells,
                    place, node.T_site_submap});
  waits_.push_back(true);
  to_search_.push_back(i);
  return {};
}

void SubmapGraph::add_edge(const Edge& edge) {
  edges_.push_back(edge);
  if (edge.kind == EdgeKind::loop) {
    matched_.insert(std::minmax(edge.constraint.from, edge.constraint.to));
  }
}

std::vector<std::size_t> SubmapGraph::taking_part() const {
  std::vector<std::size_t> firm;
  std::vector<std::size_t> loops;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    if (edges_[i].status == EdgeStatus::held_back) continue;
    (edges_[i].kind == EdgeKind::loop ? loops : firm).push_back(i);
  }
  firm.insert(firm.end(), loops.begin(), loops.end());
  return firm;
}

PoseGraph SubmapGraph::pose_graph() const {
  PoseGraph graph;
  graph.nodes = places();
  graph.fixed.assign(nodes_.size(), false);
  graph.fixed[0] = true;
  for (const std::size_t i : taking_part()) graph.constraints.push_back(edges_[i].constraint);
  return graph;
}

Result<std::vector<SubmapPlace>> SubmapGraph::optimise() {
  if (nodes_.empty()) return std::vector<SubmapPlace>{};
  const Result<OptimisedGraph> optimum = cairn::optimise(pose_graph(), config_.graph);
  if (!optimum) return optimum.error();
  auto off = optimum->switched_off.begin();
  for (const std::size_t i : taking_part()) {
    Edge& edge = edges_[i];
    edge.status = *off++ ? EdgeStatus::switched_off : EdgeStatus::accepted;
    edge.laid = true;
  }
  return take_places(*optimum);
}

std::vector<SubmapPlace> SubmapGraph::take_places(const OptimisedGraph& optimum) {
  std::vector<SubmapPlace> moved;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    Node& node = nodes_[i];
    const double cell_m = node.surface->cell_size_m();
    const Eigen::Vector4d step = difference(optimum.nodes[i], node.T_site_submap);
    node.T_site_submap = optimum.nodes[i];
    if (step.head<3>().norm() > cell_m && !waits_[i]) {  // Others may be within reach now.
      waits_[i] = true;
      to_search_.push_back(i);
    }
    const Eigen::Vector4d news = difference(node.T_site_submap, node.reported);
    if (news.head<3>().norm() <= config_.report_m && std::abs(news[3]) <= config_.report_rad) {
      continue;
    }
    node.reported = node.T_site_submap;
    moved.push_back({node.id, node.T_site_submap});
  }
  return moved;
}

std::optional<LevelPose> SubmapGraph::place(SubmapId id) const {
  const auto found = index_.find(id);
  if (found == index_.end()) return std::nullopt;
  return nodes_[found->second].T_site_submap;
}

std::vector<LevelPose> SubmapGraph::places() const {
  std::vector<LevelPose> places;
  places.reserve(nodes_.size());
  for (const Node& node : nodes_) places.push_back(node.T_site_submap);
  return places;
}

SubmapEdge SubmapGraph::named(const Edge& edge) const {
  const GraphConstraint& c = edge.constraint;
  return {edge.kind, edge.status, nodes_[c.from].id, nodes_[c.to].id, c.T_from_to, c.information};
}

std::vector<SubmapEdge> SubmapGraph::edges() const {
  std::vector<SubmapEdge> named_edges;
  named_edges.reserve(edges_.size());
  for (const Edge& edge : edges_) named_edges.push_back(named(edge));
  return named_edges;
}

FoundLoops SubmapGraph::found() const {
  FoundLoops found;
  for (const Edge& edge : edges_) {
    if (edge.kind == EdgeKind::loop) found.loops.push_back(named(edge));
  }
  for (const auto& [pair, tried] : tried_) {
    found.tried.push_back(
        {nodes_[pair.first].id, nodes_[pair.second].id, tried.count, tried.sigma_m});
  }
  for (const Node& node : nodes_) found.places.push_back({node.id, node.T_site_submap});
  return found;
}

std::optional<SubmapGraph::Pair> SubmapGraph::pair_of(SubmapId a, SubmapId b) const {
  const auto first = index_.find(a);
  const auto second = index_.find(b);
  if (first == index_.end() || second == index_.end() || a == b) return std::nullopt;
  return Pair(std::minmax(first->second, second->second));
}

Status SubmapGraph::restore(const FoundLoops& found) {
  const bool sound = std::all_of(found.loops.begin(), found.loops.end(), is_sound) &&
                     std::all_of(found.places.begin(), found.places.end(),
                                 [](const SubmapPlace& p) { return is_finite(p.T_site_submap); });
  if (!sound) return Error{ErrorCode::corrupt, "stored loops are not finite"};
  if (edges_.size() + found.loops.size() > kMaxEdges || found.tried.size() > kMaxTriedPairs) {
    return Error{ErrorCode::exhausted, "more stored loops than the submap graph holds"};
  }
  for (const SubmapEdge& loop : found.loops) {
    const auto pair = pair_of(loop.from, loop.to);
    if (!pair || matched_.contains(*pair)) continue;
    add_edge({EdgeKind::loop,
              loop.status,
              {index_.at(loop.from), index_.at(loop.to), loop.T_from_to, loop.information, true},
              true});
  }
  for (const TriedPair& tried : found.tried) {
    const auto pair = pair_of(tried.a, tried.b);
    if (!pair) continue;
    tried_[*pair] = {tried.tries, tried.sigma_m};
    waits_[pair->first] = waits_[pair->second] = false;
  }
  std::erase_if(to_search_, [this](std::size_t node) { return !waits_[node]; });
  for (const SubmapPlace& place : found.places) {
    const auto node = index_.find(place.id);
    if (node == index_.end()) continue;
    nodes_[node->second].T_site_submap = place.T_site_submap;
    nodes_[node->second].reported = place.T_site_submap;
  }
  return {};
}

}  // namespace cairn
