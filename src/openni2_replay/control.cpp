// SPDX-License-Identifier: BSD-3-Clause
#include "control.h"

#include <fcntl.h>
#include <unistd.h>

#include <sstream>

namespace voxid::replay {
namespace {

struct Word {
  const char* text;
  Command::Kind kind;
  bool needs_amount;
};
constexpr Word kWords[] = {
    {"unplug", Command::Kind::Unplug, false},  {"replug", Command::Kind::Replug, false},
    {"stall", Command::Kind::Stall, true},     {"drop", Command::Kind::Drop, true},
    {"corrupt", Command::Kind::Corrupt, true}, {"noise", Command::Kind::Noise, true},
};

}  // namespace

bool parseCommand(const std::string& line, Command& command) {
  std::istringstream in(line);
  std::string text;
  in >> text;
  for (const Word& word : kWords) {
    if (text != word.text) continue;
    command = {word.kind, 0};
    const bool has_amount = static_cast<bool>(in >> command.amount);
    return has_amount ? command.amount > 0 : !word.needs_amount && in.eof();
  }
  return false;
}

ControlFile::ControlFile(std::string path) : path_(std::move(path)) {
  if (open()) lseek(fd_, 0, SEEK_END);  // fails on a FIFO, which keeps nothing from before
}

ControlFile::~ControlFile() {
  if (fd_ >= 0) close(fd_);
}

bool ControlFile::open() {
  if (fd_ < 0 && !path_.empty()) fd_ = ::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  return fd_ >= 0;
}

std::vector<std::string> ControlFile::poll() {
  std::vector<std::string> lines;
  if (!open()) return lines;
  char buffer[512];
  for (ssize_t n; (n = read(fd_, buffer, sizeof buffer)) > 0;) partial_.append(buffer, static_cast<std::size_t>(n));
  for (std::size_t end; (end = partial_.find('\n')) != std::string::npos; partial_.erase(0, end + 1))
    lines.push_back(partial_.substr(0, end));
  return lines;
}

}  // namespace voxid::replay
