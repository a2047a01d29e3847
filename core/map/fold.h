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

/// The tiles of the site that one tile of a submap can touch, sorted.
[[nodiscard]] std::vector<TileKey> site_tiles_under(const TileKey& submap_tile,
                                                    const Submap& submap);

/// Folds what a submap says about one tile of the long-term map into it (T2.2.3: the short-term
/// map, once placed, is combined with the long-term map). Per cell, first what was seen through: a
/// stored surface above it loses probability (Eq. 1), down to unknown; then the submap's surface by
/// the rules of `after_hit`, with the submap's probability in place of one hit's and the mean
/// weighted by how many hits each probability stands for. The site cell takes the submap cell
/// under its middle, so a submap that is shifted by whole cells and not turned folds exactly.
/// Deterministic to the bit, on every machine. Between submaps that share no cell the order does
/// not matter to the cells.
/// `tile` is empty when nothing is known there; it is made when needed, with the datum of its first
/// height, and stays when all in it is unlearned. Heights that fit no tile or not this one, and
/// tiles and poses beyond HeightMap::kMaxExtentM, are skipped.
/// Returns whether anything changed, in which case `tile` is not empty.
/// Requires: a sound model; the submap's cells are as large as the site's.
bool fold_into_tile(std::optional<Tile>& tile, const TileKey& key, const Submap& submap,
                    const SensorModel& model);

/// Folds a whole submap, which has the site's cell size; returns the tiles that changed, sorted.
std::vector<TileKey> fold(HeightMap& site, const Submap& submap, const SensorModel& model);

}  // namespace cairn
