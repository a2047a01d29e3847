#include <gtest/gtest.h>

#include <fstream>
#include <iomanip>
#include <iterator>
#include <sstream>

#include "proto/codec/frame.h"
#include "tests/support/sample_records.h"

/// The bytes of one frame of each kind, as version 6 of the protocol fixes them: they may only
/// change together with kProtocolVersion and PROTOCOL.md.
namespace cairn::proto {
namespace {

std::string hex(const std::vector<std::uint8_t>& bytes) {
  std::ostringstream out;
  out << std::hex << std::setfill('0');
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const bool last_of_line = i % 16 == 15 || i + 1 == bytes.size();
    out << std::setw(2) << int{bytes[i]} << (last_of_line ? '\n' : ' ');
  }
  return out.str();
}

std::vector<std::uint8_t> unhex(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::uint8_t> out;
  for (unsigned byte = 0; in >> std::hex >> byte;) out.push_back(static_cast<std::uint8_t>(byte));
  return out;
}

std::string golden(const std::string& name) {
  std::ifstream in(std::string(CAIRN_GOLDEN_DIR) + "/proto/v6_" + name + ".hex");
  return {std::istreambuf_iterator<char>(in), {}};
}

class GoldenFrame : public ::testing::TestWithParam<testing::Sample> {};

TEST_P(GoldenFrame, IsWrittenToTheSameBytes) {
  EXPECT_EQ(hex(testing::frame_of(GetParam())), golden(GetParam().name));
}

TEST_P(GoldenFrame, IsReadToTheSameRecord) {
  const auto frame = decode_frame(unhex(golden(GetParam().name)), GetParam().direction);
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(frame->header, (FrameHeader{GetParam().direction, 0x01020304, 5}));
  ASSERT_EQ(frame->records.size(), 1U);
  EXPECT_TRUE(testing::same(frame->records[0], GetParam().record));
}

INSTANTIATE_TEST_SUITE_P(Every, GoldenFrame, ::testing::ValuesIn(testing::sample_records()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace cairn::proto
