#include "tests/support/link_emulator/namespaces.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string_view>

namespace cairn::test {
namespace {

// What follows runs in a forked child until its report: plain system calls, no allocation that
// another thread's lock could block.

constexpr const char* kDevice = "link0";

bool write_file(const char* path, std::string_view text) {
  const int fd = open(path, O_WRONLY | O_CLOEXEC);
  if (fd < 0) return false;
  const bool all = write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  close(fd);
  return all;
}

/// Root inside, the caller outside.
bool become_root_of_own(uid_t uid, gid_t gid) {
  std::array<char, 64> map{};
  std::snprintf(map.data(), map.size(), "0 %u 1\n", uid);
  if (!write_file("/proc/self/uid_map", map.data())) return false;
  (void)write_file("/proc/self/setgroups", "deny");
  std::snprintf(map.data(), map.size(), "0 %u 1\n", gid);
  return write_file("/proc/self/gid_map", map.data());
}

bool set_address(int socket, unsigned long request, ifreq& device, const char* text) {
  auto* in = reinterpret_cast<sockaddr_in*>(&device.ifr_addr);
  *in = {};
  in->sin_family = AF_INET;
  return inet_pton(AF_INET, text, &in->sin_addr) == 1 && ioctl(socket, request, &device) == 0;
}

bool bring_up(int socket, const char* name) {
  ifreq device{};
  std::strncpy(device.ifr_name, name, IFNAMSIZ - 1);
  device.ifr_flags = IFF_UP | IFF_RUNNING;
  return ioctl(socket, SIOCSIFFLAGS, &device) == 0;
}

int open_device(const char* address) {
  const int tun = open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (tun < 0) return -1;
  ifreq device{};
  device.ifr_flags = IFF_TUN | IFF_NO_PI;
  std::strncpy(device.ifr_name, kDevice, IFNAMSIZ - 1);
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool up = socket >= 0 && ioctl(tun, TUNSETIFF, &device) == 0 &&
                  set_address(socket, SIOCSIFADDR, device, address) &&
                  set_address(socket, SIOCSIFNETMASK, device, "255.255.255.252") &&
                  bring_up(socket, kDevice) && bring_up(socket, "lo");
  return up ? tun : -1;
}

/// Sends the descriptor, or only `error`.
void report(int channel, int descriptor, int error) {
  iovec content{.iov_base = &error, .iov_len = sizeof error};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
  msghdr message{};
  message.msg_iov = &content;
  message.msg_iovlen = 1;
  if (descriptor >= 0) {
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    cmsghdr* head = CMSG_FIRSTHDR(&message);
    head->cmsg_level = SOL_SOCKET;
    head->cmsg_type = SCM_RIGHTS;
    head->cmsg_len = CMSG_LEN(sizeof(int));
    std::memcpy(CMSG_DATA(head), &descriptor, sizeof descriptor);
  }
  (void)sendmsg(channel, &message, MSG_NOSIGNAL);
}

struct Report {
  int descriptor = -1;
  int error = EPIPE;
};

Report await_report(int channel) {
  Report report;
  iovec content{.iov_base = &report.error, .iov_len = sizeof report.error};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
  msghdr message{};
  message.msg_iov = &content;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  if (recvmsg(channel, &message, MSG_CMSG_CLOEXEC) <= 0) return report;
  if (const cmsghdr* head = CMSG_FIRSTHDR(&message); head != nullptr) {
    std::memcpy(&report.descriptor, CMSG_DATA(head), sizeof report.descriptor);
  }
  return report;
}

[[noreturn]] void hold(int channel, bool own_user, const char* address, uid_t uid, gid_t gid) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  int device = -1;
  errno = 0;
  if (unshare(CLONE_NEWNET | (own_user ? CLONE_NEWUSER : 0)) == 0 &&
      (!own_user || become_root_of_own(uid, gid))) {
    device = open_device(address);
  }
  report(channel, device, errno);
  for (;;) pause();
}

}  // namespace

Result<NetworkNamespace> NetworkNamespace::create(const std::string& address) {
  const bool own_user = geteuid() != 0;
  const uid_t uid = geteuid();
  const gid_t gid = getegid();
  std::array<int, 2> channel{};
  if (socketpair(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0, channel.data()) != 0) {
    return Error{ErrorCode::io, "no socket pair"};
  }
  const pid_t holder = fork();
  if (holder == 0) hold(channel[1], own_user, address.c_str(), uid, gid);
  const Report made = holder > 0 ? await_report(channel[0]) : Report{};
  close(channel[0]);
  close(channel[1]);
  NetworkNamespace network(holder, made.descriptor, own_user);
  if (made.descriptor >= 0) return network;
  return Error{
      ErrorCode::unavailable,
      std::string("no network namespace with a TUN device here: ") + std::strerror(made.error)};
}

NetworkNamespace::~NetworkNamespace() {
  if (device_ >= 0) close(device_);
  if (holder_ <= 0) return;
  kill(holder_, SIGKILL);
  waitpid(holder_, nullptr, 0);
}

std::vector<std::string> NetworkNamespace::inside(const std::vector<std::string>& argv) const {
  std::vector<std::string> command{"/usr/bin/nsenter", "--target", std::to_string(holder_),
                                   "--net"};
  if (own_user_) command.insert(command.end(), {"--user", "--preserve-credentials"});
  command.insert(command.end(), argv.begin(), argv.end());
  return command;
}

}  // namespace cairn::test
