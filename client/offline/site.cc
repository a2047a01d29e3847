#include "client/offline/site.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <random>
#include <sstream>
#include <utility>

#include "client/map_files/words.h"
#include "proto/codec/text.h"
#include "server/store/sqlite_store.h"

namespace cairn::offline {

namespace {

namespace fs = std::filesystem;

/// Notes of a store (FORMAT.md).
constexpr const char* kOffsetNote = "import/offset";
constexpr const char* kCoveredNote = "import/covered";

using Notes = std::map<std::string, std::string>;

/// Numbers between blanks; empty when there are not `count` of them.
std::vector<double> numbers_in(const Notes& notes, const char* name, std::size_t count) {
  std::vector<double> numbers;
  const auto note = notes.find(name);
  if (note == notes.end()) return numbers;
  std::istringstream words(note->second);
  for (std::string word; words >> word;) {
    if (const auto number = map_files::number_in(word)) numbers.push_back(*number);
  }
  if (numbers.size() != count) numbers.clear();
  return numbers;
}

ImportNotes import_notes(const Notes& notes) {
  ImportNotes found;
  const auto offset = numbers_in(notes, kOffsetNote, 2);
  if (!offset.empty()) found.offset = {offset[0], offset[1]};
  const auto covered = numbers_in(notes, kCoveredNote, 4);
  if (!covered.empty()) {
    const auto whole = [](double cell) {
      return static_cast<std::int32_t>(std::clamp(cell, -2e9, 2e9));
    };
    found.covered =
        CellExtent{{whole(covered[0]), whole(covered[1])}, {whole(covered[2]), whole(covered[3])}};
  }
  return found;
}

std::uint64_t size_on_disk(const std::string& file) {
  std::uint64_t bytes = 0;
  for (const char* suffix : {"", "-wal"}) {
    std::error_code missing;
    const auto size = fs::file_size(file + suffix, missing);
    if (!missing) bytes += size;
  }
  return bytes;
}

}  // namespace

Result<OpenStore> open_store(const std::string& file) {
  if (auto readable = map_files::check_readable(file); !readable) return readable.error();
  auto store = server::SqliteStore::open(file);
  if (!store && store.error().code == ErrorCode::conflict) {
    return Error{ErrorCode::conflict,
                 file +
                     " is held by a running cairn-server: stop that first, or ask it by leaving "
                     "the store out"};
  }
  if (!store) return store.error();
  const auto notes = (*store)->notes();
  if (!notes) return notes.error();
  return OpenStore{*std::move(store), file, import_notes(*notes)};
}

Result<OpenStore> found_store(const std::string& file, const std::string& name, int cell_size_mm) {
  if (!proto::valid_name(name)) {
    return Error{ErrorCode::invalid_argument,
                 "\"" + name +
                     "\" is no name for a site: a-z, 0-9, _ and -, at most 32; give one with "
                     "--name"};
  }
  std::random_device random;
  server::SiteInfo info;
  info.name = name;
  info.epoch = (std::uint64_t{random()} << 32U) | random();
  info.cell_size_mm = cell_size_mm;
  info.founded_unix_s = std::chrono::duration_cast<std::chrono::seconds>(
                            std::chrono::system_clock::now().time_since_epoch())
                            .count();
  auto store = server::SqliteStore::create(file, info);
  if (!store) return store.error();
  return OpenStore{*std::move(store), file, {}};
}

Status remember(OpenStore& store, const ImportNotes& notes) {
  server::Transaction transaction;
  char text[128];
  std::snprintf(text, sizeof text, "%.3f %.3f", notes.offset.x_m, notes.offset.y_m);
  transaction.notes[kOffsetNote] = text;
  if (notes.covered) {
    const CellExtent& covered = *notes.covered;
    std::snprintf(text, sizeof text, "%d %d %d %d", covered.lowest.x, covered.lowest.y,
                  covered.highest.x, covered.highest.y);
    transaction.notes[kCoveredNote] = text;
  }
  if (auto written = store.store->commit(transaction); !written) return written;
  store.notes = notes;
  return {};
}

Result<OpenSite> with_map(OpenStore store) {
  auto world = server::World::open(std::move(store.store), SensorModel{});
  if (!world) return Error{world.error().code, store.file + ": " + world.error().message};
  return OpenSite{*std::move(world), store.file, store.notes};
}

Result<OpenSite> open_site(const std::string& file) {
  auto store = open_store(file);
  if (!store) return store.error();
  return with_map(*std::move(store));
}

std::optional<CellExtent> extent_of(const OpenSite& site) {
  std::optional<CellExtent> extent = site.notes.covered;
  for (const auto& [key, packed] : site.world->snapshot()->tiles) {
    if (key.level != 0) continue;
    const Tile tile = packed->unpack();
    for (int i = 0; i < Tile::kCells; ++i) {
      if (!tile.known(i)) continue;
      const CellIndex cell{key.tx * Tile::kSize + i % Tile::kSize,
                           key.ty * Tile::kSize + i / Tile::kSize};
      if (!extent) extent = CellExtent{cell, cell};
      extent->lowest = {std::min(extent->lowest.x, cell.x), std::min(extent->lowest.y, cell.y)};
      extent->highest = {std::max(extent->highest.x, cell.x), std::max(extent->highest.y, cell.y)};
    }
  }
  return extent;
}

Result<HeightGrid> ground_in(const server::MapSnapshot& map, const CellExtent& extent) {
  auto grid = empty_grid(extent.lowest, extent.highest, map.cell_size_mm);
  if (!grid) return grid.error();
  for (const auto& [key, tile] : map.tiles) {
    if (key.level == 0) draw_tile(*grid, key, tile->unpack(), 1);
  }
  return grid;
}

SiteFacts facts_of(const OpenSite& site) {
  const auto map = site.world->snapshot();
  SiteFacts facts;
  facts.name = site.world->site().name;
  facts.cell_size_mm = map->cell_size_mm;
  facts.map_version = map->version;
  facts.known_cells = map->known_cells;
  facts.tiles = map->tiles.size();
  facts.submaps = site.world->submaps();
  facts.submaps_merged = site.world->merged();
  facts.bytes_on_disk = size_on_disk(site.file);
  facts.extent = extent_of(site);
  facts.offset = site.notes.offset;
  std::map<int, SiteFacts::Level> levels;
  facts.lowest_mm = std::numeric_limits<std::int32_t>::max();
  facts.highest_mm = std::numeric_limits<std::int32_t>::min();
  for (const auto& [key, packed] : map->tiles) {
    SiteFacts::Level& level = levels[key.level];
    level.level = key.level;
    ++level.tiles;
    const Tile tile = packed->unpack();
    level.known_cells += static_cast<std::uint64_t>(tile.known_count());
    for (int i = 0; i < Tile::kCells && key.level == 0; ++i) {
      if (!tile.known(i)) continue;
      facts.lowest_mm = std::min(facts.lowest_mm, tile.height_mm(i));
      facts.highest_mm = std::max(facts.highest_mm, tile.height_mm(i));
    }
  }
  if (facts.lowest_mm > facts.highest_mm) facts.lowest_mm = facts.highest_mm = 0;
  for (const auto& [number, level] : levels) facts.levels.push_back(level);
  return facts;
}

}  // namespace cairn::offline
