#include "proto/dds/log.h"

#include <dds/ddsrt/log.h>

#include <algorithm>
#include <mutex>

namespace cairn::proto {
namespace {

struct Complaint {
  std::mutex mutex;
  std::string line;
};

// Never destroyed: Cyclone's threads may log until the process ends.
Complaint& complaint() {
  static auto* const kept = new Complaint;
  return *kept;
}

void keep(void* /*userdata*/, const dds_log_data_t* data) {
  constexpr std::size_t kMaxLine = 200;
  std::string line(data->message, std::min(data->size, kMaxLine));
  while (!line.empty() && (line.back() == '\n' || line.back() == '\0')) line.pop_back();
  const std::lock_guard lock(complaint().mutex);
  complaint().line = std::move(line);
}

}  // namespace

void quiet_dds_log() {
  static std::once_flag once;
  std::call_once(once, [] {
    dds_set_log_sink(keep, nullptr);
    dds_set_trace_sink(keep, nullptr);
    dds_set_log_mask(DDS_LC_FATAL | DDS_LC_ERROR | DDS_LC_WARNING);
  });
}

std::string last_dds_complaint() {
  const std::lock_guard lock(complaint().mutex);
  return complaint().line;
}

}  // namespace cairn::proto
