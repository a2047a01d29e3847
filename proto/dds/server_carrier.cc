#include "proto/dds/server_carrier.h"

#include "proto/codec/text.h"

namespace cairn::proto {
namespace {

// All robots share the reader: room for a burst of several.
constexpr int kReaderDepth = 1024;

}  // namespace

DdsServerCarrier::DdsServerCarrier(DdsParticipant dds, DdsEntity down_topic, FrameReader up)
    : dds_(std::move(dds)),
      down_(dds_.participant.get(), std::move(down_topic)),
      up_(std::move(up)) {}

Result<std::unique_ptr<DdsServerCarrier>> DdsServerCarrier::create(const DdsEndpoint& listen) {
  auto dds = join_domain(listen, DdsRole::server);
  if (!dds) return dds.error();
  const dds_entity_t participant = dds->participant.get();
  const auto up_topic = create_frame_topic(participant, kUpTopic);
  if (!up_topic) return up_topic.error();
  auto down_topic = create_frame_topic(participant, kDownTopic);
  if (!down_topic) return down_topic.error();
  auto up = FrameReader::create(participant, up_topic->get(), "*", kReaderDepth);
  if (!up) return up.error();
  return std::unique_ptr<DdsServerCarrier>(new DdsServerCarrier(
      std::move(dds).value(), std::move(down_topic).value(), std::move(up).value()));
}

Status DdsServerCarrier::send(const Datagram& frame) {
  if (auto size = check_frame_size(frame.bytes.size()); !size) return size;
  return down_.send(frame);
}

Result<std::optional<Datagram>> DdsServerCarrier::receive(std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    if (up_.writers_changed()) look_who_is_there();
    auto taken = up_.take();
    if (!taken) return taken.error();
    if (taken->has_value()) {
      if (auto robot = origin((*taken)->publication)) {
        return std::optional(Datagram{std::move(*robot), std::move((*taken)->bytes)});
      }
    }
    const auto left = deadline - std::chrono::steady_clock::now();
    if (left <= left.zero()) return std::optional<Datagram>();
    if (auto waited = up_.wait(left); !waited) return waited.error();
  }
}

void DdsServerCarrier::look_who_is_there() {
  decltype(origins_) there;
  std::set<std::string> robots;
  for (const dds_instance_handle_t publication : up_.writers(kMaxOrigins)) {
    if (auto robot = origin(publication)) {
      robots.insert(*robot);
      there.emplace(publication, std::move(*robot));
    }
  }
  origins_ = std::move(there);
  down_.serve(robots);
}

std::optional<std::string> DdsServerCarrier::origin(dds_instance_handle_t publication) {
  if (const auto known = origins_.find(publication); known != origins_.end()) return known->second;
  auto partition = up_.partition_of(publication);
  if (!partition || !valid_name(*partition)) return std::nullopt;
  if (origins_.size() < kMaxOrigins) origins_.emplace(publication, *partition);
  return partition;
}

}  // namespace cairn::proto
