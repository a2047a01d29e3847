#include "proto/codec/frame.h"

#include <algorithm>
#include <boost/crc.hpp>
#include <string>

#include "proto/codec/bytes.h"
#include "proto/codec/record_codec.h"

namespace cairn::proto {
namespace {

constexpr std::uint8_t kMagic0 = 'C';
constexpr std::uint8_t kMagic1 = 'N';

Error refused(ErrorCode code, const std::string& what) {
  return {code, "malformed frame: " + what};
}

Status check_size(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kFrameHeaderBytes + kChecksumBytes || bytes.size() > kMaxFrameBytes) {
    return refused(ErrorCode::corrupt, std::to_string(bytes.size()) +
                                           " bytes long; check that only Cairn sends to this port");
  }
  return {};
}

Status check_checksum(std::span<const std::uint8_t> bytes) {
  ByteReader tail(bytes.last(kChecksumBytes));
  if (tail.get<std::uint32_t>() == crc32c(bytes.first(bytes.size() - kChecksumBytes))) return {};
  return refused(ErrorCode::corrupt, "wrong checksum; the carrier damaged it");
}

Result<FrameHeader> read_header(ByteReader& in, Direction expected_direction) {
  const bool ours = in.get<std::uint8_t>() == kMagic0 && in.get<std::uint8_t>() == kMagic1;
  if (!ours) return refused(ErrorCode::corrupt, "not Cairn's; check who sends to this port");
  const int version = in.get<std::uint8_t>();
  if (version != kProtocolVersion) {
    return refused(ErrorCode::unsupported_version,
                   "protocol version " + std::to_string(version) + ", this end speaks " +
                       std::to_string(kProtocolVersion) + "; update the older end");
  }
  if (in.get<std::uint8_t>() != static_cast<std::uint8_t>(expected_direction)) {
    return refused(ErrorCode::corrupt, "wrong direction; check the carrier's addresses");
  }
  FrameHeader header{.direction = expected_direction};
  header.session = in.get<std::uint32_t>();
  header.number = in.get<std::uint32_t>();
  return header;
}

Result<Record> read_next_record(ByteReader& in, Direction direction) {
  const auto type = in.get<std::uint8_t>();
  const auto length = in.get<std::uint16_t>();
  const auto body = in.take(length);
  if (in.failed()) return refused(ErrorCode::corrupt, "a record longer than the frame");
  return read_record(type, body, direction);
}

bool is_patch(const Record& record) {
  return std::holds_alternative<EvidencePatch>(record) || std::holds_alternative<MapPatch>(record);
}

Status read_records(ByteReader& in, Direction direction, std::vector<Record>& records) {
  while (in.left() > 0) {
    if (records.size() == kMaxFrameRecords) {
      return refused(ErrorCode::corrupt, "more than " + std::to_string(kMaxFrameRecords) +
                                             " records; check that both ends run the same version");
    }
    Result<Record> record = read_next_record(in, direction);
    if (!record) return record.error();
    records.push_back(*std::move(record));
    if (std::ranges::count_if(records, is_patch) > std::ptrdiff_t{kMaxFramePatches}) {
      return refused(ErrorCode::corrupt, "more than " + std::to_string(kMaxFramePatches) +
                                             " patches; check that both ends run the same version");
    }
  }
  return {};
}

}  // namespace

FrameWriter::FrameWriter(FrameHeader header) {
  bytes_.reserve(kMaxFrameBytes);
  ByteWriter out(bytes_);
  out.put(kMagic0);
  out.put(kMagic1);
  out.put(kProtocolVersion);
  out.put(static_cast<std::uint8_t>(header.direction));
  out.put(header.session);
  out.put(header.number);
}

bool FrameWriter::add(const Record& record) {
  if (records_ == kMaxFrameRecords) return false;
  if (is_patch(record) && patches_ == kMaxFramePatches) return false;
  const std::size_t before = bytes_.size();
  append_record(bytes_, record);
  const bool fits = size_bytes() <= kMaxFrameBytes;
  if (fits) ++records_;
  if (fits && is_patch(record)) ++patches_;
  if (!fits) bytes_.resize(before);
  return fits;
}

std::size_t FrameWriter::room_bytes() const {
  const std::size_t taken = size_bytes() + kRecordHeaderBytes;
  return records_ == kMaxFrameRecords || taken > kMaxFrameBytes ? 0 : kMaxFrameBytes - taken;
}

std::vector<std::uint8_t> FrameWriter::finish() && {
  const std::uint32_t checksum = crc32c(bytes_);
  ByteWriter(bytes_).put(checksum);
  return std::move(bytes_);
}

Result<Frame> decode_frame(std::span<const std::uint8_t> bytes, Direction expected_direction) {
  if (Status size = check_size(bytes); !size) return size.error();
  if (Status checksum = check_checksum(bytes); !checksum) return checksum.error();
  ByteReader in(bytes.first(bytes.size() - kChecksumBytes));
  const Result<FrameHeader> header = read_header(in, expected_direction);
  if (!header) return header.error();
  Frame frame{.header = *header, .records = {}};
  if (Status records = read_records(in, expected_direction, frame.records); !records) {
    return records.error();
  }
  return frame;
}

std::uint32_t crc32c(std::span<const std::uint8_t> bytes) {
  boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

std::optional<std::span<const std::uint8_t>> bare_frame(std::span<const std::uint8_t> frame,
                                                        Direction direction) {
  if (frame.size() < kFrameHeaderBytes + kChecksumBytes || !check_checksum(frame)) return {};
  ByteReader in(frame);
  const auto header = read_header(in, direction);
  if (!header || header->session == 0) return {};
  return frame.subspan(4, frame.size() - kFrameEndsBytes);
}

std::vector<std::uint8_t> whole_frame(std::span<const std::uint8_t> bare, Direction direction) {
  std::vector<std::uint8_t> frame;
  ByteWriter out(frame);
  out.put(kMagic0);
  out.put(kMagic1);
  out.put(kProtocolVersion);
  out.put(static_cast<std::uint8_t>(direction));
  out.put_bytes(bare);
  out.put(crc32c(frame));
  return frame;
}

}  // namespace cairn::proto
