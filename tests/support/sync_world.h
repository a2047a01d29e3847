#pragma once

#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "proto/sync/robot_link.h"
#include "proto/sync/server_link.h"
#include "tests/support/lossy_link.h"

/// A robot and a server on a lossy link in simulated time, all from one seed.
namespace cairn::proto::testing {

using cairn::testing::LinkFaults;
using cairn::testing::LossyLink;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// What a server holds of one submap, as applied from updates.
struct HeldSubmap {
  std::optional<SubmapHead> head;
  std::map<BlockKey, std::uint32_t> versions;
  HeightMap surface{125};
  HeightMap seen_through{125};
};

/// A server of one site for one robot: durable blocks, and sessions that a restart forgets.
class TestServer {
 public:
  TestServer(std::uint64_t seed, Duration most_commit) : random_(seed), most_commit_(most_commit) {}

  std::optional<ServerLink> link;
  std::map<std::uint32_t, HeldSubmap> store;  ///< Durable.
  std::uint64_t epoch = 1;
  std::vector<CommandReport> reports;
  std::vector<std::string> broken;  ///< Rules of the contract that were broken.
  int refusals = 0;

  /// Sessions and what was not yet committed are gone.
  void restart() {
    link.reset();
    commits_.clear();
  }

  void on_frame(const LossyLink::Bytes& bytes, MonotonicTime now) {
    const auto frame = decode_frame(bytes, Direction::up);
    if (!frame) return broken.push_back(frame.error().message);
    if (!frame->records.empty() && std::holds_alternative<Hello>(frame->records[0])) {
      return on_hello(std::get<Hello>(frame->records[0]), now);
    }
    if (!link || link->session() != frame->header.session) {
      FrameWriter reset({Direction::down, frame->header.session, 0});
      reset.add(Reset{});
      resets_.push_back(std::move(reset).finish());
      return;
    }
    for (auto& event : link->on_frame(*frame, bytes.size(), now)) take(std::move(event), now);
  }

  std::optional<LossyLink::Bytes> next_frame(MonotonicTime now) {
    commit(now);
    if (!resets_.empty()) {
      auto reset = std::move(resets_.front());
      resets_.pop_front();
      return reset;
    }
    return link ? link->next_frame(now) : std::nullopt;
  }

  [[nodiscard]] MonotonicTime next_due(MonotonicTime now) const {
    MonotonicTime due = link ? link->next_due(now) : now + seconds(3600);
    if (!commits_.empty()) due = std::min(due, commits_.front().at);
    return std::max(due, now);
  }

 private:
  struct Commit {
    MonotonicTime at;
    std::uint32_t session;
    ServerLink::Evidence evidence;
  };

  void on_hello(const Hello& hello, MonotonicTime now) {
    if (link && link->boot() == hello.boot) return link->welcome_again();
    link.emplace(static_cast<std::uint32_t>(random_() | 1U), hello, epoch, 28, now);
    seen_.clear();
  }

  void take(ServerLink::Event event, MonotonicTime now) {
    if (auto* report = std::get_if<CommandReport>(&event)) reports.push_back(*report);
    auto* evidence = std::get_if<ServerLink::Evidence>(&event);
    if (evidence == nullptr) return;
    if (!seen_.insert(evidence->number).second) broken.emplace_back("a frame came up twice");
    auto wait = std::uniform_int_distribution<Duration::rep>(0, most_commit_.count());
    MonotonicTime at = now + Duration(wait(random_));
    if (!commits_.empty()) at = std::max(at, commits_.back().at);
    commits_.push_back({at, link->session(), std::move(*evidence)});
  }

  void commit(MonotonicTime now) {
    while (!commits_.empty() && commits_.front().at <= now) {
      const Commit commit = std::move(commits_.front());
      commits_.pop_front();
      bool whole = true;
      for (const auto& head : commit.evidence.heads) apply(head);
      for (const auto& block : commit.evidence.blocks) whole = apply(block) && whole;
      if (whole && link && link->session() == commit.session) link->durable(commit.evidence.number);
    }
  }

  void apply(const SubmapHead& head) {
    auto& held = store[head.sequence].head;
    if (!held || head.version > held->version) held = head;
  }

  bool apply(const BlockUpdate& update) {
    const auto found = store.find(update.sequence);
    if (found == store.end() || !found->second.head) {
      broken.emplace_back("a block of a submap without a head");
      return false;
    }
    HeldSubmap& held = found->second;
    std::uint32_t& version = held.versions[update.key];
    const Verdict verdict = judge(version, update.base, update.version);
    if (verdict == Verdict::refuse) {
      ++refusals;
      if (link) link->refuse({update.sequence, update.key, version});
      return false;
    }
    if (verdict == Verdict::stale) return true;
    const bool top = update.key.layer == EvidenceLayer::surface;
    if (!cairn::apply(top ? held.surface : held.seen_through, update.key, update.delta)) {
      broken.emplace_back("a height did not fit");
    }
    version = update.version;
    return true;
  }

  std::mt19937_64 random_;
  Duration most_commit_;
  std::deque<Commit> commits_;
  std::deque<LossyLink::Bytes> resets_;
  std::set<std::uint32_t> seen_;
};

/// The whole of it. Time advances from one due event to the next, so that a wrong `next_due` shows
/// as a standstill.
class SyncWorld {
 public:
  SyncWorld(std::uint64_t seed, LinkFaults faults, Duration most_commit = milliseconds(20))
      : up(seed * 4 + 1, faults),
        down(seed * 4 + 2, faults),
        server(seed * 4 + 3, most_commit),
        robot({.robot = "rover", .site = "quarry", .boot = 0xB007}, 28) {}

  LossyLink up;
  LossyLink down;
  TestServer server;
  RobotLink robot;
  MonotonicTime now = seconds(100);  ///< Not zero: the robot's clock runs since its start.
  std::vector<RobotLink::Order> orders;
  bool posing = true;  ///< The robot tells its pose, as agents do …
  bool moving = true;  ///< … and moves.

  void run_until(MonotonicTime end) {
    while (now < end) {
      step();
      now = std::min(next_event(), end);
    }
    step();
  }
  /// False when `done` did not become true in time.
  template <class Done>
  bool run_until(MonotonicTime end, Done done) {
    while (!done() && now < end) {
      step();
      now = std::max(now, std::min(next_event(), end));
    }
    return done();
  }
  [[nodiscard]] std::uint64_t frames() const { return up.frames() + down.frames(); }

 private:
  void step() {
    while (const auto bytes = up.receive(now)) server.on_frame(*bytes, now);
    while (const auto bytes = down.receive(now)) {
      for (auto& order : robot.on_frame(*bytes, now)) orders.push_back(std::move(order));
    }
    if (posing) tell_pose();
    while (const auto bytes = robot.next_frame(now)) up.send(*bytes, now);
    while (const auto bytes = server.next_frame(now)) down.send(*bytes, now);
  }
  void tell_pose() {
    PoseReport pose;
    pose.clock_ms = static_cast<std::uint64_t>(now / milliseconds(1));
    if (moving) pose.T_site_robot.x_mm = static_cast<std::int32_t>(pose.clock_ms);
    robot.set_pose(pose);
  }
  [[nodiscard]] MonotonicTime next_event() const {
    MonotonicTime next = std::min(robot.next_due(now), server.next_due(now));
    if (posing) next = std::min(next, now + milliseconds(100));
    if (const auto arrival = up.next_arrival()) next = std::min(next, *arrival);
    if (const auto arrival = down.next_arrival()) next = std::min(next, *arrival);
    return std::max(next, now + Duration(1));
  }
};

/// A robot that maps: wanders over a field, changes cells of both layers, now and then closes its
/// submap and begins the next. Keeps what it closed, to compare.
class Mapper {
 public:
  explicit Mapper(std::uint64_t seed) : random_(seed) {}

  std::map<std::uint32_t, Submap> closed;

  void see(EvidenceSender& evidence) {
    if (evidence.open_submap() == nullptr) evidence.begin(0xB007, {between(-9000, 9000)}, 125);
    x_ += between(-6, 6);
    y_ += between(-6, 6);
    for (const auto layer : {EvidenceLayer::surface, EvidenceLayer::seen_through}) {
      HeightMap& map = layer_of(*evidence.open_submap(), layer);
      std::vector<CellIndex> changed;
      for (int i = between(0, 40); i > 0; --i) {
        const CellIndex at{x_ + between(-8, 8), y_ + between(-8, 8)};
        const Cell cell{between(-900, 900), static_cast<std::uint8_t>(between(0, 255))};
        if (map.set(at, cell)) changed.push_back(at);
      }
      evidence.touch(layer, changed);
    }
  }
  void close(EvidenceSender& evidence) {
    Submap* open = evidence.open_submap();
    if (open == nullptr) return;
    closed.emplace(open->id.sequence, *open);
    evidence.close();
  }
  int between(int least, int most) {
    return std::uniform_int_distribution<int>(least, most)(random_);
  }

 private:
  std::mt19937_64 random_;
  int x_ = 0;
  int y_ = 0;
};

/// Whether every known cell of each is the same in the other, by content of their tiles.
inline bool same_cells(const HeightMap& a, const HeightMap& b) {
  const auto covered = [](const HeightMap& part, const HeightMap& whole) {
    return std::ranges::all_of(part.tiles(), [&](const auto& entry) {
      const Tile* other = whole.find(entry.first);
      return other == nullptr ? entry.second->known_count() == 0 : *other == *entry.second;
    });
  };
  return covered(a, b) && covered(b, a);
}

/// What of `sent` the server does not hold exactly; empty when all is well.
inline std::string difference(const Submap& sent, const HeldSubmap& held) {
  if (!held.head || !held.head->closed) return "head not closed";
  if (!same_cells(sent.surface, held.surface)) return "surface differs";
  if (!same_cells(sent.seen_through, held.seen_through)) return "seen_through differs";
  std::uint64_t sum = 0;
  for (const auto& [key, version] : held.versions) sum += version;
  if (held.versions.size() != held.head->blocks) return "not all blocks";
  return sum == held.head->final_versions ? "" : "not the final versions";
}

}  // namespace cairn::proto::testing
