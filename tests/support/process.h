#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace cairn::test {

/// A child process whose output goes to a file. Killed when it goes out of scope.
class Process {
 public:
  /// argv[0] is the program's path.
  Process(const std::vector<std::string>& argv, std::filesystem::path output);
  ~Process();
  Process(Process&& other) noexcept;
  Process& operator=(Process&& other) noexcept;

  void signal(int number) const;
  /// kill -9, and waits for the end.
  void kill();
  /// Waits for it to end by itself; -1 when it did not within `timeout`, else its exit code (128 +
  /// the signal that ended it).
  int wait(std::chrono::milliseconds timeout);
  [[nodiscard]] bool running();
  /// [bytes] Largest resident memory, once it has ended.
  [[nodiscard]] std::int64_t peak_memory_bytes() const { return peak_memory_bytes_; }

  [[nodiscard]] std::string output() const;
  /// Waits until its output contains `text`; false when it ended or `timeout` passed before.
  bool wait_for_output(const std::string& text, std::chrono::milliseconds timeout);

 private:
  bool reap(bool block);

  pid_t pid_ = -1;
  int exit_code_ = -1;
  std::int64_t peak_memory_bytes_ = 0;
  std::filesystem::path output_;
};

/// A folder that is removed with its content at the end of the scope.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Runs a program to its end; output and exit code (-1: it did not end in time and was killed).
struct Finished {
  int exit_code = -1;
  std::string output;
};
Finished run(const std::vector<std::string>& argv,
             std::chrono::milliseconds timeout = std::chrono::seconds(30));

/// Waits until `condition` holds, asking every few milliseconds; false when `timeout` passed.
template <class Condition>
bool eventually(Condition&& condition, std::chrono::milliseconds timeout);

/// A DDS domain for this process alone, so that tests that run side by side do not meet. Its ports
/// and those of the domain 100 above it are nobody else's.
unsigned own_dds_domain();

void pause_briefly();

template <class Condition>
bool eventually(Condition&& condition, std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    pause_briefly();
  }
  return true;
}

}  // namespace cairn::test
