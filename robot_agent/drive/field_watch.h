#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/common/time.h"
#include "robot_agent/drive/corridor_map.h"

namespace cairn::agent {

/// Minds how the robot lies to the field of its order: asks for more of the field where it ends,
/// and for a new plan when the robot drives against it (T2.2.4: their dot product is not positive).
class FieldWatch {
 public:
  /// [m] So much of the way ahead should lie in a corridor.
  static constexpr double kAheadM = 10.0;
  /// [m] Driven against the field before it counts: noise, and the turn at a detour's beginning.
  static constexpr double kAgainstM = 0.6;
  static constexpr Duration kAskPeriod = std::chrono::seconds(5);
  static constexpr Duration kPlanPeriod = std::chrono::seconds(15);
  /// For one path: a field that never comes need not be asked for for ever.
  static constexpr int kMostAsked = 40;
  static constexpr std::uint8_t kUsualHalfWidth = 16;  ///< [cells]
  static constexpr std::uint8_t kWideHalfWidth = 48;   ///< [cells] When there is no way around.

  /// Another path: what belonged to the last one is forgotten.
  void begin(const proto::Command& command, OrderedPath path);
  /// A corridor came; one that is of another order or cannot be read changes nothing.
  void take(const proto::CorridorPart& corridor, int cell_size_mm);
  [[nodiscard]] const CorridorMap& corridor() const { return corridor_; }

  /// The robot drives along `ahead_m`, which begins where it is.
  void look(const std::vector<Eigen::Vector2d>& ahead_m, int cell_size_mm, MonotonicTime clock);
  /// It found no way around what closes its own.
  void closed_in(const Eigen::Vector2d& place_m, MonotonicTime clock);
  /// It does something else than to drive along its way: no account of the field.
  void pause() { last_m_.reset(); }

  /// What to ask the server for, once each.
  [[nodiscard]] std::optional<proto::CorridorRequest> take_request();

 private:
  void ask(proto::CorridorWish wish, const Eigen::Vector2d& place_m, std::uint8_t half_width,
           MonotonicTime clock);
  [[nodiscard]] bool drives_against(const Eigen::Vector2d& place_m, int cell_size_mm);
  [[nodiscard]] std::uint8_t direction_at(const Eigen::Vector2d& place_m, int cell_size_mm) const;

  std::uint64_t command_ = 0;
  std::uint32_t revision_ = 0;
  CorridorMap corridor_;
  std::optional<Eigen::Vector2d> last_m_;
  double against_m_ = 0.0;
  std::optional<MonotonicTime> asked_at_;
  std::optional<MonotonicTime> plan_asked_at_;
  int asked_ = 0;
  std::optional<proto::CorridorRequest> request_;
};

}  // namespace cairn::agent
