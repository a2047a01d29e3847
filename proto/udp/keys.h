#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "core/common/result.h"
#include "proto/udp/packet.h"
#include "proto/udp/secret.h"

namespace cairn::proto {

/// Keys by robot id. A server's file holds those of all its robots, a robot's its own.
using RobotKeys = std::map<std::string, Secret>;

/// [keys] In one file.
inline constexpr std::size_t kMaxKeys = 4096;

/// Reads lines `ROBOT KEY` (key: 32 bytes in base64); empty ones and those that begin with # are
/// passed over. invalid_argument names the line that is wrong, and never quotes a key.
[[nodiscard]] Result<RobotKeys> parse_keys(std::string_view text);
/// The keys of a file that nobody but its owner may read.
[[nodiscard]] Result<RobotKeys> read_keys(const std::filesystem::path& file);
/// The robot's own key from its file.
[[nodiscard]] Result<Secret> read_key(const std::filesystem::path& file, const std::string& robot);

/// A fresh random key as a line of a key file.
[[nodiscard]] Result<std::string> new_key_line(const std::string& robot);

/// How a key is named on the wire without being told. Not secret, and the same every time.
[[nodiscard]] KeyId key_id(const Secret& key);

}  // namespace cairn::proto
