// SPDX-License-Identifier: BSD-3-Clause
// Faults on demand: a file or FIFO that is polled for commands.
#pragma once

#include <string>
#include <vector>

namespace voxid::replay {

/// One line of the control file: a word and, for some, a number.
struct Command {
  enum class Kind { Unplug, Replug, Stall, Drop, Corrupt, Noise };
  Kind kind = Kind::Unplug;
  int amount = 0;  ///< ms for Unplug (0: until Replug) and Stall; frames for Drop, Corrupt, Noise
};

/// False if the line is no command.
bool parseCommand(const std::string& line, Command& command);

/// Reads whole lines as they are appended. What a plain file held at construction is not obeyed.
class ControlFile {
 public:
  explicit ControlFile(std::string path);
  ~ControlFile();
  ControlFile(const ControlFile&) = delete;
  ControlFile& operator=(const ControlFile&) = delete;

  /// Lines that came since the last call. Never blocks; a file that does not exist yet is opened once it does.
  std::vector<std::string> poll();

 private:
  bool open();

  std::string path_, partial_;
  int fd_ = -1;
};

}  // namespace voxid::replay
