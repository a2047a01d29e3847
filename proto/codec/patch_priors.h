#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "proto/codec/bit_mixer.h"

/// The trained state that every patch begins with, as text in the sources
/// (patch_priors_table.inc, written by tests/bench/train_codec.cc).
namespace cairn::proto::patch {

/// A state that knows nothing: where training begins.
[[nodiscard]] MixerState blank_priors();

/// Two characters (12 bits) for each context: log odds in 1/16 nat and, as a class, on how many
/// bits they rest; then two for each weight, in 1/256.
[[nodiscard]] std::string priors_to_text(const MixerState& state);
/// What such text says; nullopt when it is not as long as the contexts and weights ask for.
[[nodiscard]] std::optional<MixerState> priors_from_text(std::string_view text);

}  // namespace cairn::proto::patch
