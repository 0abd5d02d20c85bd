// SPDX-License-Identifier: BSD-3-Clause
#include "point_file.h"

#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <exception>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "counted.h"

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

/// PCL reserves and clears memory for as many points as the header names, before it looks at the file's length. Even
/// the compressed encoding holds fewer than 8 points a byte.
Status checkPcdCounts(const std::string& path) {
  constexpr double kMostPointsPerByte = 8;
  const double most = kMostPointsPerByte * static_cast<double>(fs::file_size(path));
  std::ifstream file(path, std::ios::binary);
  double width = 1, height = 1;
  std::string word;
  for (std::string line; std::getline(file, line);) {
    std::istringstream fields(line);
    double number = 0;
    fields >> word;
    if (word == "DATA") break;
    if (!(fields >> number)) continue;
    if (word == "WIDTH") width = number;
    if (word == "HEIGHT") height = number;
    const bool counts = word == "WIDTH" || word == "HEIGHT" || word == "POINTS";
    if (counts && (number < 0 || number > most || width * height > most)) {
      return Status::damaged(path + ": damaged PCD, its header speaks of more points than the file can hold");
    }
  }
  return {};
}

/// Says how much is missing, which PCL's readers do not. The 1: an ASCII file's last line may lack its end.
Status checkPcdSize(const std::string& path, const pcl::PCLPointCloud2& header, int data_type, unsigned data_at) {
  constexpr int kAscii = 0, kBinary = 1;
  const std::uintmax_t bytes = fs::file_size(path), points = std::uintmax_t{header.width} * header.height;
  const std::uintmax_t least = data_type == kAscii ? 2 : data_type == kBinary ? header.point_step : 0;
  if (data_at <= bytes && points <= (bytes - data_at + 1) / std::max<std::uintmax_t>(least, 1)) return {};
  if (data_type != kAscii && data_type != kBinary) return {};
  return Status::damaged(path + ": is cut; its header speaks of " + counted(points, "point") + ", more than fit into " +
                         counted(bytes, "byte"));
}

Status checkPcd(const std::string& path) {
  const Status counts = checkPcdCounts(path);
  if (!counts.ok()) return counts;
  pcl::PCDReader reader;
  pcl::PCLPointCloud2 header;
  Eigen::Vector4f origin;
  Eigen::Quaternionf orientation;
  int version = 0, data_type = 0;
  unsigned data_at = 0;
  if (reader.readHeader(path, header, origin, orientation, version, data_type, data_at) < 0 || header.fields.empty()) {
    return Status::damaged(path + ": damaged PCD, its header cannot be read");
  }
  for (const char* name : {"x", "y", "z"}) {
    const auto isNamed = [name](const pcl::PCLPointField& f) { return f.name == name; };
    if (std::none_of(header.fields.begin(), header.fields.end(), isNamed)) {
      return Status::cannotDo(path + ": PCD without field " + name + "; expected x, y and z in metres");
    }
  }
  return checkPcdSize(path, header, data_type, data_at);
}

Result<Points> readPcd(const std::string& path) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  pcl::PointCloud<pcl::PointXYZ> cloud;
  try {
    const Status status = checkPcd(path);
    if (!status.ok()) return status;
    if (pcl::io::loadPCDFile(path, cloud) < 0) return Status::damaged(path + ": damaged PCD, cannot be read");
  } catch (const std::exception&) {
    return Status::damaged(path + ": damaged PCD, cannot be read");
  }
  Points points;
  points.reserve(cloud.size());
  for (const pcl::PointXYZ& p : cloud) append(p.x, p.y, p.z, points);
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
  std::ifstream file(path);
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
