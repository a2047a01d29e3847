#pragma once

#include <memory>
#include <string>

#include "proto/carrier.h"
#include "proto/dds/domain.h"
#include "proto/dds/frame_topic.h"

namespace cairn::proto {

/// A robot's end of the DDS carrier: writes `cairn/up` and reads `cairn/down` in the partition
/// named after the robot. Finds the server, and finds it again after a restart, by itself.
class DdsRobotCarrier final : public Carrier {
 public:
  /// The server need not run yet. At most one carrier per domain and process.
  static Result<std::unique_ptr<DdsRobotCarrier>> create(const DdsEndpoint& server,
                                                         const std::string& robot);

  /// unavailable while no server has been found.
  Status send(const Datagram& frame) override;
  Result<std::optional<Datagram>> receive(std::chrono::milliseconds timeout) override;
  [[nodiscard]] std::size_t overhead_bytes() const override { return kDdsOverheadBytes; }

 private:
  DdsRobotCarrier(DdsParticipant dds, FrameTopicWriter up, FrameReader down)
      : dds_(std::move(dds)), up_(std::move(up)), down_(std::move(down)) {}

  DdsParticipant dds_;  // First, so that it is left last.
  FrameTopicWriter up_;
  FrameReader down_;
};

}  // namespace cairn::proto
