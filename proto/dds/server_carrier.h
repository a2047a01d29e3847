#pragma once

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>

#include "proto/carrier.h"
#include "proto/dds/domain.h"
#include "proto/dds/frame_topic.h"
#include "proto/dds/robot_writers.h"

namespace cairn::proto {

/// The server's end of the DDS carrier: reads `cairn/up` in all partitions and writes `cairn/down`
/// in each robot's. `Datagram::peer` is the robot's id, taken from its writer's partition; frames
/// whose writer is not in exactly one valid partition are dropped.
class DdsServerCarrier final : public Carrier {
 public:
  /// conflict when the domain is already served on this machine. At most one carrier per domain and
  /// process.
  static Result<std::unique_ptr<DdsServerCarrier>> create(const DdsEndpoint& listen);

  /// unavailable while the robot is not in reach.
  Status send(const Datagram& frame) override;
  /// Also looks after who is in reach: must be called regularly.
  Result<std::optional<Datagram>> receive(std::chrono::milliseconds timeout) override;
  [[nodiscard]] std::size_t overhead_bytes() const override { return kDdsOverheadBytes; }

 private:
  /// Robots' writers known at a time: some robots may be there twice for a while after a restart.
  static constexpr std::size_t kMaxOrigins = 1024;

  DdsServerCarrier(DdsParticipant dds, DdsEntity down_topic, FrameReader up);
  void look_who_is_there();
  std::optional<std::string> origin(dds_instance_handle_t publication);

  DdsParticipant dds_;  // First, so that it is left last.
  RobotWriters down_;
  FrameReader up_;
  std::unordered_map<dds_instance_handle_t, std::string> origins_;
};

}  // namespace cairn::proto
