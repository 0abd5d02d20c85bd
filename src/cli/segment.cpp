// SPDX-License-Identifier: BSD-3-Clause
// voxid segment: the table and what stands on it.
#include "voxid/geometry/segmenter.h"

#include <chrono>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>

#include "command.h"
#include "depth_file.h"
#include "evaluate_segmentation.h"
#include "recogniser.h"
#include "scene_json.h"
#include "segment_choice.h"
#include "written_files.h"

namespace voxid::cli {
namespace {

struct Options {
  std::vector<std::string> files;
  CameraChoice camera;
  SegmentChoice segment;
  std::string labels, plot, evaluate;
  bool json = false, timing = false;
};

void printForPeople(const std::string& file, const Scene& scene) {
  std::printf("%s: %s, %s\n", file.c_str(), nameOf(scene.status), sentenceOf(scene.status));
  if (scene.table.distance_m > 0) {
    std::printf("  table   %.3f m below the camera, %u pixels, residual %.2f mm\n",
                static_cast<double>(scene.table.distance_m), scene.table.inliers,
                static_cast<double>(scene.table.residual_mm));
  }
  for (const Cluster& c : scene.clusters) {
    std::printf("  object %-3d %6zu pixels at %.3f %.3f %.3f m, %.0f x %.0f x %.0f mm%s\n", c.id, c.pixels.size,
                static_cast<double>(c.centroid_m.x()), static_cast<double>(c.centroid_m.y()),
                static_cast<double>(c.centroid_m.z()), static_cast<double>(c.extents_m.x()) * 1e3,
                static_cast<double>(c.extents_m.y()) * 1e3, static_cast<double>(c.extents_m.z()) * 1e3,
                c.truncated ? ", truncated" : "");
  }
}

void print(const Options& options, const std::string& file, const Scene& scene, double segment_ms) {
  if (!options.json) {
    printForPeople(file, scene);
    if (options.timing) std::printf("  segment_ms %.2f\n", segment_ms);
    return;
  }
  Json j = toJson(file, scene);
  if (options.timing) j["segment_ms"] = segment_ms;
  std::cout << lineOf(j);
}

Status writePictures(const Options& options, const DepthFile& file, const Scene& scene) {
  if (!options.labels.empty()) {
    const Status status = writeLabels(options.labels, file.path, labelImage(scene, file.pixels.cols, file.pixels.rows));
    if (!status.ok()) return status;
  }
  if (options.plot.empty()) return {};
  cv::Mat picture = drawScene(file.view(), scene);
  writeCaptions(scene, {}, picture);
  return writeImage(plotPath(options.plot, file.path, options.files.size() == 1), picture);
}

Result<SceneStatus> segmentFile(const Options& options, const std::string& path, const SegmentParams& params,
                                const std::optional<Eigen::Vector3f>& up, Segmenter& segmenter) {
  const Result<DepthFile> file = readDepthFile(path, options.camera);
  if (!file.ok()) return file.status;
  const auto start = std::chrono::steady_clock::now();
  const Scene& scene = segmenter.segment(file.value.view(), params, up);
  const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
  print(options, path, scene, time.count());
  const Status written = writePictures(options, file.value, scene);
  if (!written.ok()) return written;
  return scene.status;
}

Status segmentFiles(const Options& options, const SegmentParams& params) {
  const auto up = options.segment.up();
  if (!up.ok()) return up.status;
  if (const Status free = checkWritten(options.files, options.labels, options.plot); !free.ok()) return free;
  Segmenter segmenter;
  std::vector<SceneStatus> statuses;
  for (const std::string& path : options.files) {
    const Result<SceneStatus> status = segmentFile(options, path, params, up.value, segmenter);
    if (!status.ok()) return status.status;
    statuses.push_back(status.value);
  }
  std::cout.flush();
  return statusOf(statuses, options.files.front());
}

Status evaluate(const Options& options, const SegmentParams& params) {
  const Result<SegmentationScore> score = evaluateFolder(options.evaluate, params, options.timing);
  if (!score.ok()) return score.status;
  std::cout << (options.json ? lineOf(toJson(score.value)) : toTable(score.value));
  return {};
}

Status run(const Options& options) {
  const auto params = options.segment.params();
  if (!params.ok()) return params.status;
  if (!options.evaluate.empty()) return evaluate(options, params.value);
  if (options.files.empty())
    return Status::badUse("segment: no depth image given; expected FILES or --evaluate DIR, see --help");
  return segmentFiles(options, params.value);
}

}  // namespace

Run addSegment(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("files", options->files, "Depth images")->type_name("FILES");
  options->camera.addTo(app);
  options->segment.addTo(app, "");
  app.add_flag("--json", options->json, "One object a frame and line");
  app.add_flag("--timing", options->timing, "Add segment_ms; with --evaluate the processor time of 20 runs a scene");
  app.add_option("--labels", options->labels,
                 "Write each frame's objects to DIR/STEM.png: 16 bit, object id a pixel, 0 none")
      ->type_name("DIR");
  app.add_option("--plot", options->plot, "Draw table and objects; with several frames to PATH-STEM.png")
      ->type_name("PATH.png");
  app.add_option("--evaluate", options->evaluate,
                 "Compare with the labels of DIR (objects.json, NAME_depth.png, NAME_labels.png)")
      ->type_name("DIR")
      ->excludes("--up", "--camera", "--labels", "--plot");
  return [options] { return run(*options); };
}

}  // namespace voxid::cli
