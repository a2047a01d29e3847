#include "tests/bench/report.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

namespace cairn::bench {
namespace {

std::string last_line(const Report& report) {
  std::ostringstream out;
  report.print(out);
  const std::string text = out.str();
  const std::size_t start = text.rfind('\n', text.size() - 2);
  return text.substr(start + 1, text.size() - start - 2);
}

TEST(Report, EndsInOneLineOfJson) {
  Report report("speed");
  report.add({"walk", 2.5, "m/s", Better::higher, 2.0, {{"snail", 0.01}}});
  report.add({"rest", 1.0, "s", Better::lower, std::nullopt, {}});
  EXPECT_EQ(last_line(report),
            R"({"bench":"speed","figures":[)"
            R"({"name":"walk","value":2.5,"unit":"m/s","better":"higher","goal":2.0,"met":true,)"
            R"("peers":{"snail":0.01}},)"
            R"({"name":"rest","value":1.0,"unit":"s","better":"lower","goal":null,"met":true,)"
            R"("peers":{}}]})");
}

TEST(Report, AGoalIsMetOnItsOwnSide) {
  EXPECT_TRUE(met({.value = 3.0, .better = Better::lower, .goal = 3.0}));
  EXPECT_FALSE(met({.value = 3.1, .better = Better::lower, .goal = 3.0}));
  EXPECT_TRUE(met({.value = 3.0, .better = Better::higher, .goal = 3.0}));
  EXPECT_FALSE(met({.value = 2.9, .better = Better::higher, .goal = 3.0}));
}

TEST(Report, SaysWhenAGoalIsMissed) {
  Report report("speed");
  report.add({"walk", 1.0, "m/s", Better::higher, 2.0, {}});
  std::ostringstream out;
  report.print(out);
  EXPECT_NE(out.str().find("MISSED"), std::string::npos);
}

}  // namespace
}  // namespace cairn::bench
