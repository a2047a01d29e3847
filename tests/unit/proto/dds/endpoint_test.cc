#include "proto/dds/endpoint.h"

#include <gmock/gmock.h>

namespace cairn::proto {
namespace {

using testing::HasSubstr;

TEST(DdsUrl, NamesHostAndDomain) {
  const auto endpoint = parse_dds_url("dds://base.local?domain=7");
  ASSERT_TRUE(endpoint);
  EXPECT_EQ(*endpoint, (DdsEndpoint{"base.local", 7}));
}

TEST(DdsUrl, MeansDomainZeroWhenNoneIsGiven) {
  const auto endpoint = parse_dds_url("dds://10.0.0.2");
  ASSERT_TRUE(endpoint);
  EXPECT_EQ(*endpoint, (DdsEndpoint{"10.0.0.2", 0}));
}

TEST(DdsUrl, AcceptsTheHighestDomainThatHasPorts) {
  ASSERT_TRUE(parse_dds_url("dds://a?domain=232"));
  EXPECT_EQ(dds_server_port(232), 65410);
  EXPECT_EQ(dds_server_port(0), 7410);
}

struct BadUrl {
  const char* url;
  const char* taught;
};

class DdsUrlRefused : public testing::TestWithParam<BadUrl> {};

TEST_P(DdsUrlRefused, WithAMessageThatTeaches) {
  const auto endpoint = parse_dds_url(GetParam().url);
  ASSERT_FALSE(endpoint) << GetParam().url;
  EXPECT_EQ(endpoint.error().code, ErrorCode::invalid_argument);
  EXPECT_THAT(endpoint.error().message, HasSubstr(GetParam().taught));
  EXPECT_THAT(endpoint.error().message, HasSubstr("dds://HOST?domain=N"));
}

INSTANTIATE_TEST_SUITE_P(
    All, DdsUrlRefused,
    testing::Values(BadUrl{"", "starts with dds://"}, BadUrl{"udp://a", "starts with dds://"},
                    BadUrl{"dds://", "needs a host"}, BadUrl{"dds://?domain=1", "needs a host"},
                    BadUrl{"dds://a b", "needs a host"}, BadUrl{"dds://a\"/>", "needs a host"},
                    BadUrl{"dds://a:7410", "has no port"}, BadUrl{"dds://[::1]", "IPv4"},
                    BadUrl{"dds://a?domain=233", "0 to 232"},
                    BadUrl{"dds://a?domain=-1", "0 to 232"}, BadUrl{"dds://a?domain=", "0 to 232"},
                    BadUrl{"dds://a?domain=4294967296", "0 to 232"},
                    BadUrl{"dds://a?domain=7x", "0 to 232"}, BadUrl{"dds://a?id=7", "only option"},
                    BadUrl{"dds://a?", "only option"}));

}  // namespace
}  // namespace cairn::proto
