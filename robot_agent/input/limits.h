#pragma once

#include <string>

namespace cairn::agent {

/// Gathers what is wrong with a configuration: one sentence for each value out of its limits.
class Faults {
 public:
  /// Notes a value that is not within [low, high] (or not a number).
  void check(const std::string& name, double value, double low, double high);
  /// Notes another part's faults, if there are any.
  void add(const std::string& sentences);

  /// All of them, joined by "; ".
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace cairn::agent
