// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/allowed_categories.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>

#include "sizes_yaml.h"
#include "voxid/library/text_file.h"

namespace voxid {
namespace {

constexpr double kMmPerCm = 10;

bool anyOf(const AllowedCategories& allowed) { return std::find(allowed.begin(), allowed.end(), 1) != allowed.end(); }

}  // namespace

Result<AllowedCategories> readAllowedCategories(const std::string& path, const Index& index) {
  std::ifstream file = openText(path);
  if (!file) return Status::cannotDo(path + ": cannot be read; expected a file of category names, one a line");
  AllowedCategories allowed(index.categories().size);
  for (std::string line; std::getline(file, line);) {
    const std::size_t end = line.find_last_not_of(" \t\r");
    line.resize(end == std::string::npos ? 0 : end + 1);
    for (std::uint32_t i = 0; i < allowed.size(); ++i) {
      if (index.categoryName(i) == line) allowed[i] = 1;
    }
  }
  if (!anyOf(allowed))
    return Status::cannotDo(path + ": none of its categories is in the index; expected names, one a line");
  return allowed;
}

SizeTable::SizeTable(const Index& index, const ConfirmedSizes& confirmed) : ranges_(index.categories().size) {
  review(index);
  for (const auto& [category, longest_mm] : confirmed.longest_mm()) {
    Range* const range = rangeOf(index, category);
    if (range && !longest_mm.empty()) refine(longest_mm, range);
  }
}

SizeTable::Range* SizeTable::rangeOf(const Index& index, const std::string& category) {
  for (std::uint32_t i = 0; i < ranges_.size(); ++i) {
    if (index.categoryName(i) == category) return &ranges_[i];
  }
  return nullptr;
}

void SizeTable::review(const Index& index) {
  const YAML::Node table = YAML::Load(kSizesYaml);
  for (const auto& entry : table["range_cm"]) {
    if (Range* const range = rangeOf(index, entry.first.as<std::string>()))
      *range = {entry.second[0].as<double>() * kMmPerCm, entry.second[1].as<double>() * kMmPerCm};
  }
  for (const auto& name : table["large"]) {
    if (Range* const range = rangeOf(index, name.as<std::string>()))
      range->least_mm = table["large_cm"].as<double>() * kMmPerCm;
  }
}

void SizeTable::refine(const std::vector<int>& confirmed_mm, Range* range) const {
  const auto [least, most] = std::minmax_element(confirmed_mm.begin(), confirmed_mm.end());
  const Range seen{*least * (1 - kMargin), *most * (1 + kMargin)};
  if (confirmed_mm.size() >= kEnough)
    *range = seen;
  else
    *range = {std::min(range->least_mm, seen.least_mm), std::max(range->most_mm, seen.most_mm)};
}

void SizeTable::find(double longest_mm, const AllowedCategories& among, AllowedCategories* fit) const {
  fit->resize(ranges_.size());
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    const bool listed = among.empty() || among[i] != 0;
    (*fit)[i] = listed && longest_mm >= ranges_[i].least_mm && longest_mm <= ranges_[i].most_mm;
  }
  if (!anyOf(*fit)) fit->assign(among.begin(), among.end());
}

}  // namespace voxid
