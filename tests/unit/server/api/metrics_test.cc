#include "server/api/metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cairn::server {
namespace {

using testing::HasSubstr;

TEST(Metrics, HaveARobotsLinkAndASitesMap) {
  api::RobotJson robot;
  robot.id = "r1";
  robot.site = "yard";
  robot.link = {true, 0.25, 0.1, 12'345'678'901, 2, 3, 4, 5};
  robot.link.spool = api::SpoolJson{"failed", 12, 3'456'789, 5, 2};
  api::SiteJson site;
  site.name = "yard";
  site.known_cells = 42;
  site.submaps = 6;
  site.commits = 7;
  const auto text = metrics_text({"0.1.0", 9.0, {site}, {robot}}, {2, 1});
  EXPECT_THAT(text,
              HasSubstr("cairn_robot_bytes_up_total{robot=\"r1\",site=\"yard\"} 12345678901\n"));
  EXPECT_THAT(text, HasSubstr("cairn_robot_silence_seconds{robot=\"r1\",site=\"yard\"} 0.25\n"));
  EXPECT_THAT(text, HasSubstr("cairn_robot_spool_bytes{robot=\"r1\",site=\"yard\"} 3456789\n"));
  EXPECT_THAT(text, HasSubstr("cairn_robot_spool_failed{robot=\"r1\",site=\"yard\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("cairn_robot_spool_dropped{robot=\"r1\",site=\"yard\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("cairn_robot_backlog_blocks{robot=\"r1\",site=\"yard\"} 5\n"));
  EXPECT_THAT(
      text,
      HasSubstr("# TYPE cairn_site_known_cells gauge\ncairn_site_known_cells{site=\"yard\"} 42\n"));
  EXPECT_THAT(text, HasSubstr("cairn_site_submaps{site=\"yard\"} 6\n"));
  EXPECT_THAT(text, HasSubstr("cairn_site_commits_total{site=\"yard\"} 7\n"));
  EXPECT_THAT(text, HasSubstr("cairn_api_connections_refused_total 1\n"));
}

TEST(Metrics, EscapeWhatWouldEndALabel) {
  EXPECT_THAT(metrics_text({"a\"b\\c\nd", 0.0, {}, {}}, {}),
              HasSubstr("cairn_info{version=\"a\\\"b\\\\c\\nd\"} 1\n"));
}

}  // namespace
}  // namespace cairn::server
