// SPDX-License-Identifier: BSD-3-Clause
// The chain is measured by a program of its own (bench/), so that the command line needs no ROS.
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

#include "bench.h"

namespace voxid::cli {
namespace {

namespace fs = std::filesystem;

/// Where the program and the replay driver lie: beside the command as built, or as installed.
struct Places {
  fs::path program, openni2;
};

Result<Places> findPlaces() {
  std::error_code error;
  const fs::path command = fs::read_symlink("/proc/self/exe", error);
  const fs::path bin = command.parent_path(), lib = bin.parent_path() / "lib/voxid";
  const Places built{bin / "voxid_chain_bench", bin.parent_path() / "openni2"};
  const Places installed{lib / "voxid_chain_bench", lib / "openni2"};
  for (const Places& places : {built, installed})
    if (fs::exists(places.program, error)) return places;
  return Status::cannotDo("--chain needs ROS: voxid_chain_bench is not beside " + command.string() +
                          ", as this voxid was built without; scripts/build without --no-ros makes it");
}

/// In the child: becomes the program, with stdout into the pipe.
[[noreturn]] void become(const std::vector<std::string>& words, int out) {
  dup2(out, STDOUT_FILENO);
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  _exit(127);
}

std::string readAll(int in) {
  std::string text;
  char buffer[4096];
  for (ssize_t n; (n = read(in, buffer, sizeof buffer)) > 0;) text.append(buffer, static_cast<std::size_t>(n));
  return text;
}

/// What the program printed; its exit code in `code`.
Result<std::string> outputOf(const std::vector<std::string>& words, int& code) {
  int ends[2];
  if (pipe(ends) != 0) return Status::cannotDo("no pipe can be made for " + words[0]);
  const pid_t pid = fork();
  if (pid == 0) become(words, ends[1]);
  close(ends[1]);
  std::string text = readAll(ends[0]);
  close(ends[0]);
  int status = 0;
  waitpid(pid, &status, 0);
  code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return text;
}

}  // namespace

Result<Json> benchChain(const std::string& folder, const std::string& index, int seconds,
                        const ChainAlignment& alignment) {
  std::error_code error;
  for (const std::string& wanted : {folder, alignment.models}) {
    if (!wanted.empty() && !fs::is_directory(wanted, error)) return Status::cannotDo("there is no folder " + wanted);
  }
  const auto places = findPlaces();
  if (!places.ok()) return places.status;
  int code = -1;
  const auto output =
      outputOf({places.value.program.string(), fs::absolute(folder).string(), fs::absolute(index).string(),
                places.value.openni2.string(), std::to_string(seconds), alignment.mode,
                alignment.models.empty() ? "" : fs::absolute(alignment.models).string()},
               code);
  if (!output.ok()) return output.status;
  Json row = Json::parse(output.value, nullptr, false);
  if (code == 0 && row.is_object()) return row;
  const std::string sentence = output.value.substr(0, output.value.find_last_not_of('\n') + 1);
  return Status::cannotDo(sentence.empty() ? "voxid_chain_bench ended with " + std::to_string(code) : sentence);
}

}  // namespace voxid::cli
