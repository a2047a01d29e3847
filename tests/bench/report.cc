#include "tests/bench/report.h"

#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

namespace cairn::bench {
namespace {

const char* name_of(Better better) { return better == Better::lower ? "lower" : "higher"; }

nlohmann::ordered_json to_json(const Figure& figure) {
  nlohmann::ordered_json json;
  json["name"] = figure.name;
  json["value"] = figure.value;
  json["unit"] = figure.unit;
  json["better"] = name_of(figure.better);
  json["goal"] = figure.goal ? nlohmann::ordered_json(*figure.goal) : nlohmann::ordered_json();
  json["met"] = met(figure);
  json["peers"] = nlohmann::ordered_json(nlohmann::ordered_json::object());
  for (const auto& [name, value] : figure.peers) json["peers"][name] = value;
  return json;
}

std::string goal_of(const Figure& figure) {
  if (!figure.goal) return "";
  std::ostringstream text;
  text << (figure.better == Better::lower ? "<= " : ">= ") << *figure.goal
       << (met(figure) ? "  met" : "  MISSED");
  return text.str();
}

}  // namespace

bool met(const Figure& figure) {
  if (!figure.goal) return true;
  return figure.better == Better::lower ? figure.value <= *figure.goal
                                        : figure.value >= *figure.goal;
}

void Report::print_table(std::ostream& out) const {
  for (const Figure& figure : figures_) {
    out << std::left << std::setw(48) << figure.name << std::right << std::setw(14) << figure.value
        << ' ' << std::left << std::setw(14) << figure.unit << goal_of(figure) << '\n';
    for (const auto& [name, value] : figure.peers) {
      out << "    " << std::left << std::setw(44) << name << std::right << std::setw(14) << value
          << '\n';
    }
  }
}

void Report::print(std::ostream& out) const {
  print_table(out);
  nlohmann::ordered_json json{{"bench", bench_}};
  json["figures"] = nlohmann::ordered_json::array();
  for (const Figure& figure : figures_) json["figures"].push_back(to_json(figure));
  out << json.dump() << std::endl;
}

}  // namespace cairn::bench
