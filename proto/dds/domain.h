#pragma once

#include "core/common/result.h"
#include "proto/dds/config.h"
#include "proto/dds/endpoint.h"
#include "proto/dds/entity.h"

namespace cairn::proto {

/// A DDS domain of this process with our settings, and the one participant in it. A process holds a
/// domain at most once.
struct DdsParticipant {
  DdsEntity domain;
  DdsEntity participant;
};

/// Resolves the endpoint's host and joins. conflict when the server's port or the domain is taken;
/// unavailable when the host name cannot be resolved now.
[[nodiscard]] Result<DdsParticipant> join_domain(const DdsEndpoint& endpoint, DdsRole role);

}  // namespace cairn::proto
