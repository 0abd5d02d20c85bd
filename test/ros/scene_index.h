// SPDX-License-Identifier: BSD-3-Clause
// An index that knows exactly what TableScene shows.
#pragma once

#include <stdexcept>
#include <string>

#include "conversions.h"
#include "table_scene.h"
#include "voxid/core/descriptor.h"
#include "voxid/geometry/segmenter.h"
#include "voxid/library/index_writer.h"

namespace voxid::test {

inline ModelRecord modelOf(const std::string& category, const std::string& name, std::uint32_t synset,
                           const Descriptor& bins) {
  ModelRecord model;
  model.category = category;
  model.name = name;
  model.synset = synset;
  ViewRecord view;
  view.direction = 1;
  view.points = 1;
  view.code.assign(bins.begin(), bins.end());
  model.views.push_back(view);
  return model;
}

/// The box's view as category `box_label` (model box-7, synset 2883344), the ball's as "ball" (model ball-3, synset
/// 2778669); each with direction 1. `twin`: a category before these, whose only model, twin-1, looks like the box, too.
inline void writeSceneIndex(const std::string& path, const std::string& box_label = "box",
                            const std::string& twin = "") {
  const auto image = imageOf(TableScene().depth_mm(), ros::Time(1));
  const DepthView depth = viewOf(*image, *infoOf(ros::Time(1))).value;
  Segmenter segmenter;
  const Scene& scene = segmenter.segment(depth, {});
  if (scene.clusters.size != 2) throw std::runtime_error("the scene's two things are not found");
  const bool box_first = scene.clusters[0].centroid_m.x() < scene.clusters[1].centroid_m.x();
  Describer describer;
  IndexContent content;
  content.directions.resize(2);
  content.directions[0] = {{32767, 0, 0}, {0, 32767, 0}, {}};
  content.directions[1] = {{0, 32767, 0}, {0, 0, 32767}, {}};
  const Descriptor box = describer.describe(depth, scene.clusters[box_first ? 0 : 1].pixels).bins;
  if (!twin.empty()) content.models.push_back(modelOf(twin, "twin-1", 0, box));
  content.models.push_back(modelOf(box_label, "box-7", 2883344, box));
  content.models.push_back(
      modelOf("ball", "ball-3", 2778669, describer.describe(depth, scene.clusters[box_first ? 1 : 0].pixels).bins));
  content.calibration = builtInCalibration({});
  const Status written = writeIndex(content, path);
  if (!written.ok()) throw std::runtime_error(written.sentence);
}

}  // namespace voxid::test
