#include "robot_agent/spool/kept_file.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "proto/codec/bytes.h"
#include "proto/codec/frame.h"
#include "proto/codec/patch.h"
#include "proto/codec/record_codec.h"
#include "proto/codec/text.h"

namespace cairn::agent {
namespace {

constexpr std::array<std::uint8_t, 4> kMagic = {'C', 'N', 'K', 'S'};
constexpr std::uint8_t kVersion = 2;
/// [bytes] Of a patch: far more than its bound of cells takes.
constexpr std::size_t kMaxPatchBytes = 32'768;
constexpr std::size_t kChecksumBytes = 4;

Error corrupt(const std::string& what) {
  return {ErrorCode::corrupt, what + "; nothing of it can be delivered: delete it"};
}

void put_name(proto::ByteWriter& out, const std::string& name) {
  assert(proto::valid_name(name));
  out.put(static_cast<std::uint8_t>(name.size()));
  for (const char c : name) out.put(static_cast<std::uint8_t>(c));
}

std::string get_name(proto::ByteReader& in) {
  const auto bytes = in.take(in.get<std::uint8_t>());
  std::string name(bytes.begin(), bytes.end());
  if (!proto::valid_name(name)) in.fail();
  return name;
}

proto::SubmapHead head_of(const proto::KeptSubmap& kept) {
  proto::SubmapHead head;
  head.sequence = kept.id.sequence;
  head.version = 1;
  head.T_site_submap = kept.T_site_submap;
  head.edition = kept.edition;
  head.link = kept.link;
  return head;
}

/// All blocks, in as many patches as it takes, each on an empty image.
void put_patches(std::vector<std::uint8_t>& bytes, const proto::KeptSubmap& kept,
                 const Coarseness& coarseness) {
  std::vector<proto::BlockUpdate> left = kept.blocks;
  while (!left.empty()) {
    const proto::PatchBytes patch =
        proto::write_patch(left, {kept.id.sequence, 0}, coarseness, {}, kMaxPatchBytes);
    assert(!patch.taken.empty() && patch.bytes.size() <= kMaxPatchBytes);
    proto::ByteWriter out(bytes);
    out.put(static_cast<std::uint16_t>(patch.bytes.size()));
    out.put_bytes(patch.bytes);
    for (auto taken = patch.taken.rbegin(); taken != patch.taken.rend(); ++taken) {
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(*taken));
    }
  }
}

Result<proto::SubmapHead> get_head(proto::ByteReader& in) {
  const auto type = in.get<std::uint8_t>();
  const auto record =
      proto::read_record(type, in.take(in.get<std::uint16_t>()), proto::Direction::up);
  const auto* head = record ? std::get_if<proto::SubmapHead>(&*record) : nullptr;
  if (head == nullptr || head->earlier || head->closed || head->sequence == 0) {
    return corrupt("its head is none");
  }
  return *head;
}

Status get_patches(proto::ByteReader& in, proto::KeptSubmap& kept) {
  while (in.left() > 0) {
    const auto patch = in.take(in.get<std::uint16_t>());
    auto blocks = proto::read_patch(patch, {kept.id.sequence, 0}, {});
    if (in.failed() || !blocks) return corrupt("a patch of it cannot be read");
    if (kept.blocks.size() + blocks->size() > proto::kMaxSubmapBlocks) {
      return corrupt("it has more blocks than a submap");
    }
    const bool whole = std::ranges::all_of(
        *blocks, [](const proto::BlockUpdate& block) { return block.base == 0; });
    if (!whole) return corrupt("a block of it is not whole");
    std::ranges::move(*blocks, std::back_inserter(kept.blocks));
  }
  return {};
}

Status check_frame(std::span<const std::uint8_t> bytes) {
  const std::size_t least = kMagic.size() + 1 + kChecksumBytes;
  if (bytes.size() < least || !std::ranges::equal(kMagic, bytes.first(kMagic.size()))) {
    return corrupt("it is no spooled submap");
  }
  if (bytes[kMagic.size()] != kVersion) {
    return Error{ErrorCode::unsupported_version,
                 "it is of version " + std::to_string(bytes[kMagic.size()]) +
                     " of the format, this agent reads version " + std::to_string(kVersion) +
                     ": deliver it with the agent that wrote it"};
  }
  proto::ByteReader checksum(bytes.last(kChecksumBytes));
  if (checksum.get<std::uint32_t>() != proto::crc32c(bytes.first(bytes.size() - kChecksumBytes))) {
    return corrupt("its checksum is wrong");
  }
  return {};
}

Status check_owner(proto::ByteReader& in, const SpoolOwner& owner) {
  const std::string robot = get_name(in);
  const std::string site = get_name(in);
  const int cell_size_mm = in.get<std::uint16_t>();
  if (in.failed()) return corrupt("its owner cannot be read");
  if (robot == owner.robot && site == owner.site && cell_size_mm == owner.cell_size_mm) return {};
  return Error{ErrorCode::conflict, "it is evidence of robot '" + robot + "' on site '" + site +
                                        "': to deliver it, move it to the spool of an agent with "
                                        "--robot " +
                                        robot + " --site " + site + " --cell-mm " +
                                        std::to_string(cell_size_mm)};
}

}  // namespace

std::vector<std::uint8_t> write_kept(const proto::KeptSubmap& kept, const SpoolOwner& owner,
                                     const Coarseness& coarseness) {
  std::vector<std::uint8_t> bytes;
  proto::ByteWriter out(bytes);
  out.put_bytes(kMagic);
  out.put(kVersion);
  put_name(out, owner.robot);
  put_name(out, owner.site);
  out.put(static_cast<std::uint16_t>(owner.cell_size_mm));
  out.put(kept.id.boot);
  proto::append_record(bytes, head_of(kept));
  put_patches(bytes, kept, coarseness);
  out.put(proto::crc32c(bytes));
  return bytes;
}

Result<proto::KeptSubmap> read_kept(std::span<const std::uint8_t> bytes, const SpoolOwner& owner) {
  if (Status sound = check_frame(bytes); !sound) return sound.error();
  proto::ByteReader in(bytes.first(bytes.size() - kChecksumBytes).subspan(kMagic.size() + 1));
  if (Status ours = check_owner(in, owner); !ours) return ours.error();
  proto::KeptSubmap kept;
  kept.id.boot = in.get<std::uint64_t>();
  const auto head = get_head(in);
  if (!head) return head.error();
  kept.id.sequence = head->sequence;
  kept.T_site_submap = head->T_site_submap;
  kept.edition = head->edition;
  kept.link = head->link;
  if (Status read = get_patches(in, kept); !read) return read.error();
  return kept;
}

bool thin(proto::KeptSubmap& kept) {
  return std::erase_if(kept.blocks, [](const proto::BlockUpdate& block) {
           return block.key.layer == EvidenceLayer::seen_through;
         }) > 0;
}

}  // namespace cairn::agent
