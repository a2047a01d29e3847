#pragma once

#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace cairn::bench {

enum class Better { lower, higher };

/// One measured number.
struct Figure {
  std::string name{};
  double value = 0.0;
  std::string unit{};
  Better better = Better::lower;
  std::optional<double> goal{};           ///< Empty: nothing is asked of it.
  std::map<std::string, double> peers{};  ///< The same number of others, in the same unit.
};

/// Whether the figure reaches its goal; true without one.
[[nodiscard]] bool met(const Figure& figure);

/// What one benchmark measured. Printed as a table for people and, as the last line, one JSON
/// object for programs: {"bench", "figures": [{"name", "value", "unit", "better", "goal", "met",
/// "peers"}]}.
class Report {
 public:
  explicit Report(std::string bench) : bench_(std::move(bench)) {}

  void add(Figure figure) { figures_.push_back(std::move(figure)); }
  void print(std::ostream& out) const;

 private:
  void print_table(std::ostream& out) const;

  std::string bench_;
  std::vector<Figure> figures_;
};

}  // namespace cairn::bench
