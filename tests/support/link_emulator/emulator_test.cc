#include "tests/support/link_emulator/emulator.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace cairn::test {
namespace {

using namespace std::chrono_literals;

/// Sends datagrams through the link with what every machine has: bash.
Finished say(const LinkEmulator& link, const std::string& words, int times) {
  const std::string script = "for i in $(seq " + std::to_string(times) + "); do echo -n '" + words +
                             "' > /dev/udp/" + LinkEmulator::kBaseAddress + "/9; done";
  return run(link.robot().inside({"/bin/bash", "-c", script}));
}

class Emulator : public testing::Test {
 protected:
  std::unique_ptr<LinkEmulator> make(const ChannelConfig& config) {
    auto made = LinkEmulator::create(1, config, config);
    if (!made) why_not_ = made.error().message;
    return made ? std::move(made).value() : nullptr;
  }
  std::string why_not_;
};

TEST_F(Emulator, CountsTheBytesThatProgramsSend) {
  const auto link = make({});
  if (!link) GTEST_SKIP() << "skipped: " << why_not_;
  const Finished said = say(*link, "0123456789", 20);
  ASSERT_EQ(said.exit_code, 0) << said.output;
  EXPECT_TRUE(eventually([&] { return link->counters().up.delivered.packets == 20; }, 5s));
  EXPECT_EQ(link->counters().up.offered.bytes, 20U * (20 + 8 + 10));
  EXPECT_EQ(link->json()["up"]["offered"]["packets"], 20);
}

TEST_F(Emulator, NothingLeavesItsNetworksButOverTheLink) {
  const auto link = make({});
  if (!link) GTEST_SKIP() << "skipped: " << why_not_;
  const Finished routes = run(link->robot().inside({"/bin/cat", "/proc/net/dev"}));
  EXPECT_NE(routes.output.find("link0"), std::string::npos) << routes.output;
  EXPECT_EQ(routes.output.find("eth"), std::string::npos) << routes.output;
}

TEST_F(Emulator, LosesWhatItIsTold) {
  const auto link = make({.loss = 0.5});
  if (!link) GTEST_SKIP() << "skipped: " << why_not_;
  ASSERT_EQ(say(*link, "x", 200).exit_code, 0);
  EXPECT_TRUE(eventually([&] { return link->counters().up.offered.packets == 200; }, 5s));
  EXPECT_NEAR(static_cast<double>(link->counters().up.lost.packets), 100, 35);
}

}  // namespace
}  // namespace cairn::test
