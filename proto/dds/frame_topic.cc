#include "proto/dds/frame_topic.h"

#include <algorithm>

#include "cairn.h"
#include "proto/carrier.h"

namespace cairn::proto {
namespace {

// Writers hand frames to the network at once and keep none for a best-effort reader.
constexpr int kWriterDepth = 1;

using EndpointData =
    std::unique_ptr<dds_builtintopic_endpoint_t, decltype(&dds_builtintopic_free_endpoint)>;

struct Partitions {
  std::uint32_t count = 0;
  char** names = nullptr;

  explicit Partitions(const dds_qos_t* qos) {
    if (!dds_qget_partition(qos, &count, &names)) count = 0;
  }
  ~Partitions() {
    for (std::uint32_t i = 0; i < count; ++i) dds_free(names[i]);
    if (names != nullptr) dds_free(names);
  }
  Partitions(const Partitions&) = delete;
  Partitions& operator=(const Partitions&) = delete;
};

}  // namespace

Result<DdsEntity> create_frame_topic(dds_entity_t participant, const char* name) {
  return DdsEntity::create(
      dds_create_topic(participant, &cairn_wire_Frame_desc, name, nullptr, nullptr), "topic");
}

Result<FrameReader> FrameReader::create(dds_entity_t participant, dds_entity_t topic,
                                        const std::string& partition, int depth) {
  const DdsQos group = partition_qos(partition);
  auto subscriber =
      DdsEntity::create(dds_create_subscriber(participant, group.get(), nullptr), "subscriber");
  if (!subscriber) return subscriber.error();
  auto reader = DdsEntity::create(
      dds_create_reader(subscriber->get(), topic, frame_qos(depth).get(), nullptr), "reader");
  if (!reader) return reader.error();
  auto condition =
      DdsEntity::create(dds_create_readcondition(reader->get(), DDS_ANY_STATE), "condition");
  if (!condition) return condition.error();
  auto waitset = DdsEntity::create(dds_create_waitset(participant), "waitset");
  if (!waitset) return waitset.error();

  (void)dds_set_status_mask(reader->get(), DDS_SUBSCRIPTION_MATCHED_STATUS);
  for (const dds_entity_t woken_by : {reader->get(), condition->get()}) {
    const dds_return_t attached = dds_waitset_attach(waitset->get(), woken_by, 0);
    if (attached < 0) return dds_error(attached, "wait for frames");
  }
  FrameReader made;
  made.subscriber_ = std::move(subscriber).value();
  made.reader_ = std::move(reader).value();
  made.condition_ = std::move(condition).value();
  made.waitset_ = std::move(waitset).value();
  return made;
}

Result<std::optional<FrameReader::Taken>> FrameReader::take() {
  void* sample = nullptr;
  dds_sample_info_t info;
  const dds_return_t count = dds_take(reader_.get(), &sample, &info, 1, 1);
  if (count < 0) return dds_error(count, "take a frame");
  std::optional<Taken> taken;
  if (count == 1) {
    // Without valid data it only says that a writer has gone.
    if (info.valid_data) {
      const auto& bytes = static_cast<const cairn_wire_Frame*>(sample)->bytes;
      taken.emplace();
      taken->bytes.assign(bytes._buffer, bytes._buffer + bytes._length);
      taken->publication = info.publication_handle;
    }
    (void)dds_return_loan(reader_.get(), &sample, count);
  }
  return taken;
}

Status FrameReader::wait(std::chrono::nanoseconds timeout) {
  const dds_return_t woken = dds_waitset_wait(waitset_.get(), nullptr, 0, timeout.count());
  if (woken < 0) return dds_error(woken, "wait for frames");
  return {};
}

bool FrameReader::writers_changed() {
  std::uint32_t status = 0;
  (void)dds_take_status(reader_.get(), &status, DDS_SUBSCRIPTION_MATCHED_STATUS);
  return status != 0;
}

std::vector<dds_instance_handle_t> FrameReader::writers(std::size_t limit) const {
  std::vector<dds_instance_handle_t> handles(limit);
  const dds_return_t count = dds_get_matched_publications(reader_.get(), handles.data(), limit);
  handles.resize(count < 0 ? 0 : std::min(limit, static_cast<std::size_t>(count)));
  return handles;
}

std::optional<std::string> FrameReader::partition_of(dds_instance_handle_t publication) const {
  const EndpointData data(dds_get_matched_publication_data(reader_.get(), publication),
                          dds_builtintopic_free_endpoint);
  if (!data) return std::nullopt;
  const Partitions partitions(data->qos);
  if (partitions.count != 1) return std::nullopt;
  return std::string(partitions.names[0]);
}

Result<FrameTopicWriter> FrameTopicWriter::create(dds_entity_t participant, dds_entity_t topic,
                                                  const std::string& partition) {
  const DdsQos group = partition_qos(partition);
  auto publisher =
      DdsEntity::create(dds_create_publisher(participant, group.get(), nullptr), "publisher");
  if (!publisher) return publisher.error();
  auto writer = DdsEntity::create(
      dds_create_writer(publisher->get(), topic, frame_qos(kWriterDepth).get(), nullptr), "writer");
  if (!writer) return writer.error();
  FrameTopicWriter made;
  made.publisher_ = std::move(publisher).value();
  made.writer_ = std::move(writer).value();
  return made;
}

bool FrameTopicWriter::has_reader() const {
  dds_publication_matched_status_t status{};
  return dds_get_publication_matched_status(writer_.get(), &status) == DDS_RETCODE_OK &&
         status.current_count > 0;
}

Status FrameTopicWriter::write(std::span<const std::uint8_t> bytes) {
  const auto size = static_cast<std::uint32_t>(bytes.size());
  // dds_write only reads the sample; the C type has no const.
  const cairn_wire_Frame frame{
      {size, size, const_cast<std::uint8_t*>(bytes.data()), false}};  // NOLINT
  const dds_return_t written = dds_write(writer_.get(), &frame);
  if (written < 0) return dds_error(written, "send a frame");
  return {};
}

}  // namespace cairn::proto
