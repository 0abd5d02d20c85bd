// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <map>
#include <string>
#include <vector>

namespace voxid::bench {

/// A program that runs beside this one and ends with it, at the latest.
class Child {
 public:
  /// `words`: the program's path and its arguments. `environment` is set on top of ours. What it prints to stdout goes
  /// to stderr, so that stdout stays ours.
  Child(const std::vector<std::string>& words, const std::map<std::string, std::string>& environment);
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  bool running();
  double cpuMs() const;  ///< of all its threads since it began; 0 once it has ended

 private:
  pid_t pid_ = -1;
};

/// A port of this machine that nobody uses now, of TCP or of UDP.
int freePort(bool udp);

}  // namespace voxid::bench
