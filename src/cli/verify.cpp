// SPDX-License-Identifier: BSD-3-Clause
// voxid verify: every byte of an index is read and checked.
#include <cstdio>
#include <memory>

#include "command.h"
#include "voxid/core/index.h"

namespace voxid::cli {
namespace {

Status run(const std::string& path) {
  const auto index = Index::open(path);
  if (!index.ok()) return index.status;
  const Status status = index.value->verify();
  if (status.ok()) std::printf("%s: ok\n", path.c_str());
  return status;
}

}  // namespace

Run addVerify(CLI::App& app) {
  const auto path = std::make_shared<std::string>();
  app.add_option("file", *path, "The index (.vxi)")->type_name("FILE")->required();
  return [path] { return run(*path); };
}

}  // namespace voxid::cli
