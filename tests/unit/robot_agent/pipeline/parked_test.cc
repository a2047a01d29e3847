#include <gtest/gtest.h>

#include <variant>

#include "robot_agent/input/simulator.h"
#include "robot_agent/pipeline/mapper.h"

namespace cairn::agent {
namespace {

/// [bit/s] Of evidence frames without carrier, in the second minute that a robot stands still.
double parked_bit_s(const std::string& world, std::uint64_t seed) {
  SimulatorConfig config;
  config.world = world;
  config.seed = seed;
  auto robot = std::move(*make_simulator(config));
  proto::EvidenceSender evidence;
  Mapper mapper({}, robot->lasers(), robot->start(), 1, evidence);
  std::uint32_t number = 0;
  double bytes = 0.0;
  for (int second = 1; second <= 120; ++second) {
    const auto readings = robot->advance(std::chrono::seconds(second));
    for (const Reading& reading : *readings) {
      if (const auto* motion = std::get_if<MotionReading>(&reading)) mapper.take_motion(*motion);
      if (const auto* scan = std::get_if<Scan>(&reading)) mapper.take_scan(*scan);
    }
    evidence.begin_round(number);
    while (evidence.has_news()) {
      proto::FrameWriter frame({proto::Direction::up, 1, ++number});
      if (evidence.fill(frame, number) == 0) break;
      if (second > 60) bytes += static_cast<double>(frame.size_bytes());
      evidence.on_acked(number);
    }
  }
  return bytes * 8.0 / 60.0;
}

TEST(Parked, ARobotHasHardlyAnythingToTell) {
  for (const std::string world : {"block", "room", "hill"}) {
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      EXPECT_LE(parked_bit_s(world, seed), 100.0) << world << ", seed " << seed;
    }
  }
}

}  // namespace
}  // namespace cairn::agent
