// SPDX-License-Identifier: BSD-3-Clause
#include "point_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "pcd_file.h"
#include "voxid/library/text_file.h"

namespace voxid::cli {
namespace {

namespace fs = std::filesystem;
using Points = std::vector<PointUm>;

std::string endingOf(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

void append(double x_m, double y_m, double z_m, Points& points) {
  constexpr double kFarthest_m = 2147;  // as micrometres still an int32
  for (const double c : {x_m, y_m, z_m}) {
    if (!(std::abs(c) <= kFarthest_m)) return;
  }
  const auto um = [](double m) { return static_cast<std::int32_t>(std::lround(m * 1e6)); };
  points.push_back({um(x_m), um(y_m), um(z_m)});
}

Result<Points> readPcd(const std::string& path) {
  const auto read = readPcdFile(path);
  if (!read.ok()) return read.status;
  Points points;
  points.reserve(read.value.size());
  for (const auto& [x_m, y_m, z_m] : read.value) append(x_m, y_m, z_m, points);
  return points;
}

/// Streams do not read "nan"; strtod does.
bool parseLine(const std::string& line, double (&xyz)[3]) {
  const char* at = line.c_str();
  for (double& c : xyz) {
    char* end = nullptr;
    c = std::strtod(at, &end);
    if (end == at) return false;
    at = end;
  }
  return true;
}

Result<Points> readXyz(const std::string& path) {
  std::ifstream file = openText(path);
  if (!file) return Status::cannotDo(path + ": cannot be opened for reading");
  Points points;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    double xyz[3];
    if (!parseLine(line, xyz)) {
      return Status::damaged(path + ": line " + std::to_string(number) + " is no point; expected x y z in metres");
    }
    append(xyz[0], xyz[1], xyz[2], points);
  }
  return points;
}

}  // namespace

bool isPointFile(const std::string& path) { return endingOf(path) == ".pcd" || endingOf(path) == ".xyz"; }

Result<Points> readPointFile(const std::string& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return Status::cannotDo(path + ": no such file");
  if (!fs::is_regular_file(path, error))
    return Status::cannotDo(path + ": is not a file; expected points (.pcd, .xyz)");
  const bool is_pcd = endingOf(path) == ".pcd";
  if (is_pcd && fs::file_size(path, error) == 0) return Status::damaged(path + ": is empty; expected a PCD file");
  return is_pcd ? readPcd(path) : readXyz(path);
}

}  // namespace voxid::cli
