#include "proto/dds/entity.h"

namespace cairn::proto {

Result<DdsEntity> DdsEntity::create(dds_entity_t created, std::string_view what) {
  if (created < 0) return dds_error(created, "make a " + std::string(what));
  return DdsEntity(created);
}

DdsEntity& DdsEntity::operator=(DdsEntity&& other) noexcept {
  if (this != &other) {
    release();
    handle_ = std::exchange(other.handle_, 0);
  }
  return *this;
}

void DdsEntity::release() {
  if (handle_ > 0) (void)dds_delete(handle_);
  handle_ = 0;
}

Error dds_error(dds_return_t code, std::string_view could_not) {
  return {ErrorCode::io, "DDS could not " + std::string(could_not) + ": " + dds_strretcode(code)};
}

DdsQos frame_qos(int depth) {
  DdsQos qos(dds_create_qos(), dds_delete_qos);
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth);
  // Naming one representation keeps the list of them out of discovery.
  const dds_data_representation_id_t cdr = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(qos.get(), 1, &cdr);
  return qos;
}

DdsQos partition_qos(const std::string& partition) {
  DdsQos qos(dds_create_qos(), dds_delete_qos);
  dds_qset_partition1(qos.get(), partition.c_str());
  return qos;
}

}  // namespace cairn::proto
