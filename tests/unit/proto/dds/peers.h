#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "proto/carrier.h"

/// What the tests of DDS carriers share.
namespace cairn::proto {

using Bytes = std::vector<std::uint8_t>;
using Clock = std::chrono::steady_clock;

/// A DDS domain that no other test process on this machine uses meanwhile. Below 101 its ports lie
/// outside of the kernel's range for passing sockets.
class TestDomain {
 public:
  TestDomain() {
    const auto start = static_cast<std::uint32_t>(getpid());
    for (std::uint32_t i = 0; i < kDomains && fd_ < 0; ++i) try_lock(1 + (start + i) % kDomains);
    if (fd_ < 0) throw std::runtime_error("no free DDS domain for the test");
  }
  ~TestDomain() { close(fd_); }
  TestDomain(const TestDomain&) = delete;
  TestDomain& operator=(const TestDomain&) = delete;
  [[nodiscard]] std::string url() const {
    return "dds://127.0.0.1?domain=" + std::to_string(domain_);
  }
  [[nodiscard]] std::uint32_t number() const { return domain_; }

 private:
  static constexpr std::uint32_t kDomains = 100;

  void try_lock(std::uint32_t domain) {
    const std::string file = testing::TempDir() + "cairn-dds-domain-" + std::to_string(domain);
    const int fd = open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
    if (fd < 0) return;
    if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
      close(fd);
      return;
    }
    fd_ = fd;
    domain_ = domain;
  }

  int fd_ = -1;
  std::uint32_t domain_ = 0;
};

/// A running dds_echo; killed without warning at the end.
class EchoProcess {
 public:
  explicit EchoProcess(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), DDS_ECHO);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    if (posix_spawn(&pid_, DDS_ECHO, nullptr, nullptr, argv.data(), environ) != 0) {
      throw std::runtime_error("cannot start dds_echo");
    }
  }
  ~EchoProcess() { kill_now(); }
  EchoProcess(const EchoProcess&) = delete;
  EchoProcess& operator=(const EchoProcess&) = delete;

  void kill_now() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    pid_ = 0;
  }

 private:
  pid_t pid_ = 0;
};

/// Receives until `wanted` accepts a frame; sends `request` every 50 ms meanwhile, as the layer
/// above would. Nullopt after `patience`.
inline std::optional<Datagram> exchange(Carrier& carrier, const Datagram& request,
                                        const std::function<bool(const Datagram&)>& wanted,
                                        std::chrono::seconds patience) {
  const auto end = Clock::now() + patience;
  auto next_send = Clock::now();
  while (Clock::now() < end) {
    if (Clock::now() >= next_send) {
      (void)carrier.send(request);
      next_send = Clock::now() + std::chrono::milliseconds(50);
    }
    auto frame = carrier.receive(std::chrono::milliseconds(50));
    if (!frame) {
      ADD_FAILURE() << frame.error().message;
      return std::nullopt;
    }
    if (frame->has_value() && wanted(**frame)) return std::move(**frame);
  }
  return std::nullopt;
}

/// Sends until it comes back from the same peer.
inline bool echoes(Carrier& carrier, const Datagram& frame,
                   std::chrono::seconds patience = std::chrono::seconds(8)) {
  return exchange(
             carrier, frame,
             [&](const Datagram& got) {
               return got.peer == frame.peer && got.bytes == frame.bytes;
             },
             patience)
      .has_value();
}

inline Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

}  // namespace cairn::proto
