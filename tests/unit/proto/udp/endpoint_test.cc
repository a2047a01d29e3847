#include "proto/udp/endpoint.h"

#include <gtest/gtest.h>

namespace cairn::proto {
namespace {

UdpAddress parsed(const std::string& url) {
  const auto address = parse_udp_url(url);
  EXPECT_TRUE(address) << url;
  return address ? *address : UdpAddress{};
}

TEST(UdpUrl, ReadsHostAndPort) {
  EXPECT_EQ(parsed("udp://base.local:9000"), (UdpAddress{"base.local", 9000}));
  EXPECT_EQ(parsed("udp://10.0.0.2:1"), (UdpAddress{"10.0.0.2", 1}));
  EXPECT_EQ(parsed("udp://[fe80::1]:65535"), (UdpAddress{"fe80::1", 65535}));
}

TEST(UdpUrl, HasADefaultPort) {
  EXPECT_EQ(parsed("udp://base"), (UdpAddress{"base", kDefaultUdpPort}));
  EXPECT_EQ(parsed("udp://[::1]"), (UdpAddress{"::1", kDefaultUdpPort}));
}

TEST(UdpUrl, RefusesWhatItDoesNotUnderstandAndTeaches) {
  for (const char* url : {"udp://", "udp://:9", "base:9", "dds://base", "udp://base:",
                          "udp://base:65536", "udp://base:-1", "udp://base:9x", "udp://ba se:9",
                          "udp://[::1", "udp://[::1]9", "udp://base/x", "udp://base?domain=1"}) {
    const auto address = parse_udp_url(url);
    ASSERT_FALSE(address) << url;
    EXPECT_EQ(address.error().code, ErrorCode::invalid_argument);
    EXPECT_NE(address.error().message.find("udp://HOST"), std::string::npos);
  }
}

}  // namespace
}  // namespace cairn::proto
