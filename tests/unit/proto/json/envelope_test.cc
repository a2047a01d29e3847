#include "proto/json/envelope.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cairn::api {
namespace {

using testing::HasSubstr;

TEST(ParseJson, RefusesWhatIsNoJson) {
  for (const char* text : {"", "{", "{\"a\":NaN}", "{\"a\":Infinity}", "{\"a\":1e999}", "{'a':1}",
                           "{\"a\":\"\xff\"}", "nul"}) {
    const auto json = parse_json(text, 100);
    ASSERT_FALSE(json) << text;
    EXPECT_THAT(json.error().message, HasSubstr("message is not JSON"));
  }
}

TEST(ParseJson, RefusesTooManyBytes) {
  EXPECT_TRUE(parse_json("[1,2]", 5));
  EXPECT_FALSE(parse_json("[1,2]", 4));
}

TEST(ParseJson, RefusesDeepNestingButNotBracketsInText) {
  const auto nested = [](int depth) {
    return std::string(static_cast<std::size_t>(depth), '[') +
           std::string(static_cast<std::size_t>(depth), ']');
  };
  EXPECT_TRUE(parse_json(nested(kMaxNesting), 1000));
  EXPECT_FALSE(parse_json(nested(kMaxNesting + 1), 1000));
  EXPECT_FALSE(parse_json(nested(30'000), kMaxRequestBytes));
  EXPECT_TRUE(
      parse_json("\"" + std::string(100, '[') + "\\\"" + std::string(100, '{') + "\"", 1000));
}

TEST(Request, IsReadBackAsItWasWritten) {
  Request read;
  ASSERT_FALSE(parse_request(request_text({7, "goto", {{"x_m", 1}}}), read));
  EXPECT_EQ(read.id, 7U);
  EXPECT_EQ(read.method, "goto");
  EXPECT_EQ(read.params, (nlohmann::json{{"x_m", 1}}));
}

TEST(Request, MayLeaveOutItsParameters) {
  Request read;
  ASSERT_FALSE(parse_request(R"({"id":1,"method":"status"})", read));
  EXPECT_TRUE(read.params.is_object());
}

TEST(Request, IsRefusedWithTheKeyThatIsWrong) {
  const auto fault = [](const char* text) {
    Request read;
    const auto refused = parse_request(text, read);
    return refused ? refused->error.message : "none";
  };
  EXPECT_THAT(fault("[]"), HasSubstr("expected an object"));
  EXPECT_THAT(fault(R"({"method":"stop"})"), HasSubstr("id: expected"));
  EXPECT_THAT(fault(R"({"id":-1,"method":"stop"})"), HasSubstr("id: expected"));
  EXPECT_THAT(fault(R"({"id":4294967296,"method":"stop"})"), HasSubstr("id: expected"));
  EXPECT_THAT(fault(R"({"id":1})"), HasSubstr("method: expected"));
  EXPECT_THAT(fault(R"({"id":1,"method":"stop","params":[]})"), HasSubstr("params: expected"));
  EXPECT_THAT(fault(R"({"id":1,"method":"stop","extra":1})"), HasSubstr("unknown key \"extra\""));
}

TEST(Request, FaultCarriesTheIdWhenThatCouldBeRead) {
  Request read;
  EXPECT_EQ(parse_request(R"({"id":5,"method":1})", read)->id, 5U);
  EXPECT_EQ(parse_request("nonsense", read)->id, std::nullopt);
}

TEST(Answer, CarriesResultErrorOrEvent) {
  const auto result = parse_answer(result_text(3, {{"a", 1}}));
  ASSERT_TRUE(result);
  EXPECT_EQ(result->id, 3U);
  EXPECT_EQ(result->body["a"], 1);
  const auto error = parse_answer(error_text(4, {ErrorCode::conflict, "taken"}));
  ASSERT_TRUE(error && error->error);
  EXPECT_EQ(error->error->code, ErrorCode::conflict);
  EXPECT_EQ(error->error->message, "taken");
  const auto event = parse_answer(event_text("status", 1));
  ASSERT_TRUE(event);
  EXPECT_EQ(event->event, "status");
  EXPECT_FALSE(parse_answer("{}"));
  EXPECT_FALSE(parse_answer("3"));
}

TEST(Answer, ReplacesBytesThatAreNoUtf8InsteadOfThrowing) {
  const auto error = parse_answer(error_text(4, {ErrorCode::io, "disk \xff"}));
  ASSERT_TRUE(error && error->error);
  EXPECT_THAT(error->error->message, HasSubstr("disk "));
}

TEST(ErrorNames, AreReadBackToTheirCodes) {
  for (int i = 0; i <= static_cast<int>(ErrorCode::unavailable); ++i) {
    EXPECT_EQ(code_of(code_name(static_cast<ErrorCode>(i))), static_cast<ErrorCode>(i));
  }
  EXPECT_EQ(code_of("nonsense"), ErrorCode::unavailable);
}

TEST(TileHead, HasTheBytesOfTheSpecification) {
  std::string bytes;
  append_tile_head({0x01020304, {-1, -2, 3}}, bytes);
  EXPECT_EQ(bytes, std::string("\x04\x03\x02\x01\xff\xfe\xff\xff\xff\x03\x00\x00\x00", 13));
  const auto head = read_tile_head(bytes);
  ASSERT_TRUE(head);
  EXPECT_EQ(head->request, 0x01020304U);
  EXPECT_EQ(head->key, (TileKey{-1, -2, 3}));
  EXPECT_FALSE(read_tile_head(bytes.substr(0, 12)));
}

}  // namespace
}  // namespace cairn::api
