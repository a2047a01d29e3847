#pragma once

#include <vector>

#include "core/localization/refine.h"
#include "core/localization/registration.h"
#include "core/localization/search.h"

namespace cairn {

/// Lays a short-term map over the long-term map at the prior, lifted by `offset_mm`.
/// Requires: a usable prior and map, see register_map.
[[nodiscard]] MatchProblem make_problem(const HeightMap& short_term, const RegistrationPrior& prior,
                                        const HeightMap& long_term, const SearchWindow& window,
                                        const RegistrationConfig& config, int offset_mm = 0);

/// [mm] Median of what the long-term map is higher than the short-term map at a candidate; 0
/// without overlap.
[[nodiscard]] int median_offset_mm(const MatchProblem& problem, const Candidate& candidate);

/// The known cells as refinement wants them. `lowest` and `datum_mm` of the raster are the map's.
[[nodiscard]] std::vector<ShortTermCell> short_term_cells(const MatchRaster& short_term,
                                                          double cell_m,
                                                          const RegistrationPrior& prior);

/// The robot's place by the prior, and back to poses.
[[nodiscard]] RobotPlace robot_place(const RegistrationPrior& prior);
[[nodiscard]] Pose submap_pose(const RegistrationPrior& prior, const RobotPlace& place);
[[nodiscard]] Pose robot_pose(const RegistrationPrior& prior, const Pose& T_site_submap);

/// In cells of the map.
[[nodiscard]] FaceSearch face_search(double cell_m, const RegistrationConfig& config);

}  // namespace cairn
