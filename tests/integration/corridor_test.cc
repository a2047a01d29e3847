#include <gtest/gtest.h>

#include "tests/support/emulated_site.h"

namespace cairn::test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

/// The real programs over an emulated radio that loses a fifth of all packets, on each carrier.
class OrdersOverARadio : public testing::TestWithParam<CarrierKind> {};

TEST_P(OrdersOverARadio, BringPathAndCorridorAndTheRobotArrives) {
  ChannelConfig radio{.rate_bit_s = 64'000, .queue = 2s, .delay = 50ms};
  radio.loss = 0.2;
  radio.jitter = 20ms;
  auto made = EmulatedSite::create(5, GetParam(), radio);
  if (!made) GTEST_SKIP() << "skipped: " << made.error().message;
  EmulatedSite& site = **made;
  ASSERT_TRUE(site.start_server()) << site.server().output();
  ASSERT_EQ(site.cairn({"found", "lab"}).exit_code, 0);
  site.start_agent({"--site", "lab", "--world", "room"});
  const auto known_cells = [&] {
    const json status = json::parse(site.cairn({"status", "--json"}).output, nullptr, false);
    return status.is_object() ? status["sites"][0].value("known_cells", 0U) : 0U;
  };
  ASSERT_TRUE(eventually([&] { return known_cells() > 500U; }, 60s)) << site.agent().output();
  Finished sent;
  ASSERT_TRUE(eventually(
      [&] {
        sent = site.cairn({"goto", "4,2.5", "2,2.5", "--on-link-loss", "continue"});
        return sent.exit_code == 0;
      },
      30s))
      << sent.output;
  EXPECT_TRUE(eventually(
      [&] {
        const json robot = site.robot();
        return robot.is_object() &&
               robot.value("task", json::object()).value("state", "") == "done";
      },
      90s))
      << site.robot() << site.server().output() << site.agent().output();
  site.agent().signal(SIGTERM);
  (void)site.agent().wait(10s);
  EXPECT_NE(site.agent().output().find(" corridors of the field"), std::string::npos)
      << site.agent().output();
  EXPECT_EQ(site.agent().output().find(" 0 corridors of the field"), std::string::npos)
      << site.agent().output();
}

INSTANTIATE_TEST_SUITE_P(OnEachCarrier, OrdersOverARadio,
                         testing::Values(CarrierKind::udp, CarrierKind::dds),
                         [](const auto& each) { return std::string(to_string(each.param)); });

}  // namespace
}  // namespace cairn::test
