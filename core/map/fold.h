#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/map/sensor_model.h"
#include "core/map/submap.h"
#include "core/map/tile.h"

namespace cairn {

/// The tiles of the site that a submap can touch, each once, sorted.
[[nodiscard]] std::vector<TileKey> touched_tiles(const Submap& submap);

/// Folds what a submap says about one tile of the long-term map into it (T2.2.3: the short-term
/// map, once placed, is combined with the long-term map). Per cell, first what was seen through: a
/// stored surface above it loses probability (Eq. 1), down to unknown; then the submap's surface by
/// the rules of `after_hit`, with the submap's probability in place of one hit's and the mean
/// weighted by how many hits each probability stands for. The site cell takes the submap cell
/// under its middle, so a submap that is shifted by whole cells and not turned folds exactly.
/// Deterministic to the bit. `tile` is empty when nothing is known there; it is made when needed.
/// Returns whether anything changed.
bool fold_into_tile(std::optional<Tile>& tile, const TileKey& key, const Submap& submap,
                    const SensorModel& model);

/// Folds a whole submap; returns the tiles that changed, sorted.
std::vector<TileKey> fold(HeightMap& site, const Submap& submap, const SensorModel& model);

}  // namespace cairn
