// A server's session in the hands of a robot that says anything.

#include "proto/sync/server_link.h"

#include "tests/fuzz/input.h"

using namespace cairn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const proto::Hello hello{.robot = "rover", .site = "quarry", .boot = 7, .cell_size_mm = 125};
  MonotonicTime now = std::chrono::seconds(1);
  proto::ServerLink link(9, hello, 3, 28, now);
  while (!input.empty()) {
    now += std::chrono::milliseconds(10 * input.byte());
    const auto bytes = fuzz::with_checksum(input.stretch());
    const auto frame = proto::decode_frame(bytes, proto::Direction::up);
    if (frame && frame->header.session == link.session()) {
      for (const auto& event : link.on_frame(*frame, bytes.size(), now)) {
        const auto* evidence = std::get_if<proto::ServerLink::Evidence>(&event);
        if (evidence != nullptr) link.durable(evidence->number);
      }
    }
    for (int i = 0; i < 4 && now >= link.next_due(now); ++i) {
      if (!link.next_frame(now)) break;
    }
  }
  return 0;
}
