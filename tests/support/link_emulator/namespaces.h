#pragma once

#include <sys/types.h>

#include <string>
#include <utility>
#include <vector>

#include "core/common/result.h"

namespace cairn::test {

/// A network of its own with nothing but loopback and one TUN device, held by a process that does
/// nothing else. Needs root, or a kernel that lets users have namespaces and a /dev/net/tun that
/// they may open.
class NetworkNamespace {
 public:
  /// `address`: IPv4 of the device, in a network of 4 addresses (/30).
  static Result<NetworkNamespace> create(const std::string& address);
  ~NetworkNamespace();
  NetworkNamespace(NetworkNamespace&& other) noexcept
      : holder_(std::exchange(other.holder_, -1)),
        device_(std::exchange(other.device_, -1)),
        own_user_(other.own_user_) {}
  NetworkNamespace& operator=(NetworkNamespace&&) = delete;

  /// What the namespace's programs send and receive, an IP packet for each read and write. Does
  /// not block.
  [[nodiscard]] int device() const { return device_; }
  /// The command line that runs `argv` inside.
  [[nodiscard]] std::vector<std::string> inside(const std::vector<std::string>& argv) const;

 private:
  NetworkNamespace(pid_t holder, int device, bool own_user)
      : holder_(holder), device_(device), own_user_(own_user) {}

  pid_t holder_ = -1;
  int device_ = -1;
  bool own_user_ = false;
};

}  // namespace cairn::test
