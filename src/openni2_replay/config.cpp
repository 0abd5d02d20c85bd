// SPDX-License-Identifier: BSD-3-Clause
#include "config.h"

#include <climits>
#include <cstdlib>
#include <sstream>

namespace voxid::replay {
namespace {

constexpr char kScheme[] = "replay:";
constexpr const char* kOptions[] = {"fps", "hold", "loop", "mirror", "serial", "control", "unit"};

std::string absolute(const std::string& path) {
  char resolved[PATH_MAX];
  return realpath(path.c_str(), resolved) ? resolved : path;
}

std::string lastName(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return path.substr(path.find_last_of('/') + 1);
}

bool parseInt(const std::string& text, int least, int most, int& out) {
  char* end = nullptr;
  const long value = std::strtol(text.c_str(), &end, 10);
  if (text.empty() || *end != '\0' || value < least || value > most) return false;
  out = static_cast<int>(value);
  return true;
}

bool parseBool(const std::string& text, bool& out) {
  int value = 0;
  if (!parseInt(text, 0, 1, value)) return false;
  out = value == 1;
  return true;
}

bool parseCoding(const std::string& text, DepthCoding& out) {
  if (text == "mm")
    out = DepthCoding::Millimetre;
  else if (text == "100um")
    out = DepthCoding::TenthMm;
  else if (text == "shift")
    out = DepthCoding::Shift;
  else
    return false;
  return true;
}

bool setOption(Config& config, const std::string& name, const std::string& value) {
  if (name == "fps") return parseInt(value, 1, 1000, config.fps);
  if (name == "hold") return parseInt(value, 1, 100000, config.hold);
  if (name == "loop") return parseBool(value, config.loop);
  if (name == "mirror") return parseBool(value, config.mirror);
  if (name == "unit") return parseCoding(value, config.coding);
  if (name == "serial") return config.serial = value, !value.empty();
  if (name == "control") return config.control = value, !value.empty();
  return false;
}

std::string refusal(const std::string& where, const std::string& name, const std::string& value) {
  return where + ": '" + name + "=" + value +
         "' is not understood; expected fps=1..1000, hold=1.., loop=0|1, mirror=0|1, unit=mm|100um|shift, serial=NAME, "
         "control=PATH";
}

std::string environmentName(std::string option) {
  for (char& c : option) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return "VOXID_REPLAY_" + option;
}

Config configFor(const std::string& folder) {
  Config config;
  config.folder = absolute(folder);
  config.uri = kScheme + config.folder;
  config.serial = "replay-" + lastName(config.folder);
  return config;
}

Config withEnvironment(Config config, std::vector<std::string>& problems) {
  for (const std::string option : kOptions) {
    const std::string name = environmentName(option);
    const char* value = std::getenv(name.c_str());
    if (value && *value && !setOption(config, option, value)) problems.push_back(refusal("environment", option, value));
  }
  return config;
}

}  // namespace

std::vector<Config> configsFromEnvironment(std::vector<std::string>& problems) {
  std::vector<Config> configs;
  const char* folders = std::getenv("VOXID_REPLAY");
  std::istringstream list(folders ? folders : "");
  for (std::string folder; std::getline(list, folder, ':');)
    if (!folder.empty()) configs.push_back(withEnvironment(configFor(folder), problems));
  if (configs.size() > 1)
    for (Config& config : configs) config.serial = configFor(config.folder).serial;
  return configs;
}

std::optional<Config> configFromUri(const std::string& uri, std::string& problem) {
  if (uri.rfind(kScheme, 0) != 0) return std::nullopt;
  const std::string rest = uri.substr(sizeof kScheme - 1);
  const std::size_t question = rest.find('?');
  Config config = configFor(rest.substr(0, question));
  config.uri = uri;  // OpenNI2 looks the device up under the very text it was asked for
  std::istringstream options(question == std::string::npos ? "" : rest.substr(question + 1));
  for (std::string option; std::getline(options, option, '&');) {
    const std::size_t equals = option.find('=');
    const std::string value = equals == std::string::npos ? "" : option.substr(equals + 1);
    if (!setOption(config, option.substr(0, equals), value))
      return problem = refusal(uri, option.substr(0, equals), value), std::nullopt;
  }
  return config;
}

}  // namespace voxid::replay
