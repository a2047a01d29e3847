#pragma once

#include <string>
#include <string_view>

namespace cairn::proto {

/// Whether this may name a robot or a site: 1 … kMaxNameBytes of [a-z0-9_-].
[[nodiscard]] bool valid_name(std::string_view name);

/// The text as it may travel: cut to kMaxTextBytes between code points, control characters as
/// spaces, bytes that are not UTF-8 as '?'.
[[nodiscard]] std::string wire_text(std::string_view text);

/// Whether a peer could have sent this text: wire_text(text) == text.
[[nodiscard]] bool valid_text(std::string_view text);

}  // namespace cairn::proto
