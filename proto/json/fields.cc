#include "proto/json/fields.h"

#include <algorithm>
#include <charconv>
#include <utility>

namespace cairn::api {

namespace {

bool is_name(const std::string& text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

std::string shown(double number) {
  std::array<char, 32> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), number, std::chars_format::general, 12);
  return {text.data(), end.ptr};
}

std::string joined(std::span<const std::string_view> choices) {
  std::string text;
  for (const auto& choice : choices) {
    text += (text.empty() ? "\"" : ", \"") + std::string(choice) + "\"";
  }
  return text;
}

/// Keys come from outside: what is repeated in a message is cut.
std::string cut(const std::string& text) { return text.substr(0, 64); }

}  // namespace

FieldReader::FieldReader(const nlohmann::json& json, std::string path, std::string& fault)
    : json_(json), path_(std::move(path)), fault_(fault) {
  if (json_.is_object()) return;
  const std::string where = path_.empty() ? "message" : path_.substr(0, path_.size() - 1);
  fail(where + ": expected an object");
}

void FieldReader::refuse_unknown_keys() {
  if (!json_.is_object()) return;
  for (const auto& [key, value] : json_.items()) {
    if (!taken_.contains(key)) {
      return fail("unknown key \"" + path_ + cut(key) + "\": expected " +
                  joined(std::vector<std::string_view>(taken_.begin(), taken_.end())));
    }
  }
}

void FieldReader::read(const nlohmann::json& json, const std::string& path, bool& value,
                       const Rule& /*rule*/) {
  if (!json.is_boolean()) return fail(path + ": expected true or false");
  value = json.get<bool>();
}

void FieldReader::read(const nlohmann::json& json, const std::string& path, double& value,
                       const Rule& rule) {
  if (!json.is_number()) return expect_number(path, false, rule);
  const auto number = json.get<double>();
  if (!std::isfinite(number) || number < rule.lowest || number > rule.highest) {
    return expect_number(path, false, rule);
  }
  value = number;
}

void FieldReader::read(const nlohmann::json& json, const std::string& path, std::string& value,
                       const Rule& rule) {
  const auto* text = json.get_ptr<const std::string*>();
  if (!rule.choices.empty()) {
    if (text == nullptr || std::ranges::find(rule.choices, *text) == rule.choices.end()) {
      return fail(path + ": expected one of " + joined(rule.choices));
    }
  } else if (rule.name) {
    if (text == nullptr || text->size() > rule.max_size || !is_name(*text)) {
      return fail(path + ": expected a name of 1 to " + std::to_string(rule.max_size) +
                  " characters a-z, 0-9, _ and -");
    }
  } else if (text == nullptr || text->size() > rule.max_size) {
    return fail(path + ": expected a text of at most " + std::to_string(rule.max_size) + " bytes");
  }
  value = *text;
}

bool FieldReader::whole_number_within(const nlohmann::json& json, double lowest, double highest) {
  if (!json.is_number_integer()) return false;
  // Unsigned and signed are asked separately: a number above 2^63 is no int64.
  const auto number = json.is_number_unsigned() ? static_cast<double>(json.get<std::uint64_t>())
                                                : static_cast<double>(json.get<std::int64_t>());
  return number >= lowest && number <= highest;
}

const nlohmann::json* FieldReader::take(const char* key) {
  taken_.insert(key);
  if (!fault_.empty()) return nullptr;
  const auto found = json_.find(key);
  return found == json_.end() ? nullptr : &*found;
}

void FieldReader::expect_number(const std::string& path, bool whole, const Rule& rule) {
  std::string expected = whole ? "a whole number" : "a number";
  if (rule.lowest > std::numeric_limits<double>::lowest()) {
    expected += " from " + shown(rule.lowest);
  }
  if (rule.highest < std::numeric_limits<double>::max()) expected += " to " + shown(rule.highest);
  fail(path + ": expected " + expected);
}

void FieldReader::fail(std::string fault) {
  if (fault_.empty()) fault_ = std::move(fault);
}

}  // namespace cairn::api
