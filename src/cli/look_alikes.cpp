// SPDX-License-Identifier: BSD-3-Clause
#include "look_alikes.h"

#include <yaml-cpp/yaml.h>

#include "look_alikes_yaml.h"

namespace voxid::cli {

namespace {

constexpr char kExpected[] = ": expected groups, each a map of categories to why they are in it";

Result<LookAlikes> groupsIn(const YAML::Node& groups, const std::string& name) {
  LookAlikes group_of;
  if (!groups.IsMap()) return Status::damaged(name + kExpected);
  for (const auto& group : groups) {
    if (!group.second.IsMap()) return Status::damaged(name + kExpected);
    for (const auto& member : group.second) {
      const auto category = member.first.as<std::string>();
      if (!group_of.emplace(category, group.first.as<std::string>()).second)
        return Status::damaged(name + ": " + category + " is in two groups");
    }
  }
  return group_of;
}

}  // namespace

Result<LookAlikes> readLookAlikes(const std::string& path) {
  const std::string name = path.empty() ? "cfg/look_alikes.yaml" : path;
  try {
    return groupsIn((path.empty() ? YAML::Load(kLookAlikesYaml) : YAML::LoadFile(path))["groups"], name);
  } catch (const YAML::BadFile&) {
    return Status::cannotDo(name + ": cannot be read");
  } catch (const YAML::Exception&) {
    return Status::damaged(name + kExpected);
  }
}

SynsetPaths synsetPathsOf(const Index& index) {
  SynsetPaths paths;
  for (std::uint32_t i = 0; i < index.categories().size; ++i) {
    const std::string_view path = index.hypernymsOf(i);
    if (!path.empty()) paths[std::string(index.categoryName(i))] = "/" + std::string(path) + "/";
  }
  return paths;
}

bool sameOrAbove(const SynsetPaths& paths, const std::string& a, const std::string& b) {
  if (a == b) return true;
  const auto first = paths.find(a), second = paths.find(b);
  if (first == paths.end() || second == paths.end()) return false;
  return first->second.rfind(second->second, 0) == 0 || second->second.rfind(first->second, 0) == 0;
}

}  // namespace voxid::cli
