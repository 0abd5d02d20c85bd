// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_import.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <fstream>

namespace voxid {
namespace {

void refuse(MeshPreamble& preamble, const char* why) {
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
    if (face.mNumIndices == 3)
      mesh.triangles.push_back({first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
  }
}

Mesh import(const std::string& path, MeshPreamble& preamble) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_LINE | aiPrimitiveType_POINT);
  const aiScene* const scene = importer.ReadFile(path, aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                                                           aiProcess_PreTransformVertices | aiProcess_SortByPType);
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

}  // namespace

void importInto(int pipe, const std::string& path, const MeshReaderLimits& limits) {
  limitProcess(limits);
  silence();
  for (const int fatal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGPIPE}) ::signal(fatal, SIG_DFL);
  MeshPreamble preamble;
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

}  // namespace voxid
