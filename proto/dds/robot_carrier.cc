#include "proto/dds/robot_carrier.h"

#include "proto/codec/text.h"

namespace cairn::proto {
namespace {

// A burst that outruns the reader of a busy robot; as much as the socket buffer holds, twice over.
constexpr int kReaderDepth = 1024;

}  // namespace

Result<std::unique_ptr<DdsRobotCarrier>> DdsRobotCarrier::create(const DdsEndpoint& server,
                                                                 const std::string& robot) {
  if (!valid_name(robot)) {
    return Error{ErrorCode::invalid_argument,
                 "robot id must be 1 to 32 of a-z, 0-9, _ and -, e.g. rover-1"};
  }
  auto dds = join_domain(server, DdsRole::robot);
  if (!dds) return dds.error();
  const dds_entity_t participant = dds->participant.get();
  // Writers and readers hold their topics: deleting ours here only gives up our name for them.
  const auto up_topic = create_frame_topic(participant, kUpTopic);
  if (!up_topic) return up_topic.error();
  const auto down_topic = create_frame_topic(participant, kDownTopic);
  if (!down_topic) return down_topic.error();
  auto down = FrameReader::create(participant, down_topic->get(), robot, kReaderDepth);
  if (!down) return down.error();
  auto up = FrameTopicWriter::create(participant, up_topic->get(), robot);
  if (!up) return up.error();
  return std::unique_ptr<DdsRobotCarrier>(
      new DdsRobotCarrier(std::move(dds).value(), std::move(up).value(), std::move(down).value()));
}

Status DdsRobotCarrier::send(const Datagram& frame) {
  if (auto size = check_frame_size(frame.bytes.size()); !size) return size;
  if (!up_.has_reader()) {
    return Error{ErrorCode::unavailable, "no server found over DDS yet: frames wait"};
  }
  return up_.write(frame.bytes);
}

Result<std::optional<Datagram>> DdsRobotCarrier::receive(std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    (void)down_.writers_changed();
    auto taken = down_.take();
    if (!taken) return taken.error();
    if (taken->has_value()) return std::optional(Datagram{"", std::move((*taken)->bytes)});
    const auto left = deadline - std::chrono::steady_clock::now();
    if (left <= left.zero()) return std::optional<Datagram>();
    if (auto waited = down_.wait(left); !waited) return waited.error();
  }
}

}  // namespace cairn::proto
