// SPDX-License-Identifier: BSD-3-Clause
// voxid_read_mesh FILE SECONDS BYTES: what readByAssimp() starts. The mesh goes to standard output.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "mesh_import.h"

namespace {

/// What the caller had open stays open no longer than the caller wants it.
void closeOthers() {
  std::vector<int> files;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd"))
    files.push_back(std::atoi(entry.path().filename().c_str()));
  for (const int file : files)
    if (file > STDERR_FILENO) ::close(file);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: voxid_read_mesh FILE SECONDS BYTES (voxid starts it itself)\n");
    return 2;
  }
  closeOthers();
  voxid::MeshReaderLimits limits;
  limits.seconds = std::atoi(argv[2]);
  limits.memory_bytes = std::strtoull(argv[3], nullptr, 10);
  voxid::importInto(::dup(STDOUT_FILENO), argv[1], limits);
}
