#pragma once

#include <dds/dds.h>

#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "core/common/result.h"

namespace cairn::proto {

/// Owns one DDS entity; deleting it deletes what was made under it.
class DdsEntity {
 public:
  DdsEntity() = default;
  /// Takes what a dds_create_… function returned; its failure becomes an error that says `what`
  /// could not be made.
  static Result<DdsEntity> create(dds_entity_t created, std::string_view what);

  DdsEntity(DdsEntity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  DdsEntity& operator=(DdsEntity&& other) noexcept;
  DdsEntity(const DdsEntity&) = delete;
  DdsEntity& operator=(const DdsEntity&) = delete;
  ~DdsEntity() { release(); }

  [[nodiscard]] dds_entity_t get() const { return handle_; }

 private:
  explicit DdsEntity(dds_entity_t handle) : handle_(handle) {}
  void release();

  dds_entity_t handle_ = 0;
};

/// An io error: "DDS could not …: reason".
[[nodiscard]] Error dds_error(dds_return_t code, std::string_view could_not);

using DdsQos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

/// Best effort, volatile, keep-last `depth`, classic CDR: what every frame travels by.
[[nodiscard]] DdsQos frame_qos(int depth);
/// For publishers and subscribers. `partition` "*" sees all.
[[nodiscard]] DdsQos partition_qos(const std::string& partition);

}  // namespace cairn::proto
