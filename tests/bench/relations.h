#pragma once

#include <string>
#include <vector>

#include "core/common/result.h"
#include "core/pose/pose.h"

namespace cairn::bench {

/// One hand-checked relative pose of the Freiburg SLAM benchmark (Kümmerle et al., On Measuring the
/// Accuracy of SLAM Algorithms, Autonomous Robots 27, 2009).
struct Relation {
  double stamp_i_s = 0.0;
  double stamp_j_s = 0.0;
  Pose T_i_j;
};

/// Reads lines of `t1 t2 x y z roll pitch yaw`. Errors: no such file; a line that is none of these.
[[nodiscard]] Result<std::vector<Relation>> read_relations(const std::string& path);

/// A robot's poses, by ascending stamps of the log.
struct Stamped {
  double stamp_s = 0.0;
  Pose T_site_robot;
};

/// Mean and standard deviation of a number.
struct Spread {
  double mean = 0.0;
  double sigma = 0.0;
};

/// The benchmark's figures: of δ⁻¹ ∘ (x_i⁻¹ ∘ x_j) the length of the translation and the angle of
/// the turn, and their squares.
struct RelationErrors {
  Spread translation_m;
  Spread translation_m2;
  Spread rotation_deg;
  Spread rotation_deg2;
  std::size_t relations = 0;
  std::size_t missing = 0;  ///< No pose within 1 ms of a stamp.
};
[[nodiscard]] RelationErrors relation_errors(const std::vector<Relation>& relations,
                                             const std::vector<Stamped>& track);

}  // namespace cairn::bench
