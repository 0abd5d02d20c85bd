// SPDX-License-Identifier: BSD-3-Clause
// voxid acquire, library: written in Python (python/voxid).
#include "command.h"
#include "python.h"

namespace voxid::cli {
namespace {

Run addPython(CLI::App& app, const char* command) {
  app.set_help_flag();   // --help too is Python's to answer
  app.prefix_command();  // and what follows is not for CLI11 to judge
  return [&app, command] { return handOver(command, app.remaining()); };
}

}  // namespace

Run addAcquire(CLI::App& app) { return addPython(app, "acquire"); }

Run addLibrary(CLI::App& app) { return addPython(app, "library"); }

}  // namespace voxid::cli
