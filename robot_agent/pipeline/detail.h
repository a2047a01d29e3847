#pragma once

#include <optional>
#include <string_view>

#include "core/delta/coarseness.h"

namespace cairn::agent {

/// How much of what it maps a robot tells: how finely, and how often at most. On a link that cannot
/// carry it rounds become longer by themselves (EvidenceSender::begin_round).
struct Detail {
  Coarseness coarseness;
  double period_s = 1.0;  ///< [s] From one round of evidence to the next. [Limit: 0.05 … 600]

  friend bool operator==(const Detail&, const Detail&) = default;
};

inline constexpr Detail kFullDetail{};
/// For the thinnest links: heights still within 10 mm, but few levels of probability, and what
/// changes again and again travels once in five seconds.
inline constexpr Detail kRadioDetail{.coarseness = {.quantum_mm = 10, .levels = 4},
                                     .period_s = 5.0};

/// "full" or "radio"; nullopt for any other name.
[[nodiscard]] constexpr std::optional<Detail> detail_named(std::string_view name) {
  if (name == "full") return kFullDetail;
  if (name == "radio") return kRadioDetail;
  return std::nullopt;
}

}  // namespace cairn::agent
