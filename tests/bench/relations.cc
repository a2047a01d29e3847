#include "tests/bench/relations.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>

#include "core/common/angle.h"

namespace cairn::bench {
namespace {

/// Sums for mean and standard deviation.
class Sums {
 public:
  void add(double value) {
    sum_ += value;
    squares_ += value * value;
    ++count_;
  }
  [[nodiscard]] Spread spread() const {
    if (count_ == 0) return {};
    const double mean = sum_ / count_;
    return {mean, std::sqrt(std::max(squares_ / count_ - mean * mean, 0.0))};
  }

 private:
  double sum_ = 0.0;
  double squares_ = 0.0;
  double count_ = 0.0;
};

std::optional<Pose> pose_at(const std::vector<Stamped>& track, double stamp_s) {
  constexpr double kSameS = 1e-3;
  const auto at =
      std::lower_bound(track.begin(), track.end(), stamp_s - kSameS,
                       [](const Stamped& pose, double stamp) { return pose.stamp_s < stamp; });
  if (at == track.end() || at->stamp_s > stamp_s + kSameS) return std::nullopt;
  return at->T_site_robot;
}

}  // namespace

Result<std::vector<Relation>> read_relations(const std::string& path) {
  std::ifstream file(path);
  if (!file) return Error{ErrorCode::not_found, "no file " + path};
  std::vector<Relation> relations;
  for (std::string line; std::getline(file, line);) {
    if (line.empty()) continue;
    std::istringstream words(line);
    Relation r;
    Pose& T = r.T_i_j;
    words >> r.stamp_i_s >> r.stamp_j_s >> T.x_m >> T.y_m >> T.z_m >> T.roll_rad >> T.pitch_rad >>
        T.yaw_rad;
    if (!words) return Error{ErrorCode::corrupt, path + ": not a relation: " + line};
    relations.push_back(r);
  }
  return relations;
}

RelationErrors relation_errors(const std::vector<Relation>& relations,
                               const std::vector<Stamped>& track) {
  RelationErrors errors;
  Sums translation, translation2, rotation, rotation2;
  for (const Relation& relation : relations) {
    const auto i = pose_at(track, relation.stamp_i_s);
    const auto j = pose_at(track, relation.stamp_j_s);
    if (!i || !j) {
      ++errors.missing;
      continue;
    }
    const Pose off = from_transform(to_transform(relation.T_i_j).inverse() *
                                    to_transform(*i).inverse() * to_transform(*j));
    const double way_m = std::hypot(off.x_m, off.y_m);
    const double turn_deg = degrees(std::abs(wrap_angle(off.yaw_rad)));
    translation.add(way_m);
    translation2.add(way_m * way_m);
    rotation.add(turn_deg);
    rotation2.add(turn_deg * turn_deg);
    ++errors.relations;
  }
  errors.translation_m = translation.spread();
  errors.translation_m2 = translation2.spread();
  errors.rotation_deg = rotation.spread();
  errors.rotation_deg2 = rotation2.spread();
  return errors;
}

}  // namespace cairn::bench
