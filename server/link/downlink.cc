#include "server/link/downlink.h"

#include <algorithm>
#include <utility>

namespace cairn::server {

bool Downlink::should_ask(const proto::ServerLink& link, MonotonicTime now) {
  if (!listens_until_) listens_until_ = now + kFirstWord;
  if (comparing_ > 0 || (!heard_all_ && now < *listens_until_)) return false;
  if (!link.map().idle()) return false;
  settle(link);
  if (asked_ || now < next_) return false;
  asked_ = true;
  next_ = now + kPeriod;
  return true;
}

void Downlink::hear(const proto::MapDigest& digest, MonotonicTime now) {
  heard_all_ = heard_all_ || digest.last;
  listens_until_ = now + kNextWord;
  ++comparing_;
}

void Downlink::take(const std::vector<ComparedTile>& compared) {
  --comparing_;
  auto told = std::make_shared<ToldMap>(*told_);
  for (const ComparedTile& tile : compared) {
    const auto known = told->stamps.find(tile.key);
    const std::uint64_t stamp = known == told->stamps.end() ? 0 : known->second;
    const bool under_way = on_its_way_ && on_its_way_->stamps.contains(tile.key);
    if (tile.same) {
      told->stamps[tile.key] = std::max(stamp, tile.stamp);
      told->differs.erase(tile.key);
    } else if (stamp >= tile.stamp && !under_way) {
      told->differs.insert(tile.key);
    }
  }
  told_ = std::move(told);
}

/// The offer that was on its way has arrived whole.
void Downlink::settle(const proto::ServerLink& link) {
  if (!on_its_way_ || !link.map().idle()) return;
  auto told = std::make_shared<ToldMap>(*told_);
  for (const auto& [key, stamp] : on_its_way_->stamps) told->stamps[key] = stamp;
  for (const auto& [key, stamp] : on_its_way_->stamps) told->differs.erase(key);
  told->edition = on_its_way_->edition;
  told_ = std::move(told);
  on_its_way_.reset();
}

void Downlink::take(PreparedOffer prepared, proto::ServerLink& link) {
  asked_ = false;
  if (prepared.empty() && prepared.told.edition == told_->edition) return;
  link.map().offer(prepared.offer);
  on_its_way_ = std::move(prepared.told);
}

}  // namespace cairn::server
