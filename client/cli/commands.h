#pragma once

#include <ostream>

#include "client/cli/options.h"

namespace cairn::cli {

/// Where a command writes.
struct Terminal {
  std::ostream& out;
  std::ostream& err;
  bool rewrites_lines = false;  ///< A terminal: progress stays on one line.
};

/// Carries out a command; returns the program's exit code. A failure is one line on `err`.
[[nodiscard]] int run(const Invocation& invocation, const Terminal& terminal);

}  // namespace cairn::cli
