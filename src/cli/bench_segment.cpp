// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "bench.h"
#include "evaluate_segmentation.h"
#include "pcl_segmentation.h"
#include "voxid/geometry/segmenter.h"

namespace voxid::cli {
namespace {

constexpr int kVoxel_mm = 5;

/// Times by scene, and how many of the labelled objects came out right.
struct Measured {
  std::vector<double> us;
  SegmentationScore score;
};

SegmentParams planeAndComponents() {
  SegmentParams params;
  params.split = params.join = params.rim = false;
  return params;
}

/// Every second pixel both ways.
LabelledScene halved(const LabelledScene& scene) {
  LabelledScene half = scene;
  cv::resize(scene.depth.pixels, half.depth.pixels, {}, 0.5, 0.5, cv::INTER_NEAREST);
  cv::resize(scene.labels, half.labels, {}, 0.5, 0.5, cv::INTER_NEAREST);
  Camera& camera = half.depth.camera;
  for (auto* value : {&camera.fx_q16, &camera.fy_q16, &camera.cx_q16, &camera.cy_q16}) *value /= 2;
  return half;
}

Measured measureOurs(const std::vector<LabelledScene>& scenes, const SegmentParams& params) {
  Measured measured;
  Segmenter segmenter;
  std::vector<DepthView> views;
  for (const LabelledScene& scene : scenes) {
    views.push_back(scene.depth.view());
    addScene(scene.name, segmenter.segment(views.back(), params), scene.labels, views.back(), scene.truth,
             measured.score);
  }
  measured.us = segmentationUs(views, params);
  return measured;
}

Measured measurePcl(const std::vector<LabelledScene>& scenes, int voxel_mm) {
  Measured measured;
  for (const LabelledScene& scene : scenes) {
    const DepthView view = scene.depth.view();
    const PclClusters found = segmentByPcl(view, voxel_mm);
    measured.us.push_back(found.us);
    std::vector<Cluster> clusters(found.pixels.size());
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      clusters[i].pixels = {found.pixels[i].data(), found.pixels[i].size()};
    }
    Scene as_scene;
    as_scene.clusters = {clusters.data(), clusters.size()};
    addScene(scene.name, as_scene, scene.labels, view, scene.truth, measured.score);
  }
  return measured;
}

Json rowOf(const std::string& name, const Measured& ours, const Measured& points, const Measured& voxels) {
  Json row = benchRow(name, ours.us);
  row["worst_us"] = rounded(quantile(ours.us, 1), 2);
  row["scenes"] = ours.score.scenes;
  row["objects"] = ours.score.objects;
  row["right"] = ours.score.right;
  comparePeer(row, "PCL SAC + ECE", quantile(points.us, 0.5));
  row["peer_right"] = points.score.right;
  row["peer_median_us_voxels"] = rounded(quantile(voxels.us, 0.5), 2);
  row["ratio_voxels"] = rounded(quantile(voxels.us, 0.5) / row["median_us"].get<double>(), 2);
  row["peer_right_voxels"] = voxels.score.right;
  return row;
}

}  // namespace

Result<std::vector<Json>> benchSegmentation(const std::string& folder, int most) {
  std::vector<LabelledScene> all, scenes, halves;
  const Status read = visitScenes(folder, [&](const LabelledScene& scene) { all.push_back(scene); });
  if (!read.ok()) return read;
  const std::size_t taken = std::min<std::size_t>(all.size(), static_cast<std::size_t>(most));
  for (std::size_t i = 0; i < taken; ++i) {
    const LabelledScene& scene = all[i * all.size() / taken];
    if (scene.labels.cols != 640 || scene.labels.rows != 480)
      return Status::cannotDo(scene.depth.path + ": is " + std::to_string(scene.labels.cols) + " x " +
                              std::to_string(scene.labels.rows) + "; the rows are of 640 x 480");
    scenes.push_back(scene);
    halves.push_back(halved(scene));
  }
  const Measured points = measurePcl(scenes, 0), voxels = measurePcl(scenes, kVoxel_mm);
  return std::vector<Json>{rowOf("segment/vga", measureOurs(scenes, planeAndComponents()), points, voxels),
                           rowOf("segment/qvga", measureOurs(halves, planeAndComponents()), measurePcl(halves, 0),
                                 measurePcl(halves, kVoxel_mm)),
                           rowOf("segment/full", measureOurs(scenes, SegmentParams{}), points, voxels)};
}

}  // namespace voxid::cli
