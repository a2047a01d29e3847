// A frame that can be read is written again as the same records.

#include "proto/codec/frame.h"
#include "tests/fuzz/input.h"

using namespace cairn;

namespace {

void read(std::span<const std::uint8_t> bytes, proto::Direction direction) {
  const auto frame = proto::decode_frame(fuzz::with_checksum(bytes), direction);
  if (!frame) return;
  proto::FrameWriter writer(frame->header);
  for (const proto::Record& record : frame->records) fuzz::require(writer.add(record));
  const auto again = proto::decode_frame(std::move(writer).finish(), direction);
  fuzz::require(again.has_value() && again->header == frame->header &&
                again->records == frame->records);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  read({data, size}, proto::Direction::up);
  read({data, size}, proto::Direction::down);
  return 0;
}
