#include "proto/dds/robot_writers.h"

namespace cairn::proto {

void RobotWriters::serve(const std::set<std::string>& robots) {
  const std::lock_guard lock(mutex_);
  std::erase_if(writers_, [&](const auto& entry) { return !robots.contains(entry.first); });
  for (const std::string& robot : robots) {
    if (writers_.size() >= kMaxRobots) return;
    if (writers_.contains(robot)) continue;
    auto writer = FrameTopicWriter::create(participant_, topic_.get(), robot);
    if (writer) writers_.emplace(robot, std::move(writer).value());
  }
}

Status RobotWriters::send(const Datagram& frame) {
  const std::lock_guard lock(mutex_);
  const auto found = writers_.find(frame.peer);
  if (found == writers_.end() || !found->second.has_reader()) {
    return Error{ErrorCode::unavailable,
                 "robot '" + frame.peer + "' is not in reach over DDS: try again later"};
  }
  return found->second.write(frame.bytes);
}

}  // namespace cairn::proto
