#include "core/localization/site_ground.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/localization/match_raster.h"
#include "core/localization/raster_surroundings.h"

namespace cairn {
namespace {

/// [units] What match_raster.h calculates with.
constexpr int kRasterLimit = kMatchLimitMm;
constexpr int kFinestUnitMm = 4;
constexpr int kCoarsestUnitMm = 20;

struct HeightRange {
  std::int32_t lowest_mm = std::numeric_limits<std::int32_t>::max();
  std::int32_t highest_mm = std::numeric_limits<std::int32_t>::min();
};

/// Calls visit(cell, height_mm) for the known cells of level 0 in a box.
template <class Visit>
void visit_known(const HeightMap& map, const MapBox& box, const Visit& visit) {
  for (const auto& [key, tile] : map.tiles()) {
    if (key.level != 0) continue;
    for (int i = 0; i < Tile::kCells; ++i) {
      if (!tile->known(i)) continue;
      const CellIndex cell{key.tx * Tile::kSize + i % Tile::kSize,
                           key.ty * Tile::kSize + i / Tile::kSize};
      const bool inside = cell.x >= box.lowest.x && cell.x <= box.highest.x &&
                          cell.y >= box.lowest.y && cell.y <= box.highest.y;
      if (inside) visit(cell, tile->height_mm(i));
    }
  }
}

/// The part of `box` that matters for a disc; may be empty (lowest above highest).
MapBox clipped(MapBox box, const SiteDisc& disc, int margin, double cell_m) {
  const auto cell = [&](double m) {
    constexpr double kFar = 1e9;
    return static_cast<std::int32_t>(std::clamp(std::floor(m / cell_m), -kFar, kFar));
  };
  box.lowest.x = std::max(box.lowest.x, cell(disc.x_m - disc.radius_m) - margin);
  box.lowest.y = std::max(box.lowest.y, cell(disc.y_m - disc.radius_m) - margin);
  box.highest.x = std::min(box.highest.x, cell(disc.x_m + disc.radius_m) + margin);
  box.highest.y = std::min(box.highest.y, cell(disc.y_m + disc.radius_m) + margin);
  return box;
}

/// The map's heights in units above the datum, unknown ones as kUnknownInLong.
MatchRaster raster_of(const HeightMap& map, const MapBox& box, int margin, int unit_mm,
                      std::int32_t datum_mm) {
  MatchRaster raster;
  raster.lowest = {box.lowest.x - margin, box.lowest.y - margin};
  raster.width = box.highest.x - box.lowest.x + 1 + 2 * margin;
  raster.height = box.highest.y - box.lowest.y + 1 + 2 * margin;
  raster.datum_mm = datum_mm;
  raster.height_mm.assign(
      static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height),
      raster.unknown);
  visit_known(map, box, [&](CellIndex cell, std::int32_t height_mm) {
    const double units = std::round(static_cast<double>(height_mm - datum_mm) / unit_mm);
    raster.height_mm[raster.index(cell.x - raster.lowest.x, cell.y - raster.lowest.y)] =
        static_cast<std::int16_t>(units);
  });
  return raster;
}

/// How many cells of a square of five cells' side around each are known.
std::vector<std::uint8_t> known_around(const MatchRaster& raster) {
  constexpr int kReach = 2;
  const auto sums = [&](const std::vector<std::uint8_t>& in, int count, int lines, std::size_t step,
                        std::size_t line_step) {
    std::vector<std::uint8_t> out(in.size(), 0);
    for (int line = 0; line < lines; ++line) {
      const std::size_t first = static_cast<std::size_t>(line) * line_step;
      for (int i = 0; i < count; ++i) {
        int sum = 0;
        for (int k = std::max(i - kReach, 0); k <= std::min(i + kReach, count - 1); ++k) {
          sum += in[first + static_cast<std::size_t>(k) * step];
        }
        out[first + static_cast<std::size_t>(i) * step] = static_cast<std::uint8_t>(sum);
      }
    }
    return out;
  };
  std::vector<std::uint8_t> known(raster.height_mm.size());
  for (std::size_t i = 0; i < known.size(); ++i) {
    known[i] = raster.height_mm[i] != raster.unknown ? 1 : 0;
  }
  const auto width = static_cast<std::size_t>(raster.width);
  return sums(sums(known, raster.width, raster.height, 1, width), raster.height, raster.width,
              width, 1);
}

/// Reads single cells, all in units.
class Reader {
 public:
  Reader(const MatchRaster& raster, const SiteGroundConfig& config, int unit_mm, double cell_m)
      : raster_(raster), around_(known_around(raster)) {
    const auto units = [unit_mm](int mm) { return static_cast<std::int16_t>(mm / unit_mm); };
    truncate_ = units(config.truncate_mm);
    unknown_ = units(config.unknown_mm);
    face_ = units(config.face_mm);
    above_face_ = units(config.above_face_mm);
    below_lone_ = units(config.below_lone_mm);
    floor_ = units(config.floor_mm);
    const auto cells = [cell_m](double m) { return static_cast<int>(std::lround(m / cell_m)); };
    const int reach = cells(config.ground_reach_m);
    ground_ = ground_under(raster, {reach, cells(2.0), units(350)});
  }

  [[nodiscard]] HeightSpan span(std::size_t i) const {
    constexpr int kThin = 11;  // Of 25 cells: a line of them, not an area.
    const std::int16_t height = raster_.height_mm[i];
    if (height == raster_.unknown) return {kNoHeight, -kNoHeight, unknown_};
    const int ground = ground_[i];
    if (height - ground > face_)
      return {limited(ground + face_), limited(height + above_face_), truncate_};
    if (around_[i] > kThin) return {height, height, truncate_};
    return {limited(std::min<int>(ground, height - below_lone_)), limited(height + above_face_),
            truncate_};
  }

  [[nodiscard]] FloorSpan floor(std::size_t i) const {
    const std::int16_t height = raster_.height_mm[i];
    if (height == raster_.unknown || height - ground_[i] > floor_) return {};
    return {height, height};
  }

 private:
  static std::int16_t limited(int height) {
    return static_cast<std::int16_t>(std::clamp<int>(height, -kFarthestHeight, kFarthestHeight));
  }

  const MatchRaster& raster_;
  std::vector<std::uint8_t> around_;
  std::vector<std::int16_t> ground_;
  std::int16_t truncate_, unknown_, face_, above_face_, below_lone_, floor_;
};

FloorSpan joined(const FloorSpan& a, const FloorSpan& b) {
  return {std::min(a.lowest, b.lowest), std::max(a.highest, b.highest)};
}

/// All that lies within a square of `reach` cells either way.
SiteGrid<FloorSpan> widened(const SiteGrid<FloorSpan>& floor, int reach) {
  SiteGrid<FloorSpan> rows(floor.width, floor.height);
  SiteGrid<FloorSpan> wide(floor.width, floor.height);
  for (int y = 0; y < floor.height; ++y) {
    for (int x = 0; x < floor.width; ++x) {
      for (int u = std::max(x - reach, 0); u <= std::min(x + reach, floor.width - 1); ++u) {
        rows.at(x, y) = joined(rows.at(x, y), floor.at(u, y));
      }
    }
  }
  for (int y = 0; y < floor.height; ++y) {
    for (int v = std::max(y - reach, 0); v <= std::min(y + reach, floor.height - 1); ++v) {
      for (int x = 0; x < floor.width; ++x) {
        wide.at(x, y) = joined(wide.at(x, y), rows.at(x, v));
      }
    }
  }
  return wide;
}

/// Where a robot can stand: near what it can stand on, also where the map has a small hole.
SiteGrid<FloorSpan> floor_near(const SiteGrid<FloorSpan>& floor, int reach, int far_reach) {
  SiteGrid<FloorSpan> near = widened(floor, reach);
  const SiteGrid<FloorSpan> far = widened(floor, far_reach);
  for (std::size_t i = 0; i < near.cells.size(); ++i) {
    if (!near.cells[i].any()) near.cells[i] = far.cells[i];
  }
  return near;
}

HeightRange range_of(const HeightMap& map, const MapBox& box) {
  HeightRange range;
  visit_known(map, box, [&](CellIndex, std::int32_t height_mm) {
    range.lowest_mm = std::min(range.lowest_mm, height_mm);
    range.highest_mm = std::max(range.highest_mm, height_mm);
  });
  return range;
}

/// Fine as long as the heights fit.
int unit_for(std::int64_t relief_mm) {
  constexpr std::int64_t kUnits = std::int64_t{2} * kRasterLimit;
  return std::max(kFinestUnitMm, static_cast<int>((relief_mm + kUnits - 1) / kUnits));
}

/// The part of the map to read; none, with the reason, where there is nothing or too much.
std::optional<MapBox> box_to_read(const HeightMap& map, int margin,
                                  const std::optional<SiteDisc>& disc, std::string& why) {
  auto box = known_box(map);
  if (box && disc) box = clipped(*box, *disc, margin, map.cell_size_m());
  if (!box || box->lowest.x > box->highest.x || box->lowest.y > box->highest.y) {
    why = "the long-term map is empty there";
    return std::nullopt;
  }
  const std::int64_t width = std::int64_t{box->highest.x} - box->lowest.x + 1;
  const std::int64_t height = std::int64_t{box->highest.y} - box->lowest.y + 1;
  if (std::max(width, height) > kMaxSiteCells) {
    why = "the site is too large to be searched at once; give a disc";
    return std::nullopt;
  }
  return box;
}

SiteGround ground_from(const MatchRaster& raster, int margin, int unit_mm, double cell_m,
                       const SiteGroundConfig& config) {
  SiteGround site;
  site.lowest = raster.lowest;
  site.margin = margin;
  site.unit_mm = unit_mm;
  site.datum_mm = raster.datum_mm;
  site.truncate = static_cast<std::int16_t>(config.truncate_mm / unit_mm);
  site.above_face = static_cast<std::int16_t>(config.above_face_mm / unit_mm);
  site.heights = SiteGrid<HeightSpan>(raster.width, raster.height);
  SiteGrid<FloorSpan> floor(raster.width, raster.height);
  const Reader reader(raster, config, unit_mm, cell_m);
  for (std::size_t i = 0; i < floor.cells.size(); ++i) {
    site.heights.cells[i] = reader.span(i);
    floor.cells[i] = reader.floor(i);
  }
  const auto cells = [&](double m) { return static_cast<int>(std::lround(m / cell_m)); };
  site.floor = floor_near(floor, cells(config.floor_reach_m), cells(config.far_floor_reach_m));
  return site;
}

}  // namespace

std::optional<SiteGround> read_site_ground(const HeightMap& map, int margin,
                                           const std::optional<SiteDisc>& disc,
                                           const SiteGroundConfig& config, std::string& why) {
  const std::optional<MapBox> box = box_to_read(map, margin, disc, why);
  if (!box) return std::nullopt;
  const HeightRange range = range_of(map, *box);
  const std::int64_t relief_mm = std::int64_t{range.highest_mm} - range.lowest_mm;
  if (relief_mm < 0) {
    why = "the long-term map is empty there";
    return std::nullopt;
  }
  const int unit_mm = unit_for(relief_mm);
  if (unit_mm > kCoarsestUnitMm) {
    why = "the site's heights differ too much";
    return std::nullopt;
  }
  const auto datum_mm = static_cast<std::int32_t>(range.lowest_mm + relief_mm / 2);
  return ground_from(raster_of(map, *box, margin, unit_mm, datum_mm), margin, unit_mm,
                     map.cell_size_m(), config);
}

}  // namespace cairn
