// SPDX-License-Identifier: BSD-3-Clause
#include "python.h"

#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace voxid::cli {
namespace {

namespace fs = std::filesystem;

constexpr char kPython[] = "/usr/bin/python3";  // Debian's, which knows NLTK and OpenCV, also where another comes first

/// Beside the command as installed (bin/, share/) or as built (bin/, python/); empty if neither is there.
fs::path findScript(const fs::path& program) {
  const fs::path root = program.parent_path().parent_path();
  for (const char* const folder : {"share/voxid/python", "python"}) {
    fs::path script = root / folder / "voxid_command.py";
    std::error_code error;
    if (fs::exists(script, error)) return script;
  }
  return {};
}

}  // namespace

Status handOver(const char* command, const std::vector<std::string>& arguments) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return Status::cannotDo("/proc/self/exe: " + error.message());
  const fs::path script = findScript(program);
  if (script.empty()) {
    return Status::cannotDo("voxid_command.py is neither in share/voxid/python nor in python beside the folder of " +
                            program.string() + "; scripts/build or an installation puts it there");
  }
  // -B: nothing is written where voxid lies; -E, -s: no module of the user's takes the place of ours; UTF-8 in any
  // locale.
  std::vector<std::string> words = {kPython,          "-B",   "-E", "-s", "-X", "utf8", script.string(),
                                    program.string(), command};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  sigset_t interrupt;  // waits until voxid_command.py can answer it in one line
  sigemptyset(&interrupt);
  sigaddset(&interrupt, SIGINT);
  sigprocmask(SIG_BLOCK, &interrupt, nullptr);
  execv(kPython, argv.data());
  return Status::cannotDo(std::string(kPython) + ": " + std::strerror(errno));
}

}  // namespace voxid::cli
