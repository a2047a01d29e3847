#include "tests/support/process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <utility>

namespace cairn::test {

Process::Process(const std::vector<std::string>& argv, std::filesystem::path output)
    : output_(std::move(output)) {
  std::vector<char*> arguments;
  for (const std::string& argument : argv) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  // Emptied here, so that nobody waits for a line and finds the one of the process before.
  const int file = open(output_.c_str(), O_CREAT | O_WRONLY | O_TRUNC | O_APPEND | O_CLOEXEC, 0644);
  pid_ = fork();
  if (pid_ != 0) {
    close(file);
    return;
  }
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // Nothing outlives the tests.
  dup2(file, STDOUT_FILENO);
  dup2(file, STDERR_FILENO);
  execv(arguments[0], arguments.data());
  _exit(127);
}

Process::~Process() { kill(); }

Process::Process(Process&& other) noexcept { *this = std::move(other); }

Process& Process::operator=(Process&& other) noexcept {
  if (this == &other) return *this;
  kill();
  pid_ = std::exchange(other.pid_, -1);
  exit_code_ = other.exit_code_;
  peak_memory_bytes_ = other.peak_memory_bytes_;
  output_ = std::move(other.output_);
  return *this;
}

void Process::signal(int number) const {
  if (pid_ > 0) ::kill(pid_, number);
}

void Process::kill() {
  if (pid_ <= 0) return;
  ::kill(pid_, SIGKILL);
  reap(true);
}

bool Process::reap(bool block) {
  if (pid_ <= 0) return true;
  int status = 0;
  rusage usage{};
  if (wait4(pid_, &status, block ? 0 : WNOHANG, &usage) != pid_) return false;
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  peak_memory_bytes_ = std::int64_t{usage.ru_maxrss} * 1024;
  pid_ = -1;
  return true;
}

bool Process::running() { return !reap(false); }

int Process::wait(std::chrono::milliseconds timeout) {
  return eventually([this] { return !running(); }, timeout) ? exit_code_ : -1;
}

std::string Process::output() const {
  std::ifstream file(output_);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

bool Process::wait_for_output(const std::string& text, std::chrono::milliseconds timeout) {
  bool found = false;
  eventually(
      [&] {
        const bool alive = running();
        found = output().find(text) != std::string::npos;
        return found || !alive;
      },
      timeout);
  return found;
}

TempFolder::TempFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "cairn-test-XXXXXX").string();
  path_ = mkdtemp(name.data());
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

Finished run(const std::vector<std::string>& argv, std::chrono::milliseconds timeout) {
  const TempFolder folder;
  Process process(argv, folder.path() / "output");
  Finished finished;
  finished.exit_code = process.wait(timeout);
  if (finished.exit_code == -1) process.kill();
  finished.output = process.output();
  return finished;
}

unsigned own_dds_domain() {
  static const unsigned domain = [] {
    // Domains up to 100 keep their ports below those that the system hands out by itself. The lock
    // is held as long as this process lives.
    const unsigned first = static_cast<unsigned>(getpid());
    for (unsigned i = 0; i < 100; ++i) {
      const unsigned candidate = 1 + (first + i) % 100;
      const std::filesystem::path lock = std::filesystem::temp_directory_path() /
                                         ("cairn-dds-domain-" + std::to_string(candidate));
      const int file = open(lock.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
      if (file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0) return candidate;
      if (file >= 0) close(file);
    }
    return 1U;
  }();
  return domain;
}

void pause_briefly() { poll(nullptr, 0, 5); }

}  // namespace cairn::test
