#include "robot_agent/spool/spool.h"

#include <algorithm>
#include <utility>

namespace cairn::agent {

Spool::Spool(const SpoolConfig& config, std::uint64_t boot) : config_(config), boot_(boot) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

Spool::~Spool() = default;

// ---- The driving loop's side --------------------------------------------------------------------

void Spool::look(proto::EvidenceSender& sender, MonotonicTime now) {
  note_departures(sender);
  hand_over(sender);
  if (now - looked_at_ < kLookPeriod) return;
  looked_at_ = now;
  forget_failed_saves(now);
  copy_changes(sender, now, false);
  ask_for_more(sender);
}

void Spool::note_departures(proto::EvidenceSender& sender) {
  in_sender_ = sender.submaps();
  const auto departures = sender.take_departures();
  if (departures.empty()) return;
  const std::scoped_lock lock(mutex_);
  for (const auto& [id, held] : departures) {
    copied_.erase(id);
    if (held) {
      std::erase_if(jobs_, [&id = id](const Job& job) {
        const auto* save = std::get_if<Save>(&job);
        return save != nullptr && save->kept.id == id;
      });
    }
    jobs_.emplace_back(Left{id, held});
  }
  wake_.notify_one();
}

void Spool::hand_over(proto::EvidenceSender& sender) {
  std::optional<proto::KeptSubmap> kept;
  {
    const std::scoped_lock lock(mutex_);
    if (!taken_up_) return;
    kept = std::exchange(taken_up_, std::nullopt);
    taking_up_ = false;
  }
  if (sender.adopt(*kept, boot_, config_.owner.cell_size_mm)) {
    copied_[kept->id] = 0;  // As it is on disk.
    in_sender_ = sender.submaps();
    return;
  }
  const std::scoped_lock lock(mutex_);
  refuse({ErrorCode::corrupt, "a spooled submap contradicts itself: it cannot be delivered"});
}

void Spool::forget_failed_saves(MonotonicTime now) {
  const std::scoped_lock lock(mutex_);
  for (const SubmapId& id : unsaved_) copied_.erase(id);
  if (!unsaved_.empty()) retry_at_ = now + kRetryPeriod;
  unsaved_.clear();
}

void Spool::copy_changes(proto::EvidenceSender& sender, MonotonicTime now, bool at_once) {
  if (retry_at_ && now < *retry_at_ && !at_once) return;
  const bool checkpoint = at_once || now - checkpointed_at_ >= kCheckpointPeriod;
  for (const auto& [id, revision, closed] : sender.unheld()) {
    const auto copied = copied_.find(id);
    const bool same = copied != copied_.end() && copied->second == revision;
    if (same || revision == 0 || (!closed && !checkpoint)) continue;
    if (saves_waiting() >= kMaxSaves && !at_once) return;
    auto kept = sender.copy_of(id);
    if (!kept || kept->blocks.empty()) continue;
    copied_[id] = revision;
    if (!closed) checkpointed_at_ = now;
    const std::scoped_lock lock(mutex_);
    jobs_.emplace_back(Save{*std::move(kept), revision});
    wake_.notify_one();
  }
}

std::size_t Spool::saves_waiting() const {
  const std::scoped_lock lock(mutex_);
  return static_cast<std::size_t>(std::ranges::count_if(
      jobs_, [](const Job& job) { return std::holds_alternative<Save>(job); }));
}

void Spool::ask_for_more(const proto::EvidenceSender& sender) {
  const std::scoped_lock lock(mutex_);
  if (taking_up_ || waiting_on_disk_ == 0 || sender.submaps() >= kTakeUpBelow) return;
  taking_up_ = true;
  jobs_.emplace_back(TakeUp{});
  wake_.notify_one();
}

bool Spool::flush(proto::EvidenceSender& sender, MonotonicTime now,
                  std::chrono::milliseconds patience) {
  note_departures(sender);
  copy_changes(sender, now, true);
  std::unique_lock lock(mutex_);
  return idle_.wait_for(lock, patience, [this] { return jobs_.empty() && !busy_; }) &&
         !report_.failed;
}

proto::SpoolReport Spool::report() const {
  const std::scoped_lock lock(mutex_);
  proto::SpoolReport report = report_;
  report.submaps = static_cast<std::uint32_t>(in_sender_ + waiting_on_disk_ + (taken_up_ ? 1 : 0));
  return report;
}

bool Spool::all_taken_up() const {
  const std::scoped_lock lock(mutex_);
  return waiting_on_disk_ == 0 && !taking_up_;
}

std::vector<std::string> Spool::take_news() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(news_, {});
}

// ---- The thread's side --------------------------------------------------------------------------

void Spool::run(const std::stop_token& stop) {
  open_store();
  std::unique_lock lock(mutex_);
  taking_up_ = false;
  while (true) {
    busy_ = false;
    if (jobs_.empty()) idle_.notify_all();
    if (!wake_.wait(lock, stop, [this] { return !jobs_.empty(); }) || stop.stop_requested()) return;
    const Job job = std::move(jobs_.front());
    jobs_.pop_front();
    busy_ = true;
    lock.unlock();
    carry_out(job);
    lock.lock();
    publish();
  }
}

void Spool::open_store() {
  auto store = SpoolStore::open(config_);
  const std::scoped_lock lock(mutex_);
  if (!store) {
    failed(store.error());
    return;
  }
  store_ = std::move(*store);
  for (const SubmapId& id : store_->oldest_first()) away_.insert(id);
  if (!away_.empty()) say(std::to_string(away_.size()) + " submaps of earlier runs wait there");
  publish();
}

void Spool::carry_out(const Job& job) {
  if (store_ == nullptr) open_store();  // It may have come into being.
  if (const auto* to_save = std::get_if<Save>(&job)) save(*to_save);
  if (const auto* gone = std::get_if<Left>(&job)) left(*gone);
  if (std::holds_alternative<TakeUp>(job)) take_up();
}

void Spool::save(const Save& job) {
  SpoolStore::Thinned went;
  Status saved = Error{ErrorCode::io, "the folder cannot be used"};
  if (store_ != nullptr) saved = store_->save(job.kept, went);
  const std::scoped_lock lock(mutex_);
  note(went);
  if (!saved) {
    unsaved_.push_back(job.kept.id);
    failed(saved.error());
  } else if (std::exchange(report_.failed, false)) {
    say("the disk takes evidence again");
  }
}

void Spool::left(const Left& job) {
  const bool on_disk = store_ != nullptr && store_->contains(job.id);
  Status removed;
  if (job.held && on_disk) removed = store_->remove(job.id);
  const std::scoped_lock lock(mutex_);
  if (!removed) failed(removed.error());
  const bool counted = counted_.erase(job.id) > 0;
  if (job.held) return;
  if (on_disk) {
    away_.insert(job.id);
  } else if (!counted) {
    ++report_.dropped;
    say_what_went();
  }
}

void Spool::take_up() {
  std::optional<proto::KeptSubmap> found;
  std::vector<Error> refused;
  for (const SubmapId& id : store_ != nullptr ? store_->oldest_first() : std::vector<SubmapId>()) {
    if (!away_.contains(id)) continue;
    away_.erase(id);
    auto kept = store_->load(id);
    if (kept) {
      found = *std::move(kept);
      break;
    }
    refused.push_back(kept.error());
  }
  const std::scoped_lock lock(mutex_);
  for (const Error& why : refused) refuse(why);
  taken_up_ = std::move(found);
  if (!taken_up_) taking_up_ = false;
}

// ---- The same, with the mutex held --------------------------------------------------------------

void Spool::note(const SpoolStore::Thinned& went) {
  for (const Error& why : went.refused) refuse(why);
  report_.thinned += static_cast<std::uint32_t>(went.thinned.size());
  report_.dropped += static_cast<std::uint32_t>(went.dropped.size());
  for (const SubmapId& id : went.dropped) {
    if (away_.erase(id) == 0) counted_.insert(id);
  }
  if (!went.thinned.empty() || !went.dropped.empty()) say_what_went();
}

/// What is another's evidence is safe where it is; damaged evidence is lost.
void Spool::refuse(const Error& why) {
  if (why.code == ErrorCode::corrupt) ++report_.dropped;
  say(why.message);
}

void Spool::failed(const Error& why) {
  if (std::exchange(report_.failed, true)) return;
  say(why.message + "; evidence is kept in memory only until the disk takes it");
}

/// At first, and whenever it has doubled.
void Spool::say_what_went() {
  const std::uint64_t went = std::uint64_t{report_.thinned} + report_.dropped;
  if (went < said_went_ * 2) return;
  said_went_ = went;
  say("evidence had to go before the server had it: of " + std::to_string(report_.thinned) +
      " submaps the layer seen through, " + std::to_string(report_.dropped) + " whole");
}

void Spool::say(std::string line) {
  if (news_.size() < kMaxNews) news_.push_back(std::move(line));
}

void Spool::publish() {
  report_.bytes = store_ != nullptr ? store_->bytes() : 0;
  waiting_on_disk_ = away_.size();
}

}  // namespace cairn::agent
