// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/mesh_reader.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <iterator>

#include "mesh_import.h"

namespace voxid {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxVertices = std::uint64_t{1} << 27;  ///< some 1.5 GiB; also of triangles

std::string extensionOf(const std::string& path) {
  const std::size_t dot = path.find_last_of("./");
  if (dot == std::string::npos || path[dot] == '/') return {};
  std::string extension = path.substr(dot + 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}

/// The reading end of the child's pipe, with a deadline for all of it.
class Inbox {
 public:
  Inbox(int pipe, int seconds) : pipe_(pipe), deadline_(Clock::now() + std::chrono::seconds(seconds)) {}

  bool late() const { return late_; }

  bool read(void* data, std::size_t bytes) {
    char* at = static_cast<char*>(data);
    while (bytes > 0) {
      if (!wait()) return false;
      const ssize_t got = ::read(pipe_, at, bytes);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return false;
      at += got;
      bytes -= static_cast<std::size_t>(got);
    }
    return true;
  }

  /// In steps, so that memory is taken for what arrived and not for what was promised.
  template <typename T>
  bool readMany(std::vector<T>& values, std::uint64_t count) {
    constexpr std::uint64_t kStep = 1 << 16;
    while (values.size() < count) {
      const std::size_t first = values.size(), step = std::min(kStep, count - first);
      values.resize(first + step);
      if (!read(values.data() + first, step * sizeof(T))) return false;
    }
    return true;
  }

 private:
  using Clock = std::chrono::steady_clock;

  bool wait() {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline_ - Clock::now()).count();
    pollfd waited{pipe_, POLLIN, 0};
    const int ready = left > 0 ? ::poll(&waited, 1, static_cast<int>(left)) : 0;
    if (ready < 0 && errno == EINTR) return wait();
    late_ = ready == 0;
    return ready > 0;
  }

  int pipe_;
  Clock::time_point deadline_;
  bool late_ = false;
};

/// Says nothing of the mesh: voxid acquire (judge.py) knows it by its first words.
Status notStarted(const std::string& why) {
  return Status::cannotDo("cannot start lib/voxid/voxid_read_mesh, which reads this format: " + why);
}

/// The reason that a child gives which sent no mesh.
Status howItEnded(pid_t child) {
  constexpr int kNotLoaded = 127;  // by the system's loader
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status))
    return Status::cannotDo(std::string("Assimp crashed (") + ::strsignal(WTERMSIG(status)) + ")");
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotLoaded)
    return notStarted("a library is not there; install voxid anew");
  return Status::cannotDo("Assimp ended without a mesh, out of memory perhaps");
}

Result<Mesh> receive(Inbox& inbox, std::string& refusal) {
  MeshPreamble preamble;
  Mesh mesh;
  if (!inbox.read(&preamble, sizeof preamble)) return Status::cannotDo("no answer");
  preamble.refusal[sizeof preamble.refusal - 1] = '\0';
  refusal = preamble.refusal;
  if (!refusal.empty()) return Status::cannotDo("Assimp: " + refusal);
  if (preamble.vertices > kMaxVertices || preamble.triangles > kMaxVertices) {
    refusal = "too large";
    return Status::cannotDo("more than " + std::to_string(kMaxVertices) + " vertices or triangles");
  }
  const bool whole =
      inbox.readMany(mesh.vertices, preamble.vertices) && inbox.readMany(mesh.triangles, preamble.triangles);
  if (!whole) return Status::cannotDo("no answer");
  return mesh;
}

Result<Mesh> receiveFrom(pid_t child, int pipe, const MeshReaderLimits& limits) {
  Inbox inbox(pipe, limits.seconds);
  std::string refusal;
  Result<Mesh> mesh = receive(inbox, refusal);
  if (inbox.late() || !refusal.empty()) ::kill(child, SIGKILL);
  const Status ending = howItEnded(child);
  if (mesh.ok() || !refusal.empty()) return mesh;
  if (inbox.late()) return Status::cannotDo("Assimp took more than " + std::to_string(limits.seconds) + " s");
  return ending;
}

/// Not a pipe or a device: opening those could wait for ever.
Status checkRegularFile(const std::string& path) {
  struct stat about {};
  if (::stat(path.c_str(), &about) != 0) return Status::cannotDo(path + ": " + std::strerror(errno));
  if (!S_ISREG(about.st_mode)) return Status::cannotDo(path + " is no file");
  if (::access(path.c_str(), R_OK) != 0) return Status::cannotDo(path + ": " + std::strerror(errno));
  return {};
}

/// The file that this code was loaded from: a library, or the program.
fs::path thisFile() {
  Dl_info here{};
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (::dladdr(reinterpret_cast<const void*>(&isMeshFile), &here) == 0) return program;
  const fs::path loaded = fs::canonical(here.dli_fname, error);
  return error ? program : loaded;  // a program's name is as it was called
}

/// lib/voxid/voxid_read_mesh below the nearest folder above this file that has it, built or installed; else empty.
fs::path readerProgram() {
  for (fs::path above = thisFile().parent_path(); above.has_relative_path(); above = above.parent_path()) {
    const fs::path program = above / "lib/voxid/voxid_read_mesh";
    if (::access(program.c_str(), X_OK) == 0) return program;
  }
  return {};
}

Result<pid_t> spawnReader(const std::string& path, const MeshReaderLimits& limits, int pipe) {
  const std::string program = readerProgram().string();
  if (program.empty()) return notStarted("not there; install voxid anew");
  std::string words[] = {program, path, std::to_string(limits.seconds), std::to_string(limits.memory_bytes)};
  char* arguments[] = {words[0].data(), words[1].data(), words[2].data(), words[3].data(), nullptr};
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, pipe, STDOUT_FILENO);
  pid_t child = 0;
  const int error = ::posix_spawn(&child, program.c_str(), &actions, nullptr, arguments, environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return notStarted(std::strerror(error));
  return child;
}

}  // namespace

bool isMeshFile(const std::string& name) {
  constexpr const char* kExtensions[] = {"ply", "obj", "stl", "off", "dae", "gltf", "glb",  "3ds",
                                         "fbx", "x3d", "lwo", "ac",  "ase", "dxf",  "blend"};
  const std::string extension = extensionOf(name);
  return std::find(std::begin(kExtensions), std::end(kExtensions), extension) != std::end(kExtensions);
}

Result<Mesh> readByAssimp(const std::string& path, const MeshReaderLimits& limits) {
  const Status readable = checkRegularFile(path);
  if (!readable.ok()) return readable;
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return notStarted(std::strerror(errno));
  const Result<pid_t> child = spawnReader(path, limits, ends[1]);
  ::close(ends[1]);
  Result<Mesh> mesh = child.ok() ? receiveFrom(child.value, ends[0], limits) : Result<Mesh>(child.status);
  ::close(ends[0]);
  return mesh;
}

Result<Mesh> readMesh(const std::string& path, const MeshReaderLimits& limits) {
  const Status readable = checkRegularFile(path);
  if (!readable.ok()) return readable;
  const bool ply = extensionOf(path) == "ply";
  Result<Mesh> mesh = ply ? readPly(path) : readByAssimp(path, limits);
  const bool foreign_ply = ply && mesh.status.kind == Status::Kind::CannotDo;
  if (foreign_ply) mesh = readByAssimp(path, limits);
  if (!mesh.ok()) return mesh;
  const Status status = keepRenderable(mesh.value);
  if (!status.ok()) return status;
  return mesh;
}

Result<Mesh> readMeshFile(const std::string& path) {
  Result<Mesh> mesh = readMesh(path);
  const bool named = mesh.status.sentence.compare(0, path.size(), path) == 0;
  if (!mesh.ok() && !named) mesh.status.sentence = path + ": " + mesh.status.sentence;
  return mesh;
}

}  // namespace voxid
