// SPDX-License-Identifier: BSD-3-Clause
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <opencv2/core/utils/logger.hpp>
#include <string>
#include <utility>
#include <vector>

#include "command.h"

namespace {

using namespace voxid;
using namespace voxid::cli;

struct SubCommand {
  const char* name;
  const char* about;
  Run (*add)(CLI::App&);
};

constexpr SubCommand kSubCommands[] = {
    {"acquire", "Find models of what a word means, and keep them in a library", addAcquire},
    {"add", "Render models into an index that is there", addAdd},
    {"bench", "Measure descriptors and searches beside other libraries", addBench},
    {"build", "Render models from 80 directions and write an index", addBuild},
    {"capture", "List depth cameras, or record one", addCapture},
    {"classify", "Name the object, or the objects of a scene, in depth images", addClassify},
    {"describe", "Print the descriptor of an object", addDescribe},
    {"eval", "Measure an index on labelled queries", addEval},
    {"info", "Say what an index holds", addInfo},
    {"library", "Say what a library of models holds, and what must be attributed", addLibrary},
    {"merge", "Put indices together", addMerge},
    {"remove", "Take categories or models out of an index", addRemove},
    {"render", "Render a model, or a table with models on it, to depth images", addRender},
    {"segment", "Find the table and what stands on it in depth images", addSegment},
    {"train", "Learn the projection of the default descriptor from models", addTrain},
    {"verify", "Check every byte of an index", addVerify},
};

int fail(const Status& status) {
  std::fflush(stdout);
  std::fprintf(stderr, "voxid: %s\n", oneLine(status.sentence).c_str());
  return static_cast<int>(status.kind);
}

/// What was printed has arrived, or there is a reason; a full disk under `> FILE` shows only now.
Status flushed() {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.flush()) return {};
  return Status::cannotDo(std::string("cannot write to standard output: ") + std::strerror(errno));
}

}  // namespace

int main(int argc, char** argv) try {
  ::signal(SIGXFSZ, SIG_IGN);  // a file size limit is then an error of write(), with a sentence
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // what is wrong is said once, by us
  CLI::App app{"voxid names the things on a table"};
  app.set_version_flag("--version", "voxid " VOXID_VERSION);
  app.require_subcommand(0, 1);  // with 1 as the least, CLI11 does not say which word is none

  std::vector<std::pair<CLI::App*, Run>> commands;
  for (const SubCommand& command : kSubCommands) {
    CLI::App* sub = app.add_subcommand(command.name, command.about);
    commands.emplace_back(sub, command.add(*sub));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // --help, --version
      app.exit(error);
      const Status status = flushed();
      return status.ok() ? 0 : fail(status);
    }
    return fail(Status::badUse(std::string(error.what()) + "; see --help"));
  }
  for (const auto& [sub, run] : commands) {
    if (!sub->parsed()) continue;
    Status status = run();
    if (status.ok()) status = flushed();
    return status.ok() ? 0 : fail(status);
  }
  return fail(Status::badUse("no sub-command given; see --help"));
} catch (const std::exception& error) {
  return fail(voxid::Status::cannotDo(error.what()));
}
