#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

/// What dds_echo sends at full speed, and how its receiver tells the frames apart.
namespace cairn::proto {

inline constexpr std::string_view kFloodRequest = "flood";
/// So few that the smallest receive buffer of a usual kernel (208 KiB, counted with its overhead)
/// holds them all: a receiver that gets no processor time loses none.
inline constexpr std::uint32_t kFloodFrames = 128;
inline constexpr std::size_t kFloodFrameBytes = 400;

[[nodiscard]] inline std::vector<std::uint8_t> flood_frame(std::uint32_t number) {
  std::vector<std::uint8_t> bytes(kFloodFrameBytes, 0xF1);
  bytes[0] = static_cast<std::uint8_t>(number);
  bytes[1] = static_cast<std::uint8_t>(number >> 8);
  return bytes;
}

[[nodiscard]] inline bool is_flood_frame(const std::vector<std::uint8_t>& bytes) {
  return bytes.size() == kFloodFrameBytes && bytes.back() == 0xF1;
}

}  // namespace cairn::proto
