#include <unistd.h>

#include <iostream>
#include <variant>

#include "client/cli/commands.h"
#include "client/cli/options.h"

int main(int argc, char** argv) {
  using namespace cairn::cli;
  const auto parsed = parse_arguments({argv + 1, argv + argc});
  if (const auto* end = std::get_if<Exit>(&parsed)) {
    std::cout << end->out;
    std::cerr << end->err;
    return end->code;
  }
  const Terminal terminal{std::cout, std::cerr, ::isatty(STDOUT_FILENO) == 1};
  return run(std::get<Invocation>(parsed), terminal);
}
