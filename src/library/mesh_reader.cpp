// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/mesh_reader.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>

namespace voxid {
namespace {

// What the child process says before the mesh itself follows.
struct Preamble {
  std::uint64_t vertices = 0, triangles = 0;
  char refusal[240] = {};  ///< empty: the mesh follows
};
constexpr std::uint64_t kMaxVertices = std::uint64_t{1} << 27;  ///< some 1.5 GiB; also of triangles

std::string extensionOf(const std::string& path) {
  const std::size_t dot = path.find_last_of("./");
  if (dot == std::string::npos || path[dot] == '/') return {};
  std::string extension = path.substr(dot + 1);
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return extension;
}

// ---- in the child process ----

void refuse(Preamble& preamble, const char* why) {
  std::snprintf(preamble.refusal, sizeof preamble.refusal, "%s", why);
  for (char& c : preamble.refusal) {
    if (c == '\n' || c == '\r') c = ' ';
  }
}

void append(const aiMesh& part, Mesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D& v = part.mVertices[i];
    mesh.vertices.push_back({v.x, v.y, v.z});
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices == 3) mesh.triangles.push_back({first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
  }
}

Mesh import(const std::string& path, Preamble& preamble) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_LINE | aiPrimitiveType_POINT);
  const aiScene* const scene = importer.ReadFile(
      path, aiProcess_Triangulate | aiProcess_JoinIdenticalVertices | aiProcess_PreTransformVertices | aiProcess_SortByPType);
  Mesh mesh;
  if (scene == nullptr) {
    refuse(preamble, importer.GetErrorString());
    return mesh;
  }
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) append(*scene->mMeshes[i], mesh);
  preamble.vertices = mesh.vertices.size();
  preamble.triangles = mesh.triangles.size();
  return mesh;
}

bool writeAll(int pipe, const void* data, std::size_t bytes) {
  const char* at = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t written = ::write(pipe, at, bytes);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    at += written;
    bytes -= static_cast<std::size_t>(written);
  }
  return true;
}

std::uint64_t addressSpaceNow() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void limitProcess(const MeshReaderLimits& limits) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const rlim_t cpu_seconds = static_cast<rlim_t>(limits.seconds) + 1;
  const rlimit cpu{cpu_seconds, cpu_seconds};
  ::setrlimit(RLIMIT_CPU, &cpu);
#ifndef __SANITIZE_ADDRESS__  // its shadow alone is larger than any limit
  const rlim_t bytes = static_cast<rlim_t>(addressSpaceNow() + limits.memory_bytes);
  const rlimit memory{bytes, bytes};
  ::setrlimit(RLIMIT_AS, &memory);
#endif
}

/// Assimp and its importers talk on both, also when they die.
void silence() {
  const int nowhere = ::open("/dev/null", O_WRONLY);
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(nowhere, STDERR_FILENO);
}

[[noreturn]] void runChild(const std::string& path, const MeshReaderLimits& limits, int pipe) {
  limitProcess(limits);
  silence();
  for (const int fatal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGPIPE}) ::signal(fatal, SIG_DFL);
  Preamble preamble;
  Mesh mesh;
  try {
    mesh = import(path, preamble);
  } catch (const std::exception& error) {
    refuse(preamble, error.what());
  }
  const bool sent = writeAll(pipe, &preamble, sizeof preamble) &&
                    writeAll(pipe, mesh.vertices.data(), mesh.vertices.size() * sizeof(Mesh::Vertex)) &&
                    writeAll(pipe, mesh.triangles.data(), mesh.triangles.size() * sizeof(Mesh::Triangle));
  ::_exit(sent ? 0 : 1);
}

// ---- in the calling process ----

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

std::string howItEnded(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status)) return std::string("crashed (") + ::strsignal(WTERMSIG(status)) + ")";
  return "ended without a mesh, out of memory perhaps";
}

Result<Mesh> receive(Inbox& inbox, std::string& refusal) {
  Preamble preamble;
  Mesh mesh;
  if (!inbox.read(&preamble, sizeof preamble)) return Status::cannotDo("no answer");
  preamble.refusal[sizeof preamble.refusal - 1] = '\0';
  refusal = preamble.refusal;
  if (!refusal.empty()) return Status::cannotDo("Assimp: " + refusal);
  if (preamble.vertices > kMaxVertices || preamble.triangles > kMaxVertices) {
    refusal = "too large";
    return Status::cannotDo("more than " + std::to_string(kMaxVertices) + " vertices or triangles");
  }
  const bool whole = inbox.readMany(mesh.vertices, preamble.vertices) && inbox.readMany(mesh.triangles, preamble.triangles);
  if (!whole) return Status::cannotDo("no answer");
  return mesh;
}

Result<Mesh> receiveFrom(pid_t child, int pipe, const MeshReaderLimits& limits) {
  Inbox inbox(pipe, limits.seconds);
  std::string refusal;
  Result<Mesh> mesh = receive(inbox, refusal);
  if (inbox.late() || !refusal.empty()) ::kill(child, SIGKILL);
  const std::string ending = howItEnded(child);
  if (mesh.ok() || !refusal.empty()) return mesh;
  if (inbox.late()) return Status::cannotDo("Assimp took more than " + std::to_string(limits.seconds) + " s");
  return Status::cannotDo("Assimp " + ending);
}

/// Not a pipe or a device: opening those could wait for ever.
Status checkRegularFile(const std::string& path) {
  struct stat about {};
  if (::stat(path.c_str(), &about) != 0) return Status::cannotDo(path + ": " + std::strerror(errno));
  if (!S_ISREG(about.st_mode)) return Status::cannotDo(path + " is no file");
  if (::access(path.c_str(), R_OK) != 0) return Status::cannotDo(path + ": " + std::strerror(errno));
  return {};
}

}  // namespace

bool isMeshFile(const std::string& name) {
  constexpr const char* kExtensions[] = {"ply", "obj", "stl", "off", "dae", "gltf", "glb", "3ds", "fbx", "x3d", "lwo", "ac", "ase", "dxf", "blend"};
  const std::string extension = extensionOf(name);
  return std::find(std::begin(kExtensions), std::end(kExtensions), extension) != std::end(kExtensions);
}

Result<Mesh> readByAssimp(const std::string& path, const MeshReaderLimits& limits) {
  const Status readable = checkRegularFile(path);
  if (!readable.ok()) return readable;
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return Status::cannotDo(std::string("no pipe: ") + std::strerror(errno));
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    runChild(path, limits, ends[1]);
  }
  ::close(ends[1]);
  Result<Mesh> mesh = child > 0 ? receiveFrom(child, ends[0], limits)
                                : Status::cannotDo(std::string("no process for Assimp: ") + std::strerror(errno));
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
