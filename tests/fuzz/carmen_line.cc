// A line of a robot log.

#include "robot_agent/input/carmen_line.h"

#include <algorithm>
#include <string>

#include "tests/fuzz/input.h"

using namespace cairn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string line(size, '\0');
  std::copy_n(data, size, line.begin());
  const auto message = agent::parse_carmen_line(line);
  if (message && *message) {
    fuzz::require((*message)->range_m.size() <= size);
  }
  return 0;
}
