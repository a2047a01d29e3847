// A path and directions around it that anybody may have sent.

#include "core/planner/corridor.h"

#include "tests/fuzz/input.h"

using namespace cairn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const int half_width = input.byte();
  const auto path = decode_path(input.stretch());
  if (!path) return 0;
  const auto again = decode_path(encode_path(*path));
  fuzz::require(again.has_value() && *again == *path);
  auto corridor = Corridor::along(*path, half_width);
  if (!corridor) return 0;
  Corridor copy = *corridor;
  if (!corridor->decode(input.rest())) return 0;
  auto bytes = corridor->encode();
  if (bytes.empty()) bytes.push_back(0);
  fuzz::require(copy.decode(bytes).has_value() && copy == *corridor);
  return 0;
}
