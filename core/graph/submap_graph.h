#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/common/result.h"
#include "core/graph/footprint.h"
#include "core/graph/loop_match.h"
#include "core/graph/pose_graph.h"
#include "core/graph/relations.h"
#include "core/map/submap.h"

namespace cairn {

/// How a submap lies to an earlier one of the same boot by odometry or local tracking alone, free
/// of corrections from the long-term map.
struct ChainLink {
  SubmapId previous;
  LevelPose T_previous_submap;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity();  ///< [m, m, m, rad] Along `previous`.
};

/// The covariance of a chain link when only the ways are known: the robot drove about from one
/// submap's middle to the next one's.
/// `way_m`: driven in between, half of either submap included; `turned_rad`: turned, either way
/// added up.
[[nodiscard]] Eigen::Matrix4d odometry_covariance(const LevelPose& T_previous_submap,
                                                  const Eigen::Vector2d& robot_in_submap_m,
                                                  double way_m, double turned_rad);

/// What a submap brings into the graph.
struct SubmapNode {
  SubmapId id;
  LevelPose T_site_submap;  ///< As believed.
  /// In the submap's own frame; complete. The graph keeps it.
  std::shared_ptr<const HeightMap> surface;
  std::optional<ChainLink> link;
  /// [m, m, m, rad] Of T_site_submap, along the site's axes about the submap's origin. Only what
  /// has no link needs it.
  Eigen::Matrix4d prior_covariance = Eigen::Vector4d(25.0, 25.0, 1.0, 0.25).asDiagonal();
};

enum class EdgeKind : std::uint8_t {
  chain = 0,  ///< Odometry or local tracking.
  prior = 1,  ///< The believed pose of a submap without chain, against the oldest submap.
  loop = 2,   ///< Two surfaces matched.
};

enum class EdgeStatus : std::uint8_t {
  accepted = 0,      ///< Takes part.
  held_back = 1,     ///< The match is good, but nothing else confirms it yet.
  switched_off = 2,  ///< Contradicts the rest.
};

/// A tie between two submaps, to be drawn and to be stored.
struct SubmapEdge {
  EdgeKind kind = EdgeKind::chain;
  EdgeStatus status = EdgeStatus::accepted;
  SubmapId from;
  SubmapId to;
  LevelPose T_from_to;
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();  ///< As in GraphConstraint.
};

/// A pair of submaps that was compared, so that it need not be again.
struct TriedPair {
  SubmapId a;  ///< a < b
  SubmapId b;
  std::uint32_t tries = 0;
  double sigma_m = 0.0;  ///< How well b's place in a was known at the last try.
  friend bool operator==(const TriedPair&, const TriedPair&) = default;
};

struct SubmapPlace {
  SubmapId id;
  LevelPose T_site_submap;
  friend bool operator==(const SubmapPlace&, const SubmapPlace&) = default;
};

/// All that was found out by searching: what a restarted server needs besides the submaps.
struct FoundLoops {
  std::vector<SubmapEdge> loops;
  std::vector<TriedPair> tried;
  std::vector<SubmapPlace> places;
};

/// What one call to find_loops did.
struct LoopSearch {
  int registrations = 0;
  int matched = 0;    ///< Of them good by their own evidence.
  int accepted = 0;   ///< Loops that take part from the next optimise() on.
  bool done = false;  ///< Nothing is left to try until something changes.
};

struct SubmapGraphConfig {
  GraphConfig graph;
  LoopMatchConfig match;
  /// [m] Submaps whose places to each other are known better than this, [m] and [rad], are tied
  /// closely: matching them would tell nothing.
  double tied_m = 0.06;
  double tied_rad = 0.008;
  /// [1] A submap of fewer known cells lies where its links have it: so little, as of news from
  /// ground that was known, fits in many places.
  std::size_t min_cells = 500;
  /// [1] Candidates tried per submap and round, best first.
  std::size_t max_candidates = 6;
  std::uint32_t max_tries = 3;  ///< Per pair; a further one only when its places are known better.
  /// [-] χ² (4 degrees of freedom) up to which a loop agrees with what is known, and two loops with
  /// each other: 1 % of the right ones are beyond.
  double consistent = 13.3;
  /// [m] Where the places are known so well already, a loop that agrees is accepted by itself; a
  /// bolder one needs another that agrees with it.
  double self_evident_m = 0.5;
  double self_evident_rad = 0.10;  ///< [rad]
  /// [m], [rad] Moves smaller than these are not reported.
  double report_m = 0.001;
  double report_rad = 0.0001;
};

/// The pose graph over a site's evidence submaps with loop closure (T5.3 names the drift that it
/// undoes; design §3: the long-term map is the fold of the submaps, so it can be moved). The oldest
/// submap stays where it is. Deterministic: the same calls give the same answers.
/// Not thread-safe: one strand owns it; find_loops is the long work and can be called in slices.
class SubmapGraph {
 public:
  static constexpr std::size_t kMaxSubmaps = kMaxGraphNodes - 1;
  static constexpr std::size_t kMaxEdges = kMaxGraphConstraints;
  static constexpr std::size_t kMaxTriedPairs = 1'000'000;

  explicit SubmapGraph(SubmapGraphConfig config = {}) : config_(config) {}

  /// Adds a submap that is complete. With a link it lies where link and previous submap put it,
  /// else where it is believed to be. Submaps are added in the order in which they were completed.
  /// Errors (nothing is added): known already, an unknown previous one, not finite, a covariance
  /// that is not positive definite, no surface, another cell size, full.
  Status add_submap(SubmapNode node);

  /// Compares submaps that may overlap, at most `max_registrations` pairs (5-50 ms each), the
  /// surest first; the next call goes on. Ends early when a loop was accepted, because optimise()
  /// then makes all further comparisons easier.
  LoopSearch find_loops(int max_registrations);

  /// Lays the submaps where everything fits best; those that moved since they were last reported
  /// (or added), in the order of their adding. On error nothing moves.
  [[nodiscard]] Result<std::vector<SubmapPlace>> optimise();

  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] std::optional<LevelPose> place(SubmapId id) const;
  /// Chain, prior and loop edges with their status, in the order of their adding.
  [[nodiscard]] std::vector<SubmapEdge> edges() const;

  /// What searching has found out.
  [[nodiscard]] FoundLoops found() const;
  /// Takes it up again after a restart, when the same submaps were added again. What belongs to
  /// submaps that are not there is left out. Submaps that were compared before are not searched
  /// again until they move. Error: not finite; then nothing is taken up.
  Status restore(const FoundLoops& found);

 private:
  struct Node {
    SubmapId id;
    std::shared_ptr<const HeightMap> surface;
    Footprint footprint;
    Faces faces;
    std::size_t cells = 0;  ///< Known ones.
    LevelPose T_site_submap;
    LevelPose reported;
  };
  struct Edge {
    EdgeKind kind = EdgeKind::chain;
    EdgeStatus status = EdgeStatus::accepted;
    GraphConstraint constraint;
    bool laid = true;  ///< The places take it into account.
  };
  struct Try {
    std::uint32_t count = 0;
    double sigma_m = 0.0;
  };
  using Pair = std::pair<std::size_t, std::size_t>;  ///< The smaller first.

  [[nodiscard]] std::string objection_to(const SubmapNode& node) const;
  void add_edge(const Edge& edge);
  /// Edges that are not held back: firm ones first, so that a restart leaves their order.
  [[nodiscard]] std::vector<std::size_t> taking_part() const;
  [[nodiscard]] PoseGraph pose_graph() const;
  std::vector<SubmapPlace> take_places(const OptimisedGraph& optimum);
  [[nodiscard]] SubmapEdge named(const Edge& edge) const;
  [[nodiscard]] std::optional<Pair> pair_of(SubmapId a, SubmapId b) const;

  [[nodiscard]] Ties ties() const;
  [[nodiscard]] std::vector<LevelPose> places() const;
  struct Candidate {
    std::size_t to = 0;
    Relation from_to;
    double sigma_m = 0.0;
    double promise = 0.0;
  };
  [[nodiscard]] std::vector<Candidate> candidates_of(std::size_t from, const Ties& ties) const;
  [[nodiscard]] bool worth_a_try(std::size_t from, std::size_t to, double sigma_m) const;
  bool try_candidate(std::size_t from, const Candidate& candidate);
  /// Loops held back that are looked at now: the new ones, and some of the old ones in turn.
  [[nodiscard]] std::vector<std::size_t> to_confirm(std::size_t first_new);
  int confirm(std::size_t first_new);
  [[nodiscard]] bool confirmed(const Edge& loop, const Ties& known) const;
  using RelationsByNode = std::unordered_map<std::size_t, Relation>;
  /// Whether the ring loop, by_to, other, by_from closes, and would not close by itself
  /// (Mangelson et al. 2018: pairwise consistency).
  [[nodiscard]] bool agrees(const Edge& loop, const Edge& other, const RelationsByNode& by_from,
                            const RelationsByNode& by_to) const;
  [[nodiscard]] static Edge reversed(const Edge& edge);

  SubmapGraphConfig config_;
  std::vector<Node> nodes_;  ///< [Limit: ≤ kMaxSubmaps]
  std::unordered_map<SubmapId, std::size_t, SubmapIdHash> index_;
  std::vector<Edge> edges_;
  std::map<Pair, Try> tried_;          ///< [Limit: ≤ kMaxTriedPairs]
  std::set<Pair> matched_;             ///< Pairs that a loop ties.
  std::deque<std::size_t> to_search_;  ///< Each node at most once.
  std::size_t tried_here_ = 0;         ///< Candidates of the first of them.
  std::size_t first_new_ = 0;          ///< Edge from which on its loops are.
  std::size_t next_held_ = 0;          ///< Whose turn it is to be confirmed.
  std::vector<bool> waits_;            ///< Per node: it is in to_search_.
};

}  // namespace cairn
