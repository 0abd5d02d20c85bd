// SPDX-License-Identifier: BSD-3-Clause
// Parameters by name, as --set gives them.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "voxid/core/status.h"

namespace voxid::cli {

/// Of a switch true, false, 1 and 0 are values; CLI11 would take any number for one.
template <typename T>
bool readSetting(const std::string& text, T& value) {
  if constexpr (std::is_same_v<T, bool>) {
    value = text == "true" || text == "1";
    return value || text == "false" || text == "0";
  } else {
    return CLI::detail::lexical_cast(text, value);
  }
}

/// Sets a parameter by "name=value". BadUse, with what is possible, for an unknown name or a value out of range.
template <typename Params>
Status applySetting(const std::string& setting, Params& params) {
  const std::size_t equals = setting.find('=');
  const std::string name = setting.substr(0, equals);
  std::string names, range;
  bool known = false, good = false;
  visitParams(params, [&](const char* param, auto& value, auto least, auto most) {
    names += (names.empty() ? "" : ", ") + std::string(param);
    if (name != param) return;
    known = true;
    range = std::to_string(least) + " to " + std::to_string(most);
    auto number = value;
    good = equals != std::string::npos && readSetting(setting.substr(equals + 1), number) && number >= least &&
           number <= most;
    if (good) value = number;
  });
  if (!known) return Status::badUse("--set " + setting + ": no such parameter; there are " + names);
  if (!good) return Status::badUse("--set " + setting + ": expected " + name + "=N with N from " + range);
  return {};
}

template <typename Params>
Status applySettings(const std::vector<std::string>& settings, Params& params) {
  for (const std::string& setting : settings) {
    const Status status = applySetting(setting, params);
    if (!status.ok()) return status;
  }
  return {};
}

}  // namespace voxid::cli
