#pragma once

#include <cstdint>
#include <vector>

#include "core/map/height_map.h"
#include "core/map/sensor_model.h"
#include "core/sensor/laser.h"

namespace cairn {

/// The cell after a hit at `height_mm` (T4.3): unknown or lower than the hit by more than the
/// tolerance → the hit replaces it; within the tolerance → probabilities combine (Eq. 1) and the
/// height is the running mean of the surface's hits; hits lower than that are ignored.
[[nodiscard]] Cell after_hit(const Cell& cell, std::int32_t height_mm, const SensorModel& model);

/// The cell after a beam passed through its column at `beam_height_mm` (T4.3): if that is below
/// the stored height by more than the tolerance the probability falls, and below the model's
/// minimum the cell is unknown again; else nothing changes.
[[nodiscard]] Cell after_pass(const Cell& cell, std::int32_t beam_height_mm,
                              const SensorModel& model);

/// What one scan did to a map.
struct ScanEffect {
  std::vector<CellIndex> changed;    ///< Each cell once; its value differs from before the scan.
  std::int64_t beams = 0;            ///< Beams integrated.
  std::int64_t unrepresentable = 0;  ///< Hits too far from their tile's datum to be stored.
};

/// A beam passing low over a surface that another map believes in (see SeenThrough).
struct Contradiction {
  CellIndex cell;
  std::int32_t beam_height_mm = 0;
};

/// Integrates a scan into `map` by the rules of T4.3. First every beam's free part (cells with a
/// hit in this same scan, and the beam's last cell, are spared: a beam that grazes a wall must not
/// erase it), then the hits. With `ground_along_beam` the free part also counts as hits on the
/// ground at `ground_height_mm`.
/// `reference` may be null; where a beam passes below a known surface of it by more than the
/// tolerance, a contradiction is appended to `contradictions` (at most one per cell and scan).
ScanEffect integrate_scan(HeightMap& map, const std::vector<Beam>& beams, const SensorModel& model,
                          bool ground_along_beam, std::int32_t ground_height_mm,
                          const HeightMap* reference, std::vector<Contradiction>* contradictions);

}  // namespace cairn
