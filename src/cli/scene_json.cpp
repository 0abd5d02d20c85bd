// SPDX-License-Identifier: BSD-3-Clause
#include "scene_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "free_place.h"
#include "picture_file.h"
#include "written_files.h"

namespace voxid::cli {
namespace {

namespace fs = std::filesystem;

/// Floats as people read them: a tenth of a millimetre in metres, the same digits on every machine.
double rounded(float x) { return std::round(static_cast<double>(x) * 1e4) / 1e4; }
double roundedUnit(float x) { return std::round(static_cast<double>(x) * 1e6) / 1e6; }

Json jsonOf(const Eigen::Vector3f& p) { return Json::array({rounded(p.x()), rounded(p.y()), rounded(p.z())}); }

bool hasTable(const Scene& scene) { return scene.table.distance_m > 0; }

/// Inverse depth between the image's nearest and farthest, as noise and detail go with it.
cv::Mat greyOf(const DepthView& depth) {
  cv::Mat inverse(depth.height_px, depth.width_px, CV_32F);
  float nearest = 0, farthest = 1e9f;
  for (int v = 0; v < depth.height_px; ++v) {
    for (int u = 0; u < depth.width_px; ++u) {
      const std::int32_t depth_um = depth.depthUm(u, v);
      const float value = depth_um > 0 ? 1e6f / static_cast<float>(depth_um) : 0;
      inverse.at<float>(v, u) = value;
      if (depth_um <= 0) continue;
      nearest = std::max(nearest, value);
      farthest = std::min(farthest, value);
    }
  }
  constexpr double kDarkest = 40, kBrightest = 220;
  const double scale = (kBrightest - kDarkest) / std::max(1e-6f, nearest - farthest);
  cv::Mat grey, bgr;
  inverse.convertTo(grey, CV_8U, scale, kDarkest - scale * static_cast<double>(farthest));
  grey.setTo(0, inverse == 0);
  cv::cvtColor(grey, bgr, cv::COLOR_GRAY2BGR);
  return bgr;
}

cv::Point pixelOf(const Camera& camera, const Eigen::Vector3f& p) {
  constexpr double kPixel = 1.0 / 65536;
  const double z = std::max(0.01f, p.z());
  return {static_cast<int>(std::lround((camera.fx_q16 * (p.x() / z) + camera.cx_q16) * kPixel)),
          static_cast<int>(std::lround((camera.fy_q16 * (p.y() / z) + camera.cy_q16) * kPixel))};
}

void drawOutline(const Camera& camera, const Table& table, cv::Mat& picture) {
  std::vector<cv::Point> corners;
  for (const Eigen::Vector3f& p : table.outline_m) corners.push_back(pixelOf(camera, p));
  cv::polylines(picture, corners, true, {255, 255, 255}, 1, cv::LINE_AA);
}

void tint(const Cluster& cluster, cv::Mat& picture) {
  const cv::Scalar colour = colourOf(cluster.id);
  for (const std::uint32_t pixel : cluster.pixels) {
    auto& p = picture.at<cv::Vec3b>(static_cast<int>(pixel) / picture.cols, static_cast<int>(pixel) % picture.cols);
    for (int i = 0; i < 3; ++i) p[i] = static_cast<unsigned char>((p[i] + static_cast<int>(colour[i])) / 2);
  }
}

/// The twelve edges of the oriented box.
void drawBox(const Camera& camera, const Cluster& cluster, cv::Mat& picture) {
  std::array<cv::Point, 8> corners;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3f half((i & 1 ? 0.5f : -0.5f) * cluster.extents_m.x(),
                               (i & 2 ? 0.5f : -0.5f) * cluster.extents_m.y(),
                               (i & 4 ? 0.5f : -0.5f) * cluster.extents_m.z());
    corners[static_cast<std::size_t>(i)] = pixelOf(camera, cluster.box_centre_m + cluster.axes * half);
  }
  for (int i = 0; i < 8; ++i) {
    for (const int axis : {1, 2, 4}) {
      if (i & axis) continue;
      cv::line(picture, corners[static_cast<std::size_t>(i)], corners[static_cast<std::size_t>(i | axis)],
               colourOf(cluster.id), 1, cv::LINE_AA);
    }
  }
}

/// Above the object or, where another caption is, near to that; `taken`: the places of captions.
void writeCaption(const Cluster& cluster, const std::string& caption, std::vector<cv::Rect>& taken, cv::Mat& picture) {
  constexpr double kSize = 0.45;
  int below = 0;
  const cv::Size size = cv::getTextSize(caption, cv::FONT_HERSHEY_SIMPLEX, kSize, 1, &below);
  const int x = std::clamp(cluster.box_px.x, 0, std::max(0, picture.cols - size.width));
  const int y = std::max(cluster.box_px.y - 4, size.height + 2);
  const cv::Rect wanted({x - 1, y - size.height - 2}, cv::Point(x + size.width + 2, y + below));
  taken.push_back(freePlace(wanted, taken, picture.rows));
  cv::rectangle(picture, taken.back(), {0, 0, 0}, cv::FILLED);
  cv::putText(picture, caption, {x, taken.back().y + size.height + 2}, cv::FONT_HERSHEY_SIMPLEX, kSize,
              colourOf(cluster.id), 1, cv::LINE_AA);
}

/// Its pixel box and why it is no object.
void drawLeftOut(const LeftOut& cluster, cv::Mat& picture) {
  const cv::Scalar grey = cv::Scalar::all(190);
  const PixelBox& box = cluster.box_px;
  cv::rectangle(picture, cv::Rect(box.x, box.y, box.width, box.height), grey);
  constexpr std::uint32_t kWorthWords = 30;  // pixels; crumbs would hide the picture behind their captions
  if (cluster.pixels < kWorthWords) return;
  std::string reason = nameOf(cluster.reason);
  std::replace(reason.begin(), reason.end(), '_', ' ');
  cv::putText(picture, reason, {box.x, std::max(box.y - 3, 10)}, cv::FONT_HERSHEY_SIMPLEX, 0.35, grey, 1, cv::LINE_AA);
}

}  // namespace

cv::Scalar colourOf(int id) {
  constexpr std::array<std::array<int, 3>, 8> kBgr = {{{60, 60, 230},
                                                       {70, 190, 70},
                                                       {230, 120, 40},
                                                       {40, 200, 230},
                                                       {210, 70, 190},
                                                       {220, 200, 50},
                                                       {50, 130, 250},
                                                       {180, 110, 110}}};
  const auto& c = kBgr[static_cast<std::size_t>(std::max(id, 1) - 1) % kBgr.size()];
  return {static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])};
}

Json toJson(const Table& table) {
  Json j;
  j["normal"] =
      Json::array({roundedUnit(table.normal.x()), roundedUnit(table.normal.y()), roundedUnit(table.normal.z())});
  j["distance_m"] = rounded(table.distance_m);
  j["outline"] = Json::array();
  for (const Eigen::Vector3f& p : table.outline_m) j["outline"].push_back(jsonOf(p));
  j["residual_mm"] = std::round(static_cast<double>(table.residual_mm) * 1e3) / 1e3;
  j["inliers"] = table.inliers;
  return j;
}

Json toJson(const Cluster& cluster) {
  const PixelBox& box = cluster.box_px;
  Json j;
  j["id"] = cluster.id;
  j["pixels"] = cluster.pixels.size;
  j["box_px"] = Json::array({box.x, box.y, box.width, box.height});
  j["centroid_m"] = jsonOf(cluster.centroid_m);
  j["extents_m"] = jsonOf(cluster.extents_m);
  j["truncated"] = cluster.truncated;
  return j;
}

Json toJson(const std::string& file, const Scene& scene) {
  Json j;
  j["file"] = file;
  j["status"] = nameOf(scene.status);
  j["table"] = hasTable(scene) ? toJson(scene.table) : Json(nullptr);
  j["objects"] = Json::array();
  for (const Cluster& cluster : scene.clusters) j["objects"].push_back(toJson(cluster));
  j["dropped"] = Json::object();
  for (int i = 0; i < static_cast<int>(DropReason::kCount); ++i) {
    j["dropped"][nameOf(static_cast<DropReason>(i))] = scene.dropped[static_cast<std::size_t>(i)];
  }
  return j;
}

cv::Mat labelImage(const Scene& scene, int width_px, int height_px) {
  cv::Mat labels = cv::Mat::zeros(height_px, width_px, CV_16UC1);
  auto* out = labels.ptr<std::uint16_t>();
  for (const Cluster& cluster : scene.clusters) {
    for (const std::uint32_t pixel : cluster.pixels) out[pixel] = static_cast<std::uint16_t>(cluster.id);
  }
  return labels;
}

Status writeLabels(const std::string& folder, const std::string& input, const cv::Mat& labels) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder)) return Status::cannotDo(folder + ": cannot be made; --labels expects a folder");
  return writeImage(labelsPath(folder, input), labels);
}

cv::Mat drawScene(const DepthView& depth, const Scene& scene) {
  cv::Mat picture = greyOf(depth);
  if (hasTable(scene)) drawOutline(depth.camera, scene.table, picture);
  for (const LeftOut& cluster : scene.left_out) drawLeftOut(cluster, picture);
  for (const Cluster& cluster : scene.clusters) {
    tint(cluster, picture);
    drawBox(depth.camera, cluster, picture);
  }
  return picture;
}

void writeCaptions(const Scene& scene, const std::vector<std::string>& captions, cv::Mat& picture) {
  std::vector<cv::Rect> taken;
  for (std::size_t i = 0; i < scene.clusters.size; ++i) {
    const Cluster& cluster = scene.clusters[i];
    writeCaption(cluster, i < captions.size() ? captions[i] : std::to_string(cluster.id), taken, picture);
  }
}

std::string plotPath(const std::string& path, const std::string& input, bool single) {
  if (single) return path;
  const fs::path p(path);
  return (p.parent_path() / (p.stem().string() + "-" + fs::path(input).stem().string() + p.extension().string()))
      .string();
}

Status writeImage(const std::string& path, const cv::Mat& image) {
  if (writePicture(path, image)) return {};
  return Status::cannotDo(path +
                          ": the image cannot be written; expected an existing folder and an ending such as .png");
}

const char* sentenceOf(SceneStatus status) {
  switch (status) {
    case SceneStatus::Ok:
      return "objects were found";
    case SceneStatus::NoDepth:
      return "no pixel inside the depth range; see --set min_depth_mm and max_depth_mm";
    case SceneStatus::NoTable:
      return "no plane with enough pixels that could be a table; see --set min_table_pixels and max_tilt_deg";
    case SceneStatus::EmptyTable:
      return "nothing stands on the table";
    case SceneStatus::NoTransform:
      return "no transform to the target frame";
    case SceneStatus::NoIndex:
      return "no index to compare with";
    case SceneStatus::BadInput:
      return "the image and its camera do not go together, or the image is larger than 8192 pixels a side";
  }
  return "unknown";
}

Status statusOf(const std::vector<SceneStatus>& frames, const std::string& first_file) {
  const bool found =
      frames.empty() || std::any_of(frames.begin(), frames.end(), [](SceneStatus s) { return s == SceneStatus::Ok; });
  if (found) return {};
  const std::string where =
      frames.size() == 1 ? first_file : "all " + std::to_string(frames.size()) + " frames, first " + first_file;
  const std::string sentence = where + ": " + sentenceOf(frames.front()) + " (" + nameOf(frames.front()) + ")";
  return frames.front() == SceneStatus::BadInput ? Status::cannotDo(sentence) : Status::nothingFound(sentence);
}

}  // namespace voxid::cli
