// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/confirmed_sizes.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>

#include "file_beside.h"

namespace voxid {

Result<ConfirmedSizes> ConfirmedSizes::read(const std::string& path) {
  ConfirmedSizes sizes;
  std::error_code unknown;
  if (!std::filesystem::exists(path, unknown) && !unknown) return sizes;
  try {
    const YAML::Node lines = YAML::LoadFile(path);
    if (lines.IsScalar()) throw YAML::Exception(lines.Mark(), "no categories");
    for (const auto& line : lines) {
      for (const int longest_mm : line.second.as<std::vector<int>>()) {
        if (longest_mm <= 0) throw YAML::Exception(line.second.Mark(), "a length is not positive");
        sizes.add(line.first.as<std::string>(), longest_mm);
      }
    }
  } catch (const YAML::Exception& error) {
    return Status::cannotDo(path + ": no file of confirmed sizes (" + error.what() +
                            "); expected lines such as `mug: [112, 104]`, millimetres");
  }
  return sizes;
}

Status ConfirmedSizes::write(const std::string& path) const {
  YAML::Emitter out;
  out << YAML::BeginMap;
  for (const auto& [category, longest_mm] : longest_mm_)
    out << YAML::Key << category << YAML::Value << YAML::Flow << longest_mm;
  out << YAML::EndMap << YAML::Newline;
  FileBeside file(path);
  file.write(out.c_str(), out.size());
  file.replace();
  return file.ok() ? Status{} : Status::cannotDo(path + ": confirmed sizes cannot be written there");
}

void ConfirmedSizes::add(const std::string& category, int longest_mm) {
  std::vector<int>& of = longest_mm_[category];
  of.push_back(longest_mm);
  if (of.size() > kMostEach) of.erase(of.begin());
}

}  // namespace voxid
