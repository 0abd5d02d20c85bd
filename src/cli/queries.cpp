// SPDX-License-Identifier: BSD-3-Clause
#include "queries.h"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "counted.h"
#include "voxid/library/text_file.h"

namespace voxid::cli {
namespace {

namespace fs = std::filesystem;
using Fields = std::vector<std::string>;

Fields split(std::string line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  Fields fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

/// Where the columns stand.
struct Columns {
  std::size_t file, category, model;

  std::size_t last() const { return std::max({file, category, model}); }
};

Result<Columns> columnsOf(const std::string& path, const Fields& header) {
  std::size_t at[3];
  const char* const names[3] = {"file", "category", "model"};
  for (int i = 0; i < 3; ++i) {
    at[i] = static_cast<std::size_t>(std::find(header.begin(), header.end(), names[i]) - header.begin());
    if (at[i] == header.size()) {
      return Status::cannotDo(path + ": no column " + names[i] + " in its first line; expected file,category,model");
    }
  }
  return Columns{at[0], at[1], at[2]};
}

}  // namespace

Result<std::vector<Query>> readQueries(const std::string& folder, int every) {
  const fs::path path = fs::path(folder) / "queries.csv";
  std::ifstream file = openText(path.string());
  if (!file)
    return Status::cannotDo(path.string() +
                            ": cannot be read; --queries expects a folder with queries.csv and its images");
  std::string line;
  if (!std::getline(file, line))
    return Status::damaged(path.string() + ": is empty; expected a line file,category,model and one for each image");
  const Result<Columns> columns = columnsOf(path.string(), split(line));
  if (!columns.ok()) return columns.status;
  std::vector<Query> queries;
  for (int number = 0; std::getline(file, line); ++number) {
    if (number % every != 0) continue;
    const Fields fields = split(line);
    if (fields.size() <= columns.value.last()) {
      return Status::cannotDo(path.string() + ": line " + std::to_string(number + 2) + " has " +
                              counted(fields.size(), "field") + "; expected file, category and model");
    }
    queries.push_back({(fs::path(folder) / fields[columns.value.file]).string(), fields[columns.value.category],
                       fields[columns.value.model]});
  }
  if (queries.empty()) return Status::nothingFound(path.string() + ": no query in it");
  return queries;
}

CameraChoice cameraOfFolder(const std::string& folder) {
  const fs::path info = fs::path(folder) / "camera_info.yaml";
  std::error_code error;
  return {fs::exists(info, error) ? info.string() : std::string()};
}

}  // namespace voxid::cli
