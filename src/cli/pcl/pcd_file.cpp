// SPDX-License-Identifier: BSD-3-Clause
#include "../pcd_file.h"

#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "../counted.h"

namespace voxid::cli {
namespace {

namespace fs = std::filesystem;

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

}  // namespace

Result<std::vector<std::array<float, 3>>> readPcdFile(const std::string& path) try {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  const Status status = checkPcd(path);
  if (!status.ok()) return status;
  pcl::PointCloud<pcl::PointXYZ> cloud;
  if (pcl::io::loadPCDFile(path, cloud) < 0) return Status::damaged(path + ": damaged PCD, cannot be read");
  std::vector<std::array<float, 3>> points;
  points.reserve(cloud.size());
  for (const pcl::PointXYZ& p : cloud) points.push_back({p.x, p.y, p.z});
  return points;
} catch (const std::exception&) {
  return Status::damaged(path + ": damaged PCD, cannot be read");
}

}  // namespace voxid::cli
