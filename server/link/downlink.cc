#include "server/link/downlink.h"

#include <utility>

namespace cairn::server {

bool Downlink::should_ask(const proto::ServerLink& link, MonotonicTime now) {
  if (!link.map().idle()) return false;
  settle(link);
  if (asked_ || now < next_) return false;
  asked_ = true;
  next_ = now + kPeriod;
  return true;
}

/// The offer that was on its way has arrived whole.
void Downlink::settle(const proto::ServerLink& link) {
  if (!on_its_way_ || !link.map().idle()) return;
  auto told = std::make_shared<ToldMap>(*told_);
  for (const auto& [key, stamp] : on_its_way_->stamps) told->stamps[key] = stamp;
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
