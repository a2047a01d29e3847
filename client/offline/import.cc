#include "client/offline/import.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <utility>

#include "client/map_files/map_file.h"
#include "core/delta/block.h"

namespace cairn::offline {

namespace {

using map_files::HeightRaster;
using map_files::RasterFrame;

/// [cells] A side of a submap: four tiles, about as much as robots gather in one.
constexpr int kSubmapCells = 4 * Tile::kSize;
/// [blocks] Written in one transaction: well below what a world stages.
constexpr std::size_t kBlocksPerCommit = 4096;
static_assert(kBlocksPerCommit + kSubmapCells * kSubmapCells / kBlockCells <
              server::World::kMaxStagedBlocks);

Error about(const std::string& file, const std::string& what) {
  return {ErrorCode::invalid_argument, file + ": " + what};
}

/// [mm] Whole, from 10 to 2000.
Result<int> cell_size_of(const ImportRequest& request, const RasterFrame& frame) {
  const bool counts_in_cells =
      map_files::kind_of(request.map_file).value() == map_files::MapFileKind::movingai;
  const double usual_m = counts_in_cells ? 1.0 : 0.0;
  const double cell_m = frame.cell_m > 0.0 ? frame.cell_m : request.cell_m.value_or(usual_m);
  if (!(cell_m > 0.0)) {
    return about(request.map_file, "does not tell its cell size: give it with --cell-size METRES");
  }
  if (frame.cell_m > 0.0 && request.cell_m && std::abs(*request.cell_m - frame.cell_m) > 1e-6) {
    return about(request.map_file, "tells a cell size of " + std::to_string(frame.cell_m) +
                                       " m itself: leave --cell-size out");
  }
  const auto cell_mm = static_cast<int>(std::lround(std::min(cell_m, 1e6) * 1000.0));
  if (cell_mm < 10 || cell_mm > 2000) {
    return about(request.map_file, "has cells of " + std::to_string(cell_m) +
                                       " m; sites have cells of 0.01 to 2 m: resample it");
  }
  if (std::abs(cell_mm - cell_m * 1000.0) > 1e-3) {
    return about(request.map_file, "has cells of " + std::to_string(cell_m) +
                                       " m; a site's are whole millimetres: resample it");
  }
  return cell_mm;
}

bool near_the_origin(const RasterFrame::Corner& corner) {
  constexpr double kMostM = HeightMap::kMaxExtentM;
  return std::abs(corner.x_m) <= kMostM && std::abs(corner.y_m) <= kMostM;
}

Result<OpenStore> store_for(const ImportRequest& request, int cell_mm) {
  std::error_code ignored;
  if (!std::filesystem::exists(request.store, ignored)) {
    const std::string stem = std::filesystem::path(request.store).stem().string();
    return found_store(request.store, request.name.value_or(stem), cell_mm);
  }
  auto store = open_store(request.store);
  if (!store) return store;
  const server::SiteInfo& info = store->store->site();
  if (info.cell_size_mm != cell_mm) {
    return about(request.map_file, "has cells of " + std::to_string(cell_mm) +
                                       " mm, the site's have " + std::to_string(info.cell_size_mm) +
                                       ": resample it, or import it into a site of its own");
  }
  if (request.name && *request.name != info.name) {
    return about(request.store,
                 "is the site " + info.name + " already: leave --name out, or name another store");
  }
  return store;
}

/// Where the raster's south-west corner lies in the site.
Result<SubmapPose> place_in(const ImportRequest& request, const RasterFrame::Corner& offset,
                            const RasterFrame& frame, int cell_mm) {
  RasterFrame::Corner corner = frame.south_west.value_or(offset);
  corner = {corner.x_m - offset.x_m, corner.y_m - offset.y_m};
  double z_m = 0.0;
  if (request.origin_m) {
    corner = {(*request.origin_m)[0], (*request.origin_m)[1]};
    z_m = (*request.origin_m)[2];
  }
  const double diagonal_m = std::hypot(frame.columns, frame.rows) * cell_mm / 1000.0;
  const RasterFrame::Corner far = {std::abs(corner.x_m) + diagonal_m,
                                   std::abs(corner.y_m) + diagonal_m};
  if (!near_the_origin(far) || !(std::abs(z_m) <= HeightMap::kMaxExtentM)) {
    return about(request.map_file,
                 "would lie beyond 100 km from the site's origin: give another place with "
                 "--origin X,Y");
  }
  const auto mm = [](double m) { return static_cast<std::int32_t>(std::lround(m * 1000.0)); };
  const double yaw_rad = std::remainder(frame.yaw_rad, 2.0 * std::numbers::pi);
  return SubmapPose{mm(corner.x_m), mm(corner.y_m), mm(z_m),
                    static_cast<std::int32_t>(std::lround(yaw_rad * 1e4))};
}

/// The notes once the raster lies there. A turned one's corners would cover more than it does.
ImportNotes notes_with(ImportNotes notes, const RasterFrame& frame, const SubmapPose& place,
                       int cell_mm) {
  if (place.yaw_1e4rad != 0) return notes;
  // The first cell whose middle is in the raster, as the fold sees it.
  const auto first = [cell_mm](std::int32_t from_mm) {
    return static_cast<std::int32_t>(std::ceil((from_mm - 0.5 * cell_mm) / cell_mm));
  };
  const CellIndex lowest{first(place.x_mm), first(place.y_mm)};
  const CellExtent here{lowest, {lowest.x + frame.columns - 1, lowest.y + frame.rows - 1}};
  CellExtent& all = notes.covered ? *notes.covered : notes.covered.emplace(here);
  all.lowest = {std::min(all.lowest.x, here.lowest.x), std::min(all.lowest.y, here.lowest.y)};
  all.highest = {std::max(all.highest.x, here.highest.x), std::max(all.highest.y, here.highest.y)};
  return notes;
}

/// Cuts a raster into submaps and hands them to a world.
class Importer {
 public:
  Importer(server::World& world, const HeightRaster& raster, const SubmapPose& place)
      : world_(world), raster_(raster), place_(place) {
    std::random_device random;
    boot_ = (std::uint64_t{random()} << 32U) | random();
  }

  Status run() {
    for (int row = 0; row < raster_.frame.rows; row += kSubmapCells) {
      for (int column = 0; column < raster_.frame.columns; column += kSubmapCells) {
        if (auto taken = take(column, row); !taken) return taken;
      }
    }
    return commit();
  }

  [[nodiscard]] std::int64_t submaps() const { return sequence_; }
  [[nodiscard]] std::int64_t cells() const { return cells_; }

 private:
  Status take(int first_column, int first_row) {
    const HeightMap surface = cut(first_column, first_row);
    evidence_ = {};
    ++sequence_;
    for (const auto& [key, tile] : surface.tiles()) add_blocks(key, *tile);
    if (evidence_.blocks.empty()) {
      --sequence_;
      return {};
    }
    evidence_.heads.push_back(head_at(first_column, first_row));
    staged_blocks_ += evidence_.blocks.size();
    if (!world_.stage(kImporter, boot_, evidence_).accepted) {
      return Error{ErrorCode::exhausted, "the site has too many unfinished submaps"};
    }
    return staged_blocks_ >= kBlocksPerCommit ? commit() : Status();
  }

  HeightMap cut(int first_column, int first_row) {
    HeightMap surface(world_.site().cell_size_mm);
    const int columns = std::min(kSubmapCells, raster_.frame.columns - first_column);
    const int rows = std::min(kSubmapCells, raster_.frame.rows - first_row);
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        const std::int32_t height_mm =
            raster_.height_mm[raster_.frame.at(first_column + x, first_row + y)];
        if (height_mm == HeightRaster::kUnknown) continue;
        ++cells_;
        surface.set({x, y}, {height_mm, kImportedProbability});
      }
    }
    return surface;
  }

  void add_blocks(const TileKey& key, const Tile& tile) {
    for (std::uint8_t block = 0; block < kBlocksPerTile; ++block) {
      proto::BlockUpdate update;
      update.delta = diff(nullptr, &tile, block);
      if (update.delta.changed.none()) continue;
      update.sequence = sequence_;
      update.key = {EvidenceLayer::surface, key, block};
      update.version = 1;
      evidence_.blocks.push_back(update);
    }
  }

  proto::SubmapHead head_at(int column, int row) {
    const double cell_mm = world_.site().cell_size_mm;
    const double yaw_rad = place_.yaw_1e4rad * 1e-4;
    const auto turned = [&](double x, double y, double sign) {
      return std::pair(std::cos(yaw_rad) * x - sign * std::sin(yaw_rad) * y,
                       sign * std::sin(yaw_rad) * x + std::cos(yaw_rad) * y);
    };
    const auto whole = [](double mm) { return static_cast<std::int32_t>(std::lround(mm)); };
    const auto [x_mm, y_mm] = turned(column * cell_mm, row * cell_mm, 1.0);
    proto::SubmapHead head;
    head.sequence = sequence_;
    head.version = 1;
    head.T_site_submap = place_;
    head.T_site_submap.x_mm += whole(x_mm);
    head.T_site_submap.y_mm += whole(y_mm);
    head.closed = true;
    head.blocks = static_cast<std::uint32_t>(evidence_.blocks.size());
    head.final_versions = head.blocks;
    if (sequence_ > 1) {
      const auto [along_mm, across_mm] = turned(head.T_site_submap.x_mm - previous_.x_mm,
                                                head.T_site_submap.y_mm - previous_.y_mm, -1.0);
      // A millimetre: the map is moved as a whole or not at all.
      head.link = SubmapLink{{whole(along_mm), whole(across_mm), 0, 0}, 1, 1, 1};
    }
    previous_ = head.T_site_submap;
    return head;
  }

  Status commit() {
    staged_blocks_ = 0;
    if (!world_.has_staged()) return {};
    Status written = world_.commit();
    world_.take_merged();  // There is no pose graph here that wants their surfaces.
    return written;
  }

  server::World& world_;
  const HeightRaster& raster_;
  SubmapPose place_;
  std::uint64_t boot_ = 0;
  std::uint32_t sequence_ = 0;
  SubmapPose previous_;
  proto::ServerLink::Evidence evidence_;
  std::size_t staged_blocks_ = 0;
  std::int64_t cells_ = 0;
};

}  // namespace

Result<ImportReport> import_map(const ImportRequest& request) {
  const auto relief = map_files::read_map_file(request.map_file);
  if (!relief) return relief.error();
  const RasterFrame& frame = relief->raster.frame;
  const auto cell_mm = cell_size_of(request, frame);
  if (!cell_mm) return cell_mm.error();
  ImportReport report;
  std::error_code ignored;
  report.founded = !std::filesystem::exists(request.store, ignored);
  ImportNotes notes;
  const bool far = frame.south_west && !near_the_origin(*frame.south_west);
  if (report.founded && far && !request.origin_m) notes.offset = *frame.south_west;
  if (report.founded) {  // Before anything is made.
    if (auto place = place_in(request, notes.offset, frame, *cell_mm); !place) return place.error();
  }
  auto store = store_for(request, *cell_mm);
  if (!store) return store.error();
  if (!report.founded) notes = store->notes;
  const auto place = place_in(request, notes.offset, frame, *cell_mm);
  if (!place) return place.error();
  notes = notes_with(notes, frame, *place, *cell_mm);
  if (auto noted = remember(*store, notes); !noted) return noted.error();
  auto site = with_map(*std::move(store));
  if (!site) return site.error();

  const std::uint64_t known_before = site->world->snapshot()->known_cells;
  Importer importer(*site->world, relief->raster, *place);
  if (auto done = importer.run(); !done) return done.error();
  site->world->publish();
  report.site = facts_of(*site);
  report.columns = frame.columns;
  report.rows = frame.rows;
  report.cells = importer.cells();
  report.submaps = importer.submaps();
  report.lone_obstacles = relief->lone_obstacles;
  const bool straight = place->yaw_1e4rad == 0 && known_before == 0;
  if (straight)
    report.too_steep = report.cells - static_cast<std::int64_t>(report.site.known_cells);
  report.west_m = place->x_mm / 1000.0;
  report.south_m = place->y_mm / 1000.0;
  return report;
}

}  // namespace cairn::offline
