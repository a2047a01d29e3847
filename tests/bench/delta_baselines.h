#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "tests/bench/drive_deltas.h"

namespace cairn::bench {

/// Another way to write a delta, by a well-known library.
struct Baseline {
  std::string name;
  std::function<std::size_t(const Delta&)> size_bytes;
};

/// Those whose libraries were there when this was built; the names of the others in `absent`.
[[nodiscard]] std::vector<Baseline> delta_baselines(const Coarseness& coarseness,
                                                    std::vector<std::string>& absent);

}  // namespace cairn::bench
