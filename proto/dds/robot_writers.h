#pragma once

#include <map>
#include <mutex>
#include <set>
#include <string>

#include "proto/carrier.h"
#include "proto/dds/frame_topic.h"

namespace cairn::proto {

/// The server's writers, one per robot in reach, each in that robot's partition. Thread-safe.
class RobotWriters {
 public:
  static constexpr std::size_t kMaxRobots = 256;

  /// `participant` must live longer than this.
  RobotWriters(dds_entity_t participant, DdsEntity topic)
      : participant_(participant), topic_(std::move(topic)) {}

  /// Makes writers for robots that have none (as many as kMaxRobots allows) and drops those of
  /// robots not named.
  void serve(const std::set<std::string>& robots);
  /// unavailable when the robot is not in reach.
  Status send(const Datagram& frame);

 private:
  dds_entity_t participant_;
  DdsEntity topic_;
  std::mutex mutex_;
  std::map<std::string, FrameTopicWriter> writers_;
};

}  // namespace cairn::proto
