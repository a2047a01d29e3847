#include "client/offline/point_cloud.h"

#include <algorithm>
#include <bit>
#include <vector>

#include "client/map_files/words.h"

namespace cairn::offline {

namespace {

void put(std::string& bytes, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (unsigned i = 0; i < 8; ++i) bytes.push_back(static_cast<char>(bits >> (8 * i)));
}

std::string points_of(const TileKey& key, const Tile& tile, double cell_m,
                      const map_files::RasterFrame::Corner& offset) {
  std::string bytes;
  for (int i = 0; i < Tile::kCells; ++i) {
    if (!tile.known(i)) continue;
    const int row_in_tile = i / Tile::kSize;
    const double column = key.tx * double{Tile::kSize} + i % Tile::kSize;
    const double row = key.ty * double{Tile::kSize} + row_in_tile;
    put(bytes, (column + 0.5) * cell_m + offset.x_m);
    put(bytes, (row + 0.5) * cell_m + offset.y_m);
    put(bytes, tile.height_mm(i) / 1000.0);
    bytes.push_back(static_cast<char>(tile.probability(i)));
  }
  return bytes;
}

}  // namespace

Status write_point_cloud(const std::string& path, const server::MapSnapshot& map,
                         const map_files::RasterFrame::Corner& offset) {
  auto file = map_files::create_file(path);
  if (!file) return file.error();
  *file << "ply\nformat binary_little_endian 1.0\ncomment made by cairn\nelement vertex "
        << map.known_cells
        << "\nproperty double x\nproperty double y\nproperty double z\n"
           "property uchar probability\nend_header\n";
  std::vector<TileKey> keys;
  keys.reserve(map.tiles.size());
  for (const auto& [key, tile] : map.tiles) keys.push_back(key);
  std::ranges::sort(keys);
  for (const TileKey& key : keys) {
    *file << points_of(key, map.tiles.at(key)->unpack(), map.cell_size_mm / 1000.0, offset);
  }
  return map_files::finish_file(*file, path);
}

}  // namespace cairn::offline
