// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate_segmentation.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>

#include "cpu_time.h"
#include "picture_file.h"
#include "voxid/geometry/segmenter.h"

namespace voxid::cli {
namespace {

using nlohmann::json;

/// Pixels that cluster (by index) and object (by id) share; object 0 is the table and unlabelled pixels.
using Overlap = std::map<std::pair<std::size_t, int>, std::int64_t>;

int objectAt(const cv::Mat& labels, std::uint32_t pixel) {
  return labels.at<std::uint16_t>(static_cast<int>(pixel) / labels.cols, static_cast<int>(pixel) % labels.cols) / 10;
}

Overlap overlapOf(const Scene& scene, const cv::Mat& labels) {
  Overlap overlap;
  for (std::size_t c = 0; c < scene.clusters.size; ++c) {
    for (const std::uint32_t pixel : scene.clusters[c].pixels) ++overlap[{c, objectAt(labels, pixel)}];
  }
  return overlap;
}

std::map<int, std::int64_t> pointsOf(const cv::Mat& labels, const DepthView& depth) {
  std::map<int, std::int64_t> points;
  for (int v = 0; v < labels.rows; ++v) {
    for (int u = 0; u < labels.cols; ++u) {
      const int object = labels.at<std::uint16_t>(v, u) / 10;
      if (object > 0 && depth.depthUm(u, v) > 0) ++points[object];
    }
  }
  return points;
}

std::int64_t sharedBy(const Overlap& overlap, std::size_t cluster, int object) {
  const auto found = overlap.find({cluster, object});
  return found == overlap.end() ? 0 : found->second;
}

struct ObjectResult {
  std::int64_t held = 0, cluster_points = 0, foreign = 0;
  int holders = 0;  ///< clusters with at least 10 % of the object
};

ObjectResult judge(const Scene& scene, const Overlap& overlap, int object, std::int64_t points) {
  ObjectResult result;
  std::size_t best = 0;
  for (std::size_t c = 0; c < scene.clusters.size; ++c) {
    const std::int64_t shared = sharedBy(overlap, c, object);
    result.holders += shared > 0 && shared * 10 >= points;
    if (shared <= result.held) continue;
    result.held = shared;
    best = c;
  }
  if (result.held == 0) return result;
  result.cluster_points = static_cast<std::int64_t>(scene.clusters[best].pixels.size);
  result.foreign = result.cluster_points - result.held - sharedBy(overlap, best, 0);
  return result;
}

bool isRight(const ObjectResult& r, std::int64_t points) {
  return r.held > 0 && r.held * 10 >= points * 9 && r.held * 20 >= r.cluster_points * 19;
}

void count(const json& object, const std::string& name, const ObjectResult& r, std::int64_t points,
           SegmentationScore& score) {
  const bool right = isRight(r, points);
  score.objects += 1;
  score.right += right;
  score.over += r.holders >= 2;
  score.under += r.foreign * 20 > r.cluster_points;
  score.object_points += points;
  score.missed_points += points - r.held;
  score.foreign_points += r.foreign;
  if (object.at("truncated").get<bool>()) return;
  if (!object.at("alone_at_2cm").get<bool>()) {
    score.dense += 1;
    score.dense_right += right;
    return;
  }
  const bool whole = object.at("parts").get<int>() == 1;
  score.alone += 1;
  score.alone_right += right;
  score.whole += whole;
  score.whole_right += whole && right;
  if (!right) score.wrong.push_back(name + " " + std::to_string(object.at("id").get<int>()));
}

std::vector<Eigen::Vector3d> tablePoints(const cv::Mat& labels, const DepthView& depth) {
  std::vector<Eigen::Vector3d> points;
  for (int v = 0; v < labels.rows; ++v) {
    for (int u = 0; u < labels.cols; ++u) {
      const int label = labels.at<std::uint16_t>(v, u);
      const std::int32_t z_um = depth.depthUm(u, v);
      if (label < 1 || label > 9 || z_um == 0) continue;
      const PointUm p = backProject(depth.camera, u, v, z_um);
      points.emplace_back(p.x * 1e-6, p.y * 1e-6, p.z * 1e-6);
    }
  }
  return points;
}

void addPlaneError(const Table& table, const std::vector<Eigen::Vector3d>& points, SegmentationScore& score) {
  if (points.size() < 100) return;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& p : points) scatter += (p - mean) * (p - mean).transpose();
  const Eigen::Vector3d normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
  const Eigen::Vector3d ours = table.normal.cast<double>();
  const double sign = normal.dot(ours) < 0 ? -1 : 1;
  double offset_m = 0;
  for (const auto& p : points) offset_m += std::abs(ours.dot(p) + table.distance_m - sign * normal.dot(p - mean));
  constexpr double kDegrees = 180 / 3.14159265358979323846;
  score.plane_error_mm.push_back(offset_m * 1e3 / static_cast<double>(points.size()));
  score.plane_error_deg.push_back(std::asin(std::min(1.0, normal.cross(ours).norm())) * kDegrees);
}

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double largestOf(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

double rounded(double x) { return std::round(x * 1e4) / 1e4; }

Result<json> readTruth(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file)
    return Status::cannotDo(
        path.string() + ": cannot be read; expected a folder with objects.json, NAME_depth.png and NAME_labels.png");
  json truth = json::parse(file, nullptr, false);
  if (!truth.is_object()) return Status::damaged(path.string() + ": is not a JSON object of scenes");
  if (truth.empty()) return Status::nothingFound(path.string() + ": names no scene");
  return truth;
}

Result<LabelledScene> readScene(const std::filesystem::path& folder, const std::string& name, const json& truth) {
  const Result<DepthFile> depth = readDepthFile((folder / (name + "_depth.png")).string(), CameraChoice{});
  if (!depth.ok()) return depth.status;
  const std::string labels_path = (folder / (name + "_labels.png")).string();
  const cv::Mat labels = readPicture(labels_path);
  if (labels.type() != CV_16UC1 || labels.size() != depth.value.pixels.size()) {
    return Status::cannotDo(labels_path + ": expected a 16-bit image of the depth image's size");
  }
  return LabelledScene{name, depth.value, labels, truth};
}

}  // namespace

double SegmentationScore::fOs() const {
  return object_points == 0 ? 0 : static_cast<double>(missed_points) / static_cast<double>(object_points);
}

double SegmentationScore::fUs() const {
  return object_points == 0 ? 0 : static_cast<double>(foreign_points) / static_cast<double>(object_points);
}

void addScene(const std::string& name, const Scene& scene, const cv::Mat& labels, const DepthView& depth,
              const json& truth, SegmentationScore& score) {
  score.scenes += 1;
  const bool table = scene.status == SceneStatus::Ok || scene.status == SceneStatus::EmptyTable;
  score.tables += table;
  if (table) addPlaneError(scene.table, tablePoints(labels, depth), score);
  const Overlap overlap = overlapOf(scene, labels);
  const std::map<int, std::int64_t> points = pointsOf(labels, depth);
  for (const json& object : truth.at("objects")) {
    if (object.contains("exclude")) continue;
    const int id = object.at("id").get<int>();
    const auto found = points.find(id);
    if (found == points.end()) continue;
    count(object, name, judge(scene, overlap, id, found->second), found->second, score);
  }
  for (std::size_t c = 0; c < scene.clusters.size; ++c) {
    score.table_clusters += sharedBy(overlap, c, 0) * 2 > static_cast<std::int64_t>(scene.clusters[c].pixels.size);
  }
}

Status visitScenes(const std::string& folder, const std::function<void(const LabelledScene&)>& visit) try {
  const Result<json> truth = readTruth(std::filesystem::path(folder) / "objects.json");
  if (!truth.ok()) return truth.status;
  for (const auto& [name, entry] : truth.value.items()) {
    const Result<LabelledScene> scene = readScene(folder, name, entry);
    if (!scene.ok()) return scene.status;
    visit(scene.value);
  }
  return {};
} catch (const json::exception& error) {
  return Status::damaged(folder + "/objects.json: " + error.what());
}

std::vector<double> segmentationUs(const std::vector<DepthView>& scenes, const SegmentParams& params) {
  constexpr int kRounds = 20;
  Segmenter segmenter;
  for (const DepthView& scene : scenes) segmenter.segment(scene, params);
  std::vector<std::vector<double>> us(scenes.size());
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      us[i].push_back(usOf([&] { segmenter.segment(scenes[i], params); }));
    }
  }
  std::vector<double> medians;
  for (const std::vector<double>& scene : us) medians.push_back(medianOf(scene));
  return medians;
}

Result<SegmentationScore> evaluateFolder(const std::string& folder, const SegmentParams& params, bool timing) {
  SegmentationScore score;
  Segmenter segmenter;
  std::vector<DepthFile> timed;
  const Status status = visitScenes(folder, [&](const LabelledScene& scene) {
    const DepthView view = scene.depth.view();
    addScene(scene.name, segmenter.segment(view, params), scene.labels, view, scene.truth, score);
    if (timing) timed.push_back(scene.depth);
  });
  if (!status.ok()) return status;
  std::vector<DepthView> views;
  for (const DepthFile& depth : timed) views.push_back(depth.view());
  for (const double us : segmentationUs(views, params)) score.segment_ms.push_back(us * 1e-3);
  return score;
}

nlohmann::ordered_json toJson(const SegmentationScore& s) {
  nlohmann::ordered_json j;
  j["scenes"] = s.scenes;
  j["tables"] = s.tables;
  j["plane_error_mm_median"] = rounded(medianOf(s.plane_error_mm));
  j["plane_error_mm_worst"] = rounded(largestOf(s.plane_error_mm));
  j["plane_error_deg_median"] = rounded(medianOf(s.plane_error_deg));
  j["plane_error_deg_worst"] = rounded(largestOf(s.plane_error_deg));
  j["alone"] = s.alone;
  j["alone_found"] = s.alone_right;
  j["whole"] = s.whole;
  j["whole_found"] = s.whole_right;
  j["dense"] = s.dense;
  j["dense_found"] = s.dense_right;
  j["objects"] = s.objects;
  j["right"] = s.right;
  j["over"] = s.over;
  j["under"] = s.under;
  j["f_os"] = rounded(s.fOs());
  j["f_us"] = rounded(s.fUs());
  j["table_clusters"] = s.table_clusters;
  if (!s.segment_ms.empty()) {
    j["segment_ms_median"] = rounded(medianOf(s.segment_ms));
    j["segment_ms_worst"] = rounded(largestOf(s.segment_ms));
  }
  j["alone_wrong"] = s.wrong;
  return j;
}

std::string toTable(const SegmentationScore& s) {
  char text[1024];
  std::snprintf(text, sizeof text,
                "tables found                 %d of %d\n"
                "plane error, median (worst)  %.2f mm (%.2f), %.3f deg (%.3f)\n"
                "objects right                %d of %d\n"
                "  standing alone             %d of %d\n"
                "  alone and in one part      %d of %d\n"
                "  touching or stacked        %d of %d\n"
                "cut into several             %d\n"
                "merged with others           %d\n"
                "F_os, F_us                   %.3f, %.3f\n"
                "clusters of bare table       %d\n",
                s.tables, s.scenes, medianOf(s.plane_error_mm), largestOf(s.plane_error_mm),
                medianOf(s.plane_error_deg), largestOf(s.plane_error_deg), s.right, s.objects, s.alone_right, s.alone,
                s.whole_right, s.whole, s.dense_right, s.dense, s.over, s.under, s.fOs(), s.fUs(), s.table_clusters);
  std::string table = text;
  if (!s.segment_ms.empty()) {
    std::snprintf(text, sizeof text, "median (worst) scene         %.2f ms (%.2f)\n", medianOf(s.segment_ms),
                  largestOf(s.segment_ms));
    table += text;
  }
  for (const std::string& object : s.wrong) table += "alone and wrong: " + object + "\n";
  return table;
}

}  // namespace voxid::cli
