// A spooled submap, as it is and with its checksum mended so that the rest is looked at; what can
// be read is taken up.

#include "robot_agent/spool/kept_file.h"
#include "tests/fuzz/input.h"

using namespace cairn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const agent::SpoolOwner owner{"r1", "lab", 125};
  (void)agent::read_kept({data, size}, owner);
  const auto kept = agent::read_kept(fuzz::with_checksum({data, size}), owner);
  if (!kept) return 0;
  proto::EvidenceSender sender;
  if (!sender.adopt(*kept, kept->id.boot + 1, owner.cell_size_mm)) return 0;
  const auto copy = sender.copy_of(kept->id);
  fuzz::require(copy && copy->blocks.size() == kept->blocks.size());
  fuzz::require(agent::read_kept(agent::write_kept(*copy, owner, {}), owner).has_value());
  return 0;
}
