// SPDX-License-Identifier: BSD-3-Clause
// What the sub-commands share: how they are added, how they fail.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <string>

#include "counted.h"
#include "voxid/core/status.h"

namespace voxid::cli {

/// A sub-command's work; its status becomes the exit code, its sentence one line on stderr.
using Run = std::function<Status()>;

/// The text without line ends and what else moves a terminal's cursor: names of files, and messages of other libraries,
/// hold such.
inline std::string oneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return text;
}

/// CLI::Range, which alone lets "nan" pass.
inline CLI::Validator realRange(double least, double most) {
  const CLI::Range range(least, most);
  CLI::Validator check = range;
  check.operation([range](std::string& text) {
    double number = 0;
    const bool unordered = CLI::detail::lexical_cast(text, number) && number != number;
    return unordered ? "Value " + text + " not a number" : range(text);
  });
  return check;
}

/// Each adds its options to `app` and returns what to run once they are parsed.
Run addAcquire(CLI::App& app);
Run addAdd(CLI::App& app);
Run addBench(CLI::App& app);
Run addBuild(CLI::App& app);
Run addCapture(CLI::App& app);
Run addClassify(CLI::App& app);
Run addDescribe(CLI::App& app);
Run addEval(CLI::App& app);
Run addInfo(CLI::App& app);
Run addLibrary(CLI::App& app);
Run addMerge(CLI::App& app);
Run addRemove(CLI::App& app);
Run addRender(CLI::App& app);
Run addSegment(CLI::App& app);
Run addTrain(CLI::App& app);
Run addVerify(CLI::App& app);

}  // namespace voxid::cli
