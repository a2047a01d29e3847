#pragma once

#include <array>
#include <cstdint>

#include "core/map/cell.h"
#include "core/map/fold_rules.h"

namespace cairn::agent {

/// What of evidence on known ground is worth telling (design §5.5).
struct NewsConfig {
  /// [1/255] A surface believed as much as this is sure: more hits are no news.
  std::uint8_t sure = 243;
  /// [nat] Of log odds: less doubt than this, or more belief below `sure`, is no news. Six beams
  /// that passed below: at the edges of things some do, now and then.
  double doubt = 2.5;
  /// [1/255] A surface where none was known, or a lower one, is news from so much belief on: two
  /// hits.
  std::uint8_t stands = 200;
  /// [mm] A surface that would come to lie this much higher or lower is news.
  int height_mm = 20;
  /// [mm] What stood so high above the ground beside it that nothing gets over it, and still does,
  int standing_mm = 200;
  /// [mm] by no more than this higher or lower, is no news: where its edge lies in a cell decides
  /// which of its heights is seen there.
  int standing_apart_mm = 400;
  /// [s] What is no change of the world, only known better, may wait as long.
  double patience_s = 10.0;
};

/// Tells news from confirmation, cell by cell.
class News {
 public:
  /// Requires: a sound model.
  News(const NewsConfig& config, const SensorModel& model);

  /// What the long-term map makes of a cell once this evidence is folded in.
  [[nodiscard]] Cell folded(const Cell& known, const Cell& seen_through, const Cell& surface) const;

  enum class Worth : std::uint8_t {
    nothing,  ///< It agrees with the map.
    little,   ///< Known better, or for the first time.
    much,     ///< Something stands where nothing stood, or is gone.
  };
  /// Of a cell becoming `after`, where the robot saw `surface`. `ground_mm`: the lowest known
  /// beside it.
  [[nodiscard]] Worth worth(const Cell& known, const Cell& after, const Cell& surface,
                            std::int32_t ground_mm) const;

 private:
  [[nodiscard]] bool still_stands(const Cell& known, const Cell& surface,
                                  std::int32_t ground_mm) const;

  NewsConfig config_;
  int tolerance_mm_;
  FoldRules rules_;
  std::array<double, 256> belief_{};  ///< [nat] Log odds up to `sure`.
};

}  // namespace cairn::agent
