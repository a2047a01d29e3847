#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/map/height_map.h"
#include "core/map/sensor_model.h"
#include "core/sensor/laser.h"

namespace cairn {

/// The rules of T4.3 for one cell, with the sensor model worked out into tables. Integers only:
/// the same readings leave the same bits on every machine.
class CellRules {
 public:
  /// Requires: a sound model (see faults()).
  explicit CellRules(const SensorModel& model);

  /// The cell after a hit at `height_mm`: unknown or lower than the hit by more than the tolerance
  /// → the hit replaces it; within the tolerance → probabilities combine (Eq. 1) and the height is
  /// the running mean of the surface's hits; hits lower than that are ignored.
  [[nodiscard]] Cell after_hit(const Cell& cell, std::int32_t height_mm) const;

  /// How a beam's way past a cell speaks against the cell's surface.
  enum class Pass : std::uint8_t { above, grazing, below };

  /// Below the stored height by more than the tolerance is `below`. Up to the stored height it is
  /// `grazing` when the beam went on for graze_beyond_m at least: else a thing met only by level
  /// beams, all at one height, would never be contradicted.
  [[nodiscard]] Pass pass_of(const Cell& cell, std::int32_t beam_height_mm, bool went_on) const {
    if (!cell.known()) return Pass::above;
    const std::int64_t below_mm = std::int64_t{cell.height_mm} - beam_height_mm;
    if (below_mm > model_.tolerance_mm) return Pass::below;
    return went_on && below_mm >= 0 ? Pass::grazing : Pass::above;
  }

  /// The cell after such a pass: its probability falls, and below the model's minimum the cell is
  /// unknown again; `above` changes nothing.
  [[nodiscard]] Cell after_pass(const Cell& cell, Pass pass) const;

  /// Whether a beam at this height passed below the cell's surface.
  [[nodiscard]] bool passed_below(const Cell& cell, std::int32_t beam_height_mm) const {
    return pass_of(cell, beam_height_mm, false) == Pass::below;
  }

  [[nodiscard]] const SensorModel& model() const { return model_; }

 private:
  SensorModel model_;
  // By the stored probability; [0] is not used.
  std::array<std::uint8_t, 256> probability_after_hit_{};
  std::array<std::uint8_t, 256> probability_after_pass_{};
  std::array<std::uint8_t, 256> probability_after_graze_{};
  std::array<std::uint8_t, 256> hits_behind_{};
};

/// A beam passing where a surface is that another map believes in (see Submap::seen_through).
struct Contradiction {
  CellIndex cell;
  /// Surfaces higher than this by more than the tolerance are contradicted: the height of the
  /// lowest of the scan's beams there, less the tolerance where they only grazed.
  std::int32_t height_mm = 0;
  bool grazing = false;  ///< No beam of the scan passed below.
};

/// What one scan did to a map.
struct ScanEffect {
  std::vector<CellIndex> changed;  ///< Each cell once; its value differs from before the scan.
  std::vector<Contradiction> contradictions;  ///< Each cell at most once, sorted by y, then x.
  std::int64_t beams = 0;                     ///< Beams integrated.
  std::int64_t unrepresentable = 0;  ///< Hits too far from their tile's datum to be stored.
};

/// Integrates scans into maps by the rules of T4.3. Keeps its working memory from scan to scan;
/// not thread-safe, one for each thread.
class ScanIntegrator {
 public:
  /// Requires: a sound model (see faults()).
  explicit ScanIntegrator(const SensorModel& model) : rules_(model) {}

  /// First every beam's free part (cells with a hit in this same scan, and the beam's last cell,
  /// are spared: a beam that grazes a wall must not erase it), then the hits. With
  /// `ground_height_mm` the free part also counts as hits on ground at that height
  /// (LaserSpec::ground_along_beam). Where a beam's free part passes below or
  /// grazes a known surface of `reference` (may be null; same frame and cell size as `map`, not
  /// `map` itself), that is a contradiction. Beams that are not finite or leave
  /// HeightMap::kMaxExtentM are skipped.
  ScanEffect integrate(HeightMap& map, const std::vector<Beam>& beams,
                       std::optional<std::int32_t> ground_height_mm, const HeightMap* reference);

 private:
  using CellBits = std::array<std::uint64_t, Tile::kCells / 64>;

  /// One tile's part in the scan.
  struct TileWork {
    TileKey key;
    Tile* tile = nullptr;             ///< Null while the map has none.
    const Tile* reference = nullptr;  ///< Null where the reference has none.
    CellBits hit{};                   ///< Cells with a hit in this scan.
    CellBits touched{};               ///< Cells whose value before the scan is in `before_`.
  };
  struct Before {
    const TileWork* work;
    int index;
    Cell cell;
  };
  struct Scene;

  TileWork& work_at(Scene& scene, CellIndex cell);
  TileWork& open_work(Scene& scene, const TileKey& key);
  void mark_hits(Scene& scene, const std::vector<Beam>& beams);
  void integrate_free_part(Scene& scene, const Beam& beam);
  /// A beam's stay in one cell on its way.
  struct Stay {
    CellIndex cell;
    int index = 0;  ///< In the tile.
    std::int32_t beam_height_mm = 0;
    bool went_on = false;
  };
  [[nodiscard]] bool concerns(const Scene& scene, const TileWork& work, const Stay& stay) const;
  void pass(Scene& scene, TileWork& work, const Stay& stay);
  void contradict(Scene& scene, const TileWork& work, const Stay& stay);
  void hit(Scene& scene, TileWork& work, int index, std::int32_t height_mm);
  void store(TileWork& work, int index, const Cell& before, const Cell& after);
  void collect(Scene& scene);

  CellRules rules_;
  std::unordered_map<TileKey, TileWork*, TileKeyHash> open_;
  std::vector<std::unique_ptr<TileWork>> pool_;
  std::vector<Before> before_;
};

}  // namespace cairn
