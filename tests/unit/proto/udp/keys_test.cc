#include "proto/udp/keys.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

namespace cairn::proto {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kLine = "rover-1 AAECAwQFBgcICQoLDA0ODxAREhMUFRYXGBkaGxwdHh8=";

std::filesystem::path file_with(const std::string& text, mode_t mode) {
  const std::filesystem::path file =
      testing::TempDir() + "keys-" + std::to_string(getpid()) + ".txt";
  std::ofstream(file) << text;
  chmod(file.c_str(), mode);
  return file;
}

TEST(Keys, ReadsALineForEachRobotAndPassesOverComments) {
  const auto keys = parse_keys("# fleet\n\n" + kLine + "\n");
  ASSERT_TRUE(keys) << keys.error().message;
  ASSERT_EQ(keys->size(), 1U);
  EXPECT_EQ(keys->at("rover-1").bytes()[31], 31);
}

TEST(Keys, ANewKeyIsALineOfAKeyFileAndAnotherOneEachTime) {
  const auto one = new_key_line("rover-1");
  const auto other = new_key_line("rover-1");
  ASSERT_TRUE(one && other);
  EXPECT_NE(*one, *other);
  EXPECT_TRUE(parse_keys(*one));
}

TEST(Keys, NamesTheLineThatIsWrongAndQuotesNoKey) {
  for (const std::string line :
       {"rover-1", "Rover AAECAwQFBgcICQoLDA0ODxAREhMUFRYXGBkaGxwdHh8=", "rover-2 c2hvcnQ=",
        "rover-2 AAECAwQFBgcICQoLDA0ODxAREhMUFRYXGBkaGxwdHh8= x", "rover-2 not!base64",
        "rover-1 AAECAwQFBgcICQoLDA0ODxAREhMUFRYXGBkaGxwdHh8="}) {
    const auto keys = parse_keys(kLine + "\n" + line + "\n");
    ASSERT_FALSE(keys) << line;
    EXPECT_THAT(keys.error().message, HasSubstr("line 2"));
    EXPECT_THAT(keys.error().message, Not(HasSubstr("AAECAw")));
  }
}

TEST(Keys, RefusesAFileThatOthersMayRead) {
  const auto file = file_with(kLine, 0640);
  const auto keys = read_keys(file);
  ASSERT_FALSE(keys);
  EXPECT_THAT(keys.error().message, HasSubstr("chmod 600"));
  chmod(file.c_str(), 0600);
  EXPECT_TRUE(read_keys(file));
}

TEST(Keys, TeachesHowToMakeAMissingOne) {
  const auto missing = read_keys("/nowhere/keys");
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("--new-key"));
  const auto other = read_key(file_with(kLine, 0600), "rover-2");
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("rover-2"));
}

TEST(Keys, AreNamedOnTheWireByADigestOfTheirOwn) {
  const Secret a = Secret::random();
  EXPECT_EQ(key_id(a), key_id(a));
  EXPECT_NE(key_id(a), key_id(Secret::random()));
}

}  // namespace
}  // namespace cairn::proto
