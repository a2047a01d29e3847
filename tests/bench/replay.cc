// A real 45-minute log through agent, DDS and server as fast as the machine allows.

#include <cmath>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <regex>
#include <string>

#include "tests/bench/report.h"
#include "tests/support/cairn_programs.h"
#include "tests/support/data_folder.h"

namespace {

using namespace std::chrono_literals;
using cairn::bench::Better;

/// The number that follows `before` in a text; NaN when there is none.
double number_after(const std::string& text, const std::string& before) {
  std::smatch found;
  if (!std::regex_search(text, found, std::regex(before + "([0-9.]+)"))) return std::nan("");
  return std::stod(found[1]);
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path log =
      argc > 1 ? std::filesystem::path(argv[1]) : cairn::test::data_folder() / "logs/intel.clf.bz2";
  if (!std::filesystem::exists(log)) {
    std::cout << "skipped: no log; give one as argument, or the folder that holds "
                 "logs/intel.clf.bz2 in CAIRN_DATA\n";
    return 0;
  }
  const cairn::test::TempFolder folder;
  cairn::test::ServerProcess server(folder);
  if (!server.wait_until_ready() || server.cairn({"found", "log"}).exit_code != 0) {
    std::cerr << server.process().output();
    return 1;
  }
  cairn::test::Process agent =
      cairn::test::start_agent(folder, "replay", {"--site", "log", "--replay", log.string()});
  if (agent.wait(600s) != 0) {
    std::cerr << agent.output() << server.process().output();
    return 1;
  }
  const std::string said = agent.output();
  const nlohmann::json status = server.status();
  server.process().signal(SIGTERM);
  server.process().wait(30s);
  const double log_s = number_after(said, "replayed ");
  const double real_s = number_after(said, "of log in ");
  const nlohmann::json& site = status["sites"][0];

  cairn::bench::Report report("replay");
  report.add({.name = "real time per log time",
              .value = real_s / log_s,
              .unit = "s/s",
              .goal = 1.0 / 50.0});
  report.add({.name = "server peak memory",
              .value = static_cast<double>(server.process().peak_memory_bytes()) / 1e6,
              .unit = "MB"});
  report.add({.name = "agent peak memory",
              .value = static_cast<double>(agent.peak_memory_bytes()) / 1e6,
              .unit = "MB"});
  report.add({.name = "sent up the link", .value = number_after(said, "m, "), .unit = "MB"});
  report.add({.name = "known cells",
              .value = site["known_cells"].get<double>(),
              .unit = "cells",
              .better = Better::higher});
  report.print(std::cout);
  return 0;
}
