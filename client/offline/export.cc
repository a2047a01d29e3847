#include "client/offline/export.h"

#include "client/map_files/esri_ascii.h"
#include "client/map_files/height_tiff.h"
#include "client/map_files/map_file.h"
#include "client/map_files/movingai_map.h"
#include "client/map_files/ros_map.h"
#include "client/offline/point_cloud.h"

namespace cairn::offline {

namespace {

using map_files::HeightRaster;
using map_files::MapFileKind;
using map_files::RasterFrame;

std::string name_of(MapFileKind kind) {
  switch (kind) {
    case MapFileKind::movingai:
      return "Moving AI map";
    case MapFileKind::ros:
      return "ROS map";
    case MapFileKind::esri:
      return "Esri ASCII grid";
    case MapFileKind::csv:
      return "CSV heights";
    case MapFileKind::tiff:
      return "GeoTIFF";
    case MapFileKind::ply:
      return "PLY point cloud";
  }
  return {};
}

RasterFrame frame_of(const HeightGrid& grid, const RasterFrame::Corner& offset) {
  RasterFrame frame;
  frame.columns = grid.width;
  frame.rows = grid.height;
  frame.cell_m = grid.cell_size_mm / 1000.0;
  frame.south_west = {grid.origin.x * frame.cell_m + offset.x_m,
                      grid.origin.y * frame.cell_m + offset.y_m};
  return frame;
}

HeightRaster heights_of(HeightGrid grid, const RasterFrame& frame) {
  for (std::size_t i = 0; i < grid.height_mm.size(); ++i) {
    if (grid.probability[i] == 0) grid.height_mm[i] = HeightRaster::kUnknown;
  }
  return {frame, std::move(grid.height_mm)};
}

Status write(MapFileKind kind, const std::string& file, HeightGrid grid, const RasterFrame& frame,
             const VehicleLimits& limits) {
  switch (kind) {
    case MapFileKind::movingai:
      return map_files::write_movingai_map(file, {frame, classify(grid, limits)});
    case MapFileKind::ros:
      return map_files::write_ros_map(file, {frame, classify(grid, limits)});
    case MapFileKind::esri:
      return map_files::write_esri_ascii(file, heights_of(std::move(grid), frame));
    case MapFileKind::csv:
      return map_files::write_csv_heights(file, heights_of(std::move(grid), frame));
    case MapFileKind::tiff:
    case MapFileKind::ply:
      break;
  }
  return map_files::write_height_tiff(file, heights_of(std::move(grid), frame));
}

}  // namespace

Result<ExportReport> export_map(const OpenSite& site, const std::string& file,
                                const VehicleLimits& limits) {
  const auto kind = map_files::kind_of(file);
  if (!kind) return kind.error();
  const auto map = site.world->snapshot();
  const auto extent = extent_of(site);
  if (!extent || map->known_cells == 0) {
    return Error{ErrorCode::unavailable, site.file + " has no known cell to export"};
  }
  ExportReport report;
  report.kind = name_of(*kind);
  report.columns = std::int64_t{extent->highest.x} - extent->lowest.x + 1;
  report.rows = std::int64_t{extent->highest.y} - extent->lowest.y + 1;
  report.known_cells = map->known_cells;
  Status written;
  if (*kind == MapFileKind::ply) {
    written = write_point_cloud(file, *map, site.notes.offset);
  } else {
    auto grid = ground_in(*map, *extent);
    if (!grid) {
      return Error{grid.error().code,
                   "the known ground lies " + std::to_string(report.columns) + " x " +
                       std::to_string(report.rows) + " cells apart, more than the " +
                       std::to_string(HeightGrid::kMaxCells) +
                       " of one raster: export it as .ply, which holds known cells only"};
    }
    const RasterFrame frame = frame_of(*grid, site.notes.offset);
    written = write(*kind, file, *std::move(grid), frame, limits);
  }
  if (!written) return written.error();
  return report;
}

}  // namespace cairn::offline
