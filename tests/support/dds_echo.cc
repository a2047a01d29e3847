// The other end of a DDS carrier, in a process of its own so that tests can kill it.
//   dds_echo server URL        returns every frame to the robot it came from
//   dds_echo robot URL ROBOT   returns every frame to the server, and sends its name ten times a
//                              second so that the server meets it
// A frame "flood" is answered by kFloodFrames frames as fast as they can be sent.
#include <cstdio>
#include <memory>
#include <string>

#include "proto/dds/robot_carrier.h"
#include "proto/dds/server_carrier.h"
#include "tests/support/dds_flood.h"

namespace cairn::proto {
namespace {

using CarrierResult = Result<std::unique_ptr<Carrier>>;

template <class T>
CarrierResult as_carrier(Result<std::unique_ptr<T>> made) {
  if (!made) return made.error();
  return std::unique_ptr<Carrier>(std::move(made).value());
}

CarrierResult make_carrier(const std::string& url, const std::string& robot) {
  const auto endpoint = parse_dds_url(url);
  if (!endpoint) return endpoint.error();
  if (robot.empty()) return as_carrier(DdsServerCarrier::create(*endpoint));
  return as_carrier(DdsRobotCarrier::create(*endpoint, robot));
}

void answer(Carrier& carrier, const Datagram& frame) {
  if (std::string(frame.bytes.begin(), frame.bytes.end()) != kFloodRequest) {
    (void)carrier.send(frame);
    return;
  }
  for (std::uint32_t i = 0; i < kFloodFrames; ++i) {
    (void)carrier.send({frame.peer, flood_frame(i)});
  }
}

int run(Carrier& carrier, const std::string& robot) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kBeat{100};
  auto next_beat = Clock::now();
  for (;;) {
    const auto frame = carrier.receive(kBeat / 2);
    if (!frame) return 1;
    if (frame->has_value()) answer(carrier, **frame);
    if (robot.empty() || Clock::now() < next_beat) continue;
    next_beat = Clock::now() + kBeat;
    (void)carrier.send({"", {robot.begin(), robot.end()}});
  }
}

}  // namespace
}  // namespace cairn::proto

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const std::string robot = argc > 3 ? argv[3] : "";
  auto carrier = cairn::proto::make_carrier(argv[2], robot);
  if (!carrier) {
    std::fprintf(stderr, "%s\n", carrier.error().message.c_str());
    return 1;
  }
  return cairn::proto::run(**carrier, robot);
}
