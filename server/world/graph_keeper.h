#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/graph/submap_graph.h"
#include "server/world/world.h"

namespace cairn::server {

/// Keeps a site's map straight: looks for loops among merged submaps on a strand of its own, away
/// from the evidence, and tells the world where submaps lie when they fit better elsewhere.
class GraphKeeper : public std::enable_shared_from_this<GraphKeeper> {
 public:
  /// Carries findings out and says whether that succeeded. Called on the keeper's strand.
  using Told = std::function<void(Status)>;
  using Tell = std::function<void(GraphFindings, Told)>;

  GraphKeeper(const boost::asio::any_io_executor& executor, Tell tell);

  /// Submaps in the order of their merging. From any thread.
  void take(std::vector<MergedSubmap> merged);
  /// What was found before a restart; the search begins. Call once, after the first `take`s.
  void resume(GraphFindings findings);

  /// [registrations] Between them the strand serves others; each takes up to 50 ms.
  static constexpr int kSlice = 4;
  /// Between two moves: what is found meanwhile moves together.
  static constexpr std::chrono::seconds kMovePeriod{10};

 private:
  void add(const MergedSubmap& submap);
  void schedule();
  void search();
  void report();
  [[nodiscard]] std::vector<std::pair<SubmapId, SubmapPose>> moves() const;
  /// What the store does not have yet of what was found.
  void add_news(const FoundLoops& found, GraphFindings& findings) const;
  void remember(const GraphFindings& told);
  [[nodiscard]] bool any_worth_moving(
      const std::vector<std::pair<SubmapId, SubmapPose>>& moves) const;

  void report_in_time();

  boost::asio::strand<boost::asio::any_io_executor> strand_;
  boost::asio::steady_timer pause_;  ///< Since the last report.
  Tell tell_;
  SubmapGraph graph_;
  std::unordered_map<SubmapId, SubmapPose, SubmapIdHash> world_;  ///< Where the world has them.
  using Pair = std::pair<SubmapId, SubmapId>;
  std::map<Pair, std::uint8_t> stored_loops_;   ///< Their status. Bounded as the graph's edges.
  std::map<Pair, std::uint32_t> stored_tries_;  ///< How often. [Limit: ≤ kMaxTriedPairs]
  bool resumed_ = false;
  bool scheduled_ = false;
  bool telling_ = false;
  bool pausing_ = false;
  bool improved_ = false;  ///< Loops were accepted since the server started.
  int compared_ = 0;       ///< Pairs since the last report.
};

}  // namespace cairn::server
