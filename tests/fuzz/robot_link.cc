// A robot in the hands of a server that says anything.

#include "proto/sync/robot_link.h"

#include "tests/fuzz/input.h"

using namespace cairn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  proto::RobotLink link({.robot = "rover", .site = "quarry", .boot = 7}, 28);
  Submap& submap = link.evidence().begin(7, {}, 125);
  submap.surface.set({1, 2}, {10, 200});
  link.evidence().touch(EvidenceLayer::surface, {{1, 2}});
  MonotonicTime now = std::chrono::seconds(1);
  proto::FrameWriter welcome({.direction = proto::Direction::down, .session = 0, .number = 1});
  welcome.add(proto::Welcome{.session = 9, .boot = 7, .epoch = 3});
  (void)link.next_frame(now);
  (void)link.on_frame(std::move(welcome).finish(), now);
  while (!input.empty()) {
    now += std::chrono::milliseconds(10 * input.byte());
    (void)link.on_frame(fuzz::with_checksum(input.stretch()), now);
    (void)link.take_map_updates();
    for (int i = 0; i < 4 && link.next_frame(now); ++i) {
    }
  }
  return 0;
}
