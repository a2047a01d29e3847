#include "robot_agent/drive/track.h"

namespace cairn::agent {

void Track::add(const Eigen::Vector2d& place_m) {
  if (!points_m_.empty() && (points_m_.back() - place_m).norm() < spacing_m_) return;
  points_m_.push_back(place_m);
  if (points_m_.size() < kMaxPoints) return;
  for (std::size_t i = 0; 2 * i < points_m_.size(); ++i) points_m_[i] = points_m_[2 * i];
  points_m_.resize((points_m_.size() + 1) / 2);
  spacing_m_ *= 2.0;
}

std::vector<Eigen::Vector2d> Track::back_from(const Eigen::Vector2d& place_m) const {
  std::vector<Eigen::Vector2d> back{place_m};
  back.insert(back.end(), points_m_.rbegin(), points_m_.rend());
  return back;
}

}  // namespace cairn::agent
