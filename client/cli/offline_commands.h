#pragma once

#include "client/cli/commands.h"
#include "client/cli/options.h"

namespace cairn::cli {

// Commands on a store. Each returns the program's exit code, or the error that ended it.

[[nodiscard]] Result<int> run(const ImportCommand& command, bool json, const Terminal& terminal);
[[nodiscard]] Result<int> run(const ExportCommand& command, bool json, const Terminal& terminal);
[[nodiscard]] Result<int> run(const InfoCommand& command, bool json, const Terminal& terminal);
[[nodiscard]] Result<int> run(const DrawStoreCommand& command, bool json, const Terminal& terminal);
[[nodiscard]] Result<int> run(const PlanOnStoreCommand& command, bool json,
                              const Terminal& terminal);
[[nodiscard]] Result<int> run(const ScenariosCommand& command, bool json, const Terminal& terminal);

/// [tiles] Larger sites are not drawn from a store: 0.5 GB of unpacked tiles.
inline constexpr std::size_t kMaxDrawnTiles = 40'000;

}  // namespace cairn::cli
