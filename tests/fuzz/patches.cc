// Patches, one after the other, by a receiver and by themselves. Time and memory are bounded by the
// fuzzer's own limits.

#include "proto/codec/patch.h"
#include "proto/sync/patch_receiver.h"
#include "tests/fuzz/input.h"

using namespace cairn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  proto::PatchReceiver receiver;
  for (std::uint32_t number = 1; !input.empty() && number < 16; ++number) {
    proto::EvidencePatch patch;
    patch.sequence = 1 + input.byte() % 4U;
    patch.ground.epoch = input.byte();
    patch.ground.before = input.byte();
    for (int i = input.byte() % 4; i > 0; --i) {
      patch.ground.back.push_back(std::max(input.byte(), std::uint8_t{1}));
    }
    patch.tick = input.byte();
    const auto bytes = input.stretch();
    patch.bytes.assign(bytes.begin(), bytes.end());
    const auto reading = receiver.read(number, patch);
    fuzz::require(reading.blocks.size() <= proto::kMaxPatchBlocks);
  }
  return 0;
}
