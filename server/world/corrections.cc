#include "server/world/corrections.h"

#include <charconv>
#include <cstdio>
#include <sstream>

#include "server/world/placing.h"

namespace cairn::server {
namespace {

constexpr const char* kPrefix = "moved/";
constexpr std::size_t kHexDigits = 16;

std::ostream& operator<<(std::ostream& out, const SubmapPose& pose) {
  return out << pose.x_mm << ' ' << pose.y_mm << ' ' << pose.z_mm << ' ' << pose.yaw_1e4rad;
}

std::istream& operator>>(std::istream& in, SubmapPose& pose) {
  return in >> pose.x_mm >> pose.y_mm >> pose.z_mm >> pose.yaw_1e4rad;
}

}  // namespace

std::uint32_t Corrections::add(const SubmapPose& was, const SubmapPose& is) {
  motions_.push_back({++edition_, was, is});
  if (motions_.size() > kMaxKept) motions_.pop_front();
  return edition_;
}

SubmapPose Corrections::corrected(const SubmapPose& pose, std::uint32_t edition) const {
  if (edition >= edition_) return pose;
  LevelPose now = to_level(pose);
  for (const Motion& motion : motions_) {
    if (motion.edition > edition) now = to_level(motion.is) * between(to_level(motion.was), now);
  }
  return to_submap_pose(now);
}

std::string Corrections::text() const {
  std::ostringstream out;
  for (const Motion& motion : motions_) {
    out << motion.edition << ' ' << motion.was << ' ' << motion.is << '\n';
  }
  return out.str();
}

Result<Corrections> Corrections::from_text(const std::string& text) {
  Corrections corrections;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    std::istringstream fields(line);
    Motion motion;
    fields >> motion.edition >> motion.was >> motion.is;
    if (!fields || motion.edition <= corrections.edition_ ||
        corrections.motions_.size() >= kMaxKept) {
      return Error{ErrorCode::corrupt, "a note of moved submaps breaks the format"};
    }
    corrections.motions_.push_back(motion);
    corrections.edition_ = motion.edition;
  }
  return corrections;
}

std::string corrections_note(std::uint64_t boot) {
  char name[32];
  std::snprintf(name, sizeof name, "%s%016llx", kPrefix, static_cast<unsigned long long>(boot));
  return name;
}

std::optional<std::uint64_t> boot_of_note(const std::string& name) {
  const std::string prefix = kPrefix;
  if (!name.starts_with(prefix) || name.size() != prefix.size() + kHexDigits) return std::nullopt;
  std::uint64_t boot = 0;
  const char* end = name.data() + name.size();
  const auto read = std::from_chars(name.data() + prefix.size(), end, boot, 16);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return boot;
}

}  // namespace cairn::server
