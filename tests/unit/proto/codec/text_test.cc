#include "proto/codec/text.h"

#include <gtest/gtest.h>

#include "proto/codec/records.h"

namespace cairn::proto {
namespace {

TEST(Text, NamesAreShortAndPlain) {
  EXPECT_TRUE(valid_name("rover-1_b"));
  EXPECT_TRUE(valid_name(std::string(kMaxNameBytes, 'a')));
  EXPECT_FALSE(valid_name(""));
  EXPECT_FALSE(valid_name(std::string(kMaxNameBytes + 1, 'a')));
  EXPECT_FALSE(valid_name("Rover"));
  EXPECT_FALSE(valid_name("a b"));
  EXPECT_FALSE(valid_name("../a"));
}

TEST(Text, OrdinaryTextTravelsUnchanged) {
  EXPECT_EQ(wire_text("tilt 31° — größer 🪨"), "tilt 31° — größer 🪨");
  EXPECT_TRUE(valid_text(""));
}

TEST(Text, LongTextIsCutBetweenCodePoints) {
  const std::string cut = wire_text(std::string(kMaxTextBytes - 1, 'a') + "°");
  EXPECT_EQ(cut, std::string(kMaxTextBytes - 1, 'a'));
  EXPECT_EQ(wire_text(std::string(1000, 'b')).size(), kMaxTextBytes);
}

TEST(Text, ControlCharactersBecomeSpacesAndArePeerErrors) {
  EXPECT_EQ(wire_text("a\nb\x1b[c\x7f"), "a b [c ");
  EXPECT_EQ(wire_text("x\xC2\x85y"), "x y");  // U+0085
  EXPECT_FALSE(valid_text("a\nb"));
}

TEST(Text, WhatIsNotUtf8BecomesAQuestionMarkAndIsAPeerError) {
  for (const char* bad : {"\xFF", "\xC0\x80", "\xED\xA0\x80", "\xF5\x80\x80\x80", "\xE2\x82"}) {
    EXPECT_FALSE(valid_text(bad));
    EXPECT_TRUE(valid_text(wire_text(bad)));
    EXPECT_EQ(wire_text(bad).front(), '?');
  }
}

}  // namespace
}  // namespace cairn::proto
