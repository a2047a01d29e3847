#include "proto/dds/config.h"

#include <gmock/gmock.h>

namespace cairn::proto {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(DdsConfig, NeverUsesMulticast) {
  for (const DdsRole role : {DdsRole::server, DdsRole::robot}) {
    EXPECT_THAT(dds_config_xml({.role = role}), HasSubstr("<AllowMulticast>false</"));
  }
}

TEST(DdsConfig, LetsTheServerBeMetAtAKnownPort) {
  const auto xml = dds_config_xml({.role = DdsRole::server, .domain = 3});
  EXPECT_THAT(xml, AllOf(HasSubstr("<ParticipantIndex>0</"), Not(HasSubstr("<Peer"))));
}

TEST(DdsConfig, SendsTheRobotToTheServersPortFromAnyPortOfItsOwn) {
  const auto xml =
      dds_config_xml({.role = DdsRole::robot, .server_address = "10.1.2.3", .domain = 3});
  EXPECT_THAT(xml, AllOf(HasSubstr("<Peer address=\"10.1.2.3:8160\"/>"),
                         HasSubstr("<ParticipantIndex>none</")));
}

TEST(DdsConfig, UsesTheGivenInterfaceAndElseLetsCycloneChoose) {
  EXPECT_THAT(dds_config_xml({.interface_address = "10.1.2.3"}),
              HasSubstr("<NetworkInterface address=\"10.1.2.3\"/>"));
  EXPECT_THAT(dds_config_xml({}), HasSubstr("<NetworkInterface autodetermine=\"true\"/>"));
}

TEST(DdsConfig, KeepsPacketsBelowTheMtuAndTimersSlowOnARadio) {
  const auto xml = dds_config_xml({.loopback = false});
  EXPECT_THAT(xml, AllOf(HasSubstr("<MaxMessageSize>1400B</"), HasSubstr("HeartbeatInterval"),
                         HasSubstr("<LeaseDuration>60 s</")));
}

}  // namespace
}  // namespace cairn::proto
