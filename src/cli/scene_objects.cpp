// SPDX-License-Identifier: BSD-3-Clause
#include "scene_objects.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "aliases_json.h"
#include "picture_file.h"
#include "voxid/geometry/segmenter.h"

namespace voxid::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Result<json> readJson(const fs::path& path) {
  std::ifstream file(path);
  if (!file) return Status::cannotDo(path.string() + ": cannot be read");
  json parsed = json::parse(file, nullptr, false);
  if (!parsed.is_object()) return Status::damaged(path.string() + ": is not a JSON object");
  return parsed;
}

bool isTaught(const Index& index, const std::string& category) {
  return std::any_of(index.categories().begin(), index.categories().end(),
                     [&](const format::Category& c) { return index.string(c.name) == category; });
}

/// The names of a category that the index knows.
std::vector<std::string> rightNames(const Index& index, const Aliases& aliases, const std::string& category) {
  const auto found = aliases.find(category);
  const std::vector<std::string> names = found == aliases.end() ? std::vector<std::string>{category} : found->second;
  std::vector<std::string> taught;
  std::copy_if(names.begin(), names.end(), std::back_inserter(taught),
               [&](const std::string& name) { return isTaught(index, name); });
  return taught;
}

std::vector<std::uint32_t> labelledPixels(const cv::Mat& labels, const DepthView& depth, int id) {
  std::vector<std::uint32_t> pixels;
  for (int v = 0; v < labels.rows; ++v) {
    for (int u = 0; u < labels.cols; ++u) {
      if (labels.at<std::uint16_t>(v, u) / 10 == id && depth.depthUm(u, v) > 0) {
        pixels.push_back(static_cast<std::uint32_t>(v * labels.cols + u));
      }
    }
  }
  return pixels;
}

/// Both ascend.
std::size_t shared(const std::vector<std::uint32_t>& a, Span<const std::uint32_t> b) {
  std::vector<std::uint32_t> both;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both.size();
}

std::vector<std::uint32_t> clusterOf(const Scene& scene, const std::vector<std::uint32_t>& pixels) {
  for (const Cluster& cluster : scene.clusters) {
    const std::size_t both = shared(pixels, cluster.pixels);
    if (2 * both >= pixels.size() && 2 * both >= cluster.pixels.size)
      return {cluster.pixels.begin(), cluster.pixels.end()};
  }
  return {};
}

bool isAloneAndWhole(const json& object) {
  return object.value("alone_at_2cm", false) && !object.value("truncated", true) && !object.contains("exclude");
}

/// Adds the objects of one scene after the other.
class Reader {
 public:
  Reader(const fs::path& folder, const Index& index, const Aliases& aliases)
      : folder_(folder), index_(index), aliases_(aliases) {}

  Status add(const std::string& name, const json& scene) {
    auto depth = readDepthFile((folder_ / (name + "_depth.png")).string(), CameraChoice{});
    if (!depth.ok()) return depth.status;
    const std::string labels_path = (folder_ / (name + "_labels.png")).string();
    const cv::Mat labels = readPicture(labels_path);
    if (labels.type() != CV_16UC1 || labels.size() != depth.value.pixels.size()) {
      return Status::cannotDo(labels_path + ": expected a 16-bit image of the depth image's size");
    }
    const auto shared_depth = std::make_shared<const DepthFile>(std::move(depth.value));
    const Scene& own = segmenter_.segment(shared_depth->view(), SegmentParams{});
    ++read_.scenes;
    for (const json& object : scene.at("objects")) {
      if (isAloneAndWhole(object)) addObject(name, object, shared_depth, labels, own);
    }
    return {};
  }

  SceneObjects take() { return std::move(read_); }

 private:
  void addObject(const std::string& scene, const json& truth, const std::shared_ptr<const DepthFile>& depth,
                 const cv::Mat& labels, const Scene& own) {
    const auto category = truth.at("category").get<std::string>();
    const int id = truth.at("id").get<int>();
    SceneObject object{scene + " " + std::to_string(id), depth, rightNames(index_, aliases_, category), {}, {}};
    if (object.right.empty()) {
      ++read_.left_out[category];
      return;
    }
    object.true_pixels = labelledPixels(labels, depth->view(), id);
    object.own_pixels = clusterOf(own, object.true_pixels);
    read_.objects.push_back(std::move(object));
  }

  fs::path folder_;
  const Index& index_;
  const Aliases& aliases_;
  Segmenter segmenter_;
  SceneObjects read_;
};

}  // namespace

Result<SceneObjects> readSceneObjects(const std::string& folder, const Index& index, const Aliases& aliases) {
  const fs::path path = fs::path(folder) / "objects.json";
  const Result<json> truth = readJson(path);
  if (!truth.ok()) return truth.status;
  Reader reader(folder, index, aliases);
  try {
    for (const auto& [name, scene] : truth.value.items()) {
      const Status status = reader.add(name, scene);
      if (!status.ok()) return status;
    }
  } catch (const json::exception& error) {
    return Status::damaged(path.string() + ": " + error.what());
  }
  SceneObjects read = reader.take();
  if (read.objects.empty())
    return Status::nothingFound(path.string() +
                                ": no object in it that stands alone and that the index has a category for");
  return read;
}

Result<Aliases> readAliases(const std::string& path) {
  const Result<json> table = path.empty() ? Result<json>(json::parse(kAliasesJson)) : readJson(path);
  if (!table.ok()) return table.status;
  try {
    return table.value.get<Aliases>();
  } catch (const json::exception&) {
    return Status::damaged(path + ": expected a JSON object of lists of category names");
  }
}

}  // namespace voxid::cli
