#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "core/common/time.h"
#include "proto/sync/evidence_sender.h"
#include "robot_agent/spool/spool_store.h"

namespace cairn::agent {

/// Keeps on disk what the server does not hold, so that it outlives the agent, and takes up what
/// earlier runs left. The disk is a thread's own: the driving loop only copies what changed and
/// never waits. A disk that takes no more leaves everything as it is without a spool, until it
/// takes again. What the spool holds of a submap is never newer than what the sender has, and at
/// most a checkpoint's period older.
class Spool {
 public:
  /// How often the sender is looked through for changes …
  static constexpr Duration kLookPeriod = std::chrono::milliseconds(500);
  /// … how often the open submap is written, if it changed …
  static constexpr Duration kCheckpointPeriod = std::chrono::seconds(3);
  /// … and how long a disk that failed is left alone.
  static constexpr Duration kRetryPeriod = std::chrono::seconds(20);
  static constexpr std::size_t kMaxSaves = 8;  ///< Copies waiting for the disk; more wait uncopied.
  /// [submaps] With fewer in the sender, one more is taken up from the disk.
  static constexpr std::size_t kTakeUpBelow = 16;
  static constexpr std::size_t kMaxNews = 32;  ///< Lines; more are dropped.

  /// `boot`: this run's. A folder that cannot be used is said by `report` and `take_news`.
  Spool(const SpoolConfig& config, std::uint64_t boot);
  /// Waits for the file being written, not for others: see `flush`.
  ~Spool();
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;

  /// Call often: notes what left the sender, copies what changed, hands over what the disk held.
  void look(proto::EvidenceSender& sender, MonotonicTime now);
  /// The end is near: copies all that changed and waits until it is on disk, at most `patience`.
  /// Returns whether it is.
  bool flush(proto::EvidenceSender& sender, MonotonicTime now, std::chrono::milliseconds patience);

  [[nodiscard]] proto::SpoolReport report() const;
  /// Nothing is on disk, or waits for it, that is not also in the sender.
  [[nodiscard]] bool all_taken_up() const;
  /// What the operator should read, a line each; each once.
  [[nodiscard]] std::vector<std::string> take_news();

 private:
  struct Save {
    proto::KeptSubmap kept;
    std::uint64_t revision = 0;
  };
  struct Left {
    SubmapId id;
    bool held = false;
  };
  struct TakeUp {};
  using Job = std::variant<Save, Left, TakeUp>;

  // ---- The driving loop's side.
  void note_departures(proto::EvidenceSender& sender);
  void hand_over(proto::EvidenceSender& sender);
  void forget_failed_saves(MonotonicTime now);
  void copy_changes(proto::EvidenceSender& sender, MonotonicTime now, bool at_once);
  [[nodiscard]] std::size_t saves_waiting() const;
  void ask_for_more(const proto::EvidenceSender& sender);

  // ---- The thread's side.
  void run(const std::stop_token& stop);
  void open_store();
  void carry_out(const Job& job);
  void save(const Save& job);
  void left(const Left& job);
  void take_up();

  // ---- With the mutex held.
  void note(const SpoolStore::Thinned& went);
  void refuse(const Error& why);
  void failed(const Error& why);
  void say_what_went();
  void say(std::string line);
  void publish();

  SpoolConfig config_;
  std::uint64_t boot_;

  std::map<SubmapId, std::uint64_t> copied_;  ///< Revision; of those in the sender.
  MonotonicTime looked_at_{};
  MonotonicTime checkpointed_at_{};
  std::optional<MonotonicTime> retry_at_;
  std::size_t in_sender_ = 0;

  std::unique_ptr<SpoolStore> store_;  ///< The thread's. Null: the folder cannot be used.
  std::set<SubmapId> away_;            ///< The thread's. On disk and not in the sender.

  mutable std::mutex mutex_;  ///< Guards all below.
  std::condition_variable_any wake_;
  std::condition_variable_any idle_;
  std::deque<Job> jobs_;  ///< [Limit: kMaxSaves, what the sender can lose between two looks, 1]
  bool busy_ = false;
  bool taking_up_ = true;  ///< The thread reads the folder, or a submap for the sender …
  std::optional<proto::KeptSubmap> taken_up_;  ///< … which has arrived here.
  std::vector<SubmapId> unsaved_;              ///< Whose copies the disk refused.
  std::set<SubmapId> counted_;                 ///< Dropped from the disk while still in the sender.
  std::size_t waiting_on_disk_ = 0;            ///< As `away_`.
  proto::SpoolReport report_;                  ///< All but the count of submaps.
  std::uint64_t said_went_ = 0;
  std::vector<std::string> news_;  ///< [Limit: ≤ kMaxNews]

  std::jthread thread_;  ///< Last: ends first.
};

}  // namespace cairn::agent
