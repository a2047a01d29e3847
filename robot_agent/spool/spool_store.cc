#include "robot_agent/spool/spool_store.h"

#include <algorithm>
#include <utility>

namespace cairn::agent {

SpoolStore::SpoolStore(SpoolConfig config, std::unique_ptr<SpoolFolder> folder)
    : config_(std::move(config)), folder_(std::move(folder)) {}

Result<std::unique_ptr<SpoolStore>> SpoolStore::open(const SpoolConfig& config) {
  auto folder = SpoolFolder::open(config.folder);
  if (!folder) return folder.error();
  std::unique_ptr<SpoolStore> store(new SpoolStore(config, *std::move(folder)));
  if (Status read = store->read_folder(); !read) return read.error();
  return store;
}

Status SpoolStore::read_folder() {
  const auto files = folder_->list();
  if (!files) return files.error();
  for (const SpoolFolder::File& file : *files) {
    const bool copied_by_hand =
        orders_.contains(file.name.id) || entries_.contains(file.name.order);
    if (copied_by_hand) {
      (void)folder_->set_aside(file.name);
      continue;
    }
    entries_[file.name.order] = {file.name.id, file.bytes};
    orders_[file.name.id] = file.name.order;
    bytes_ += file.bytes;
  }
  return {};
}

SpoolStore::Entries::iterator SpoolStore::find(const SubmapId& id) {
  const auto order = orders_.find(id);
  return order == orders_.end() ? entries_.end() : entries_.find(order->second);
}

std::vector<SubmapId> SpoolStore::oldest_first() const {
  std::vector<SubmapId> ids;
  for (const auto& [order, entry] : entries_) ids.push_back(entry.id);
  return ids;
}

Status SpoolStore::save(const proto::KeptSubmap& kept, Thinned& went) {
  const auto bytes = write_kept(kept, config_.owner, config_.coarseness);
  const auto known = find(kept.id);
  const std::uint64_t before = known == entries_.end() ? 0 : known->second.bytes;
  if (bytes.size() > before) {
    if (Status room = make_room(bytes.size() - before, kept.id, went); !room) return room;
  }
  const std::uint64_t newest = entries_.empty() ? 0 : entries_.rbegin()->first;
  const std::uint64_t order = known == entries_.end() ? newest + 1 : known->first;
  if (Status written = folder_->write({order, kept.id}, bytes); !written) return written;
  entries_[order] = {kept.id, bytes.size()};
  orders_[kept.id] = order;
  bytes_ += bytes.size() - before;
  return {};
}

Status SpoolStore::remove(const SubmapId& id) {
  const auto entry = find(id);
  if (entry == entries_.end()) return {};
  if (Status removed = folder_->remove({entry->first, id}); !removed) return removed;
  forget(entry);
  return {};
}

Result<proto::KeptSubmap> SpoolStore::load(const SubmapId& id) {
  const auto entry = find(id);
  if (entry == entries_.end()) return Error{ErrorCode::not_found, "it is not in the spool"};
  const SpoolFolder::Name name{entry->first, id};
  const auto bytes = folder_->read(name);
  if (!bytes) return set_aside(entry, bytes.error()).error();
  auto kept = read_kept(*bytes, config_.owner);
  if (!kept) return set_aside(entry, kept.error()).error();
  if (kept->id == id) return kept;
  const Error renamed{ErrorCode::corrupt, "it is another submap than its name says; delete it"};
  return set_aside(entry, renamed).error();
}

/// Always an error: why, and where the file is now.
Status SpoolStore::set_aside(Entries::iterator entry, const Error& why) {
  const SpoolFolder::Name name{entry->first, entry->second.id};
  const std::string file = folder_->path_of(name).filename().string();
  const Status moved = folder_->set_aside(name);
  forget(entry);
  const std::string now =
      moved ? "set aside in " + std::string(SpoolFolder::kAside) + "/" : moved.error().message;
  return Error{why.code, file + " (" + now + "): " + why.message};
}

void SpoolStore::forget(Entries::iterator entry) {
  bytes_ -= entry->second.bytes;
  orders_.erase(entry->second.id);
  entries_.erase(entry);
}

Status SpoolStore::make_room(std::uint64_t bytes, const SubmapId& except, Thinned& went) {
  if (bytes > config_.most_bytes) {
    return Error{ErrorCode::exhausted, "a submap of " + std::to_string(bytes) +
                                           " bytes is more than the spool may take: raise "
                                           "--spool-mb"};
  }
  const auto is_full = [&] { return bytes_ + bytes > config_.most_bytes; };
  for (auto entry = entries_.begin(); is_full() && entry != entries_.end();) {
    const auto next = std::next(entry);
    if (!entry->second.thinned && entry->second.id != except) {
      if (Status thinned = thin_entry(entry, went); !thinned) return thinned;
    }
    entry = next;
  }
  for (auto entry = entries_.begin(); is_full() && entry != entries_.end();) {
    const auto next = std::next(entry);
    if (entry->second.id != except) {
      went.dropped.push_back(entry->second.id);
      if (Status removed = remove(entry->second.id); !removed) return removed;
    }
    entry = next;
  }
  return {};
}

Status SpoolStore::thin_entry(Entries::iterator entry, Thinned& went) {
  const SubmapId id = entry->second.id;
  auto kept = load(id);
  if (!kept) {  // Set aside: the entry is no more.
    went.refused.push_back(kept.error());
    return {};
  }
  entry->second.thinned = true;
  if (!thin(*kept)) return {};
  const auto bytes = write_kept(*kept, config_.owner, config_.coarseness);
  if (Status written = folder_->write({entry->first, id}, bytes); !written) return written;
  bytes_ = bytes_ - entry->second.bytes + bytes.size();
  entry->second.bytes = bytes.size();
  went.thinned.push_back(id);
  return {};
}

}  // namespace cairn::agent
