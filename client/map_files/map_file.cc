#include "client/map_files/map_file.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>

#include "client/map_files/esri_ascii.h"
#include "client/map_files/height_tiff.h"
#include "client/map_files/movingai_map.h"
#include "client/map_files/ros_map.h"

namespace cairn::map_files {

namespace {

Result<Relief> with_heights(const std::string& path, const Result<ClassRaster>& classes) {
  if (!classes) return classes.error();
  auto relief = relief_of(*classes);
  if (!relief) return Error{relief.error().code, path + ": " + relief.error().message};
  return relief;
}

Result<Relief> as_relief(Result<HeightRaster> raster) {
  if (!raster) return raster.error();
  return Relief{*std::move(raster), 0};
}

/// The description beside a picture.
std::string yaml_of(const std::string& path) {
  const std::filesystem::path file(path);
  if (file.extension() == ".yaml" || file.extension() == ".yml") return path;
  return std::filesystem::path(path).replace_extension(".yaml").string();
}

}  // namespace

Result<MapFileKind> kind_of(const std::string& path) {
  static const std::map<std::string, MapFileKind> kinds = {
      {".map", MapFileKind::movingai}, {".yaml", MapFileKind::ros}, {".yml", MapFileKind::ros},
      {".pgm", MapFileKind::ros},      {".asc", MapFileKind::esri}, {".csv", MapFileKind::csv},
      {".txt", MapFileKind::csv},      {".tif", MapFileKind::tiff}, {".tiff", MapFileKind::tiff},
      {".ply", MapFileKind::ply}};
  std::string ending = std::filesystem::path(path).extension().string();
  std::ranges::transform(ending, ending.begin(), [](char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  });
  const auto found = kinds.find(ending);
  if (found != kinds.end()) return found->second;
  return Error{ErrorCode::invalid_argument,
               path +
                   ": the name must end in .map (Moving AI), .yaml or .pgm (ROS map_server), "
                   ".asc (Esri), .csv, .tif or .ply"};
}

Result<Relief> read_map_file(const std::string& path) {
  const auto kind = kind_of(path);
  if (!kind) return kind.error();
  switch (*kind) {
    case MapFileKind::movingai:
      return with_heights(path, read_movingai_map(path));
    case MapFileKind::ros:
      return with_heights(path, read_ros_map(yaml_of(path)));
    case MapFileKind::esri:
      return as_relief(read_esri_ascii(path));
    case MapFileKind::csv:
      return as_relief(read_csv_heights(path));
    case MapFileKind::tiff:
      return as_relief(read_height_tiff(path));
    case MapFileKind::ply:
      break;
  }
  return Error{ErrorCode::invalid_argument, path + ": point clouds are written, not read"};
}

}  // namespace cairn::map_files
