#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

/// Each message is described once, by a function that names its keys, members and rules to a
/// visitor; FieldWriter and FieldReader are the two visitors, so what is written can be read.
namespace cairn::api {

/// What a value must satisfy.
struct Rule {
  double lowest = std::numeric_limits<double>::lowest();
  double highest = std::numeric_limits<double>::max();
  std::size_t max_size = 256;                      ///< Characters of a text, elements of a list.
  std::span<const std::string_view> choices = {};  ///< Not empty: the text is one of these.
  bool name = false;                               ///< The text is a name: [a-z0-9_-]+

  [[nodiscard]] Rule at_most(std::size_t size) const {
    Rule rule = *this;
    rule.max_size = size;
    return rule;
  }
};

class FieldWriter {
 public:
  explicit FieldWriter(nlohmann::json& json) : json_(json) { json_ = nlohmann::json::object(); }

  template <class T>
  void required(const char* key, const T& value, const Rule& /*rule*/ = {}) {
    json_[key] = value;
  }
  template <class T>
  void defaulted(const char* key, const T& value, const Rule& /*rule*/ = {}) {
    json_[key] = value;
  }
  template <class T>
  void optional(const char* key, const std::optional<T>& value, const Rule& /*rule*/ = {}) {
    if (value) json_[key] = *value;
  }

 private:
  nlohmann::json& json_;
};

/// Reads an object's keys; remembers the first fault and then does nothing more.
class FieldReader {
 public:
  /// `path` stands before the keys in messages ("", "from.", "robots[2].").
  FieldReader(const nlohmann::json& json, std::string path, std::string& fault);

  template <class T>
  void required(const char* key, T& value, const Rule& rule = {}) {
    if (const auto* found = take(key)) {
      read(*found, path_ + key, value, rule);
    } else {
      fail("missing key \"" + path_ + key + "\"");
    }
  }
  template <class T>
  void defaulted(const char* key, T& value, const Rule& rule = {}) {
    if (const auto* found = take(key)) read(*found, path_ + key, value, rule);
  }
  template <class T>
  void optional(const char* key, std::optional<T>& value, const Rule& rule = {}) {
    if (const auto* found = take(key)) read(*found, path_ + key, value.emplace(), rule);
  }

  /// Call last: what was not asked for is unknown.
  void refuse_unknown_keys();

 private:
  void read(const nlohmann::json& json, const std::string& path, bool& value, const Rule& rule);
  void read(const nlohmann::json& json, const std::string& path, double& value, const Rule& rule);
  void read(const nlohmann::json& json, const std::string& path, std::string& value,
            const Rule& rule);

  template <std::integral T>
  requires(!std::same_as<T, bool>) void read(const nlohmann::json& json, const std::string& path,
                                             T& value, const Rule& rule) {
    const double lowest = std::max(rule.lowest, static_cast<double>(std::numeric_limits<T>::min()));
    const double highest =
        std::min(rule.highest, static_cast<double>(std::numeric_limits<T>::max()));
    if (!whole_number_within(json, lowest, highest)) return expect_number(path, true, rule);
    value = json.get<T>();
  }

  template <class T>
  void read(const nlohmann::json& json, const std::string& path, std::vector<T>& list,
            const Rule& rule) {
    if (!json.is_array() || json.size() > rule.max_size) {
      return fail(path + ": expected a list of at most " + std::to_string(rule.max_size));
    }
    list.resize(json.size());
    for (std::size_t i = 0; i < list.size() && fault_.empty(); ++i) {
      read(json[i], path + "[" + std::to_string(i) + "]", list[i], rule);
    }
  }

  template <class T>
  requires std::is_class_v<T>
  void read(const nlohmann::json& json, const std::string& path, T& message, const Rule& /*rule*/) {
    FieldReader reader(json, path + ".", fault_);
    describe(reader, message);
    reader.refuse_unknown_keys();
  }

  [[nodiscard]] static bool whole_number_within(const nlohmann::json& json, double lowest,
                                                double highest);
  const nlohmann::json* take(const char* key);
  void expect_number(const std::string& path, bool whole, const Rule& rule);
  void fail(std::string fault);

  const nlohmann::json& json_;
  std::string path_;
  std::string& fault_;
  std::set<std::string_view> taken_;
};

}  // namespace cairn::api
