// SPDX-License-Identifier: BSD-3-Clause
#include "child.h"

#include <netinet/in.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <thread>

namespace voxid::bench {
namespace {

constexpr auto kPatience = std::chrono::seconds(5);  // a nodelet manager joins its threads within

/// In the child: becomes the program.
[[noreturn]] void become(const std::vector<std::string>& words, const std::map<std::string, std::string>& environment) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  _exit(127);
}

}  // namespace

Child::Child(const std::vector<std::string>& words, const std::map<std::string, std::string>& environment)
    : pid_(fork()) {
  if (pid_ == 0) become(words, environment);
}

Child::~Child() {
  if (!running()) return;
  kill(pid_, SIGINT);
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (running() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  if (!running()) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

bool Child::running() {
  if (pid_ > 0 && waitpid(pid_, nullptr, WNOHANG) == pid_) pid_ = -1;
  return pid_ > 0;
}

double Child::cpuMs() const {
  clockid_t clock;
  timespec used{};
  if (pid_ <= 0 || clock_getcpuclockid(pid_, &clock) != 0 || clock_gettime(clock, &used) != 0) return 0;
  return static_cast<double>(used.tv_sec) * 1e3 + static_cast<double>(used.tv_nsec) * 1e-6;
}

int freePort(bool udp) {
  const int socket_fd = socket(AF_INET, udp ? SOCK_DGRAM : SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t bytes = sizeof address;
  bind(socket_fd, reinterpret_cast<sockaddr*>(&address), bytes);
  getsockname(socket_fd, reinterpret_cast<sockaddr*>(&address), &bytes);
  close(socket_fd);
  return ntohs(address.sin_port);
}

}  // namespace voxid::bench
