#pragma once

#include <memory>
#include <queue>
#include <vector>

#include "core/planner/field_tile.h"
#include "core/planner/ground.h"

namespace cairn {

/// Solves a whole field tile by tile: the tile with the cheapest news first, each by sweeps over
/// its 64 × 64 cells until nothing in it changes. What it lowers at its edges is news to the tiles
/// beside it. Tiles with uneven cells go cell by cell.
class TileWave {
 public:
  /// All must outlive it. The field must be unreached.
  TileWave(const DrivableGrid& grid, Field& field, const FieldKernels& kernels);

  void radiate();

 private:
  /// What a tile has not looked at yet: lowered cells in the rim, by side and corner.
  struct News {
    RowBits south = 0;
    RowBits north = 0;
    RowBits west = 0;
    RowBits east = 0;
    std::uint8_t corners = 0;  ///< SW 1, SE 2, NW 4, NE 8.
    bool inside = false;       ///< The goal's own tile, at first.
    std::int32_t cheapest = Field::kUnreached;
  };
  struct Due {
    std::int32_t cheapest;
    std::int32_t tile;
    friend bool operator>(const Due& a, const Due& b) { return a.cheapest > b.cheapest; }
  };
  /// Costs along the four edges: south, north, west, east.
  struct Edges {
    std::int32_t cell[4][FieldTile::kSize];
  };

  void solve(int tile);
  void load(int tx, int ty);
  void load_news(const News& news);
  void store(int tx, int ty);
  void solve_uneven(int tx, int ty, const News& news);
  [[nodiscard]] bool has_uneven(int tx, int ty) const;
  [[nodiscard]] Edges edges(int tx, int ty) const;
  void tell_neighbours(int tx, int ty, const Edges& before);
  void wake(int tx, int ty, std::int32_t cheapest, RowBits News::*side, RowBits bits);
  void wake_corner(int tx, int ty, std::int32_t cheapest, std::uint8_t corner);
  [[nodiscard]] News* news_of(int tx, int ty);
  void note(int tx, int ty, std::int32_t cheapest);

  const DrivableGrid& grid_;
  const PricedGround& ground_;
  const GroundReader reader_;
  Field& field_;
  const FieldKernels& kernels_;
  int columns_;
  int rows_;
  std::vector<News> news_;
  std::priority_queue<Due, std::vector<Due>, std::greater<>> due_;
  std::unique_ptr<FieldTile> tile_;
};

}  // namespace cairn
