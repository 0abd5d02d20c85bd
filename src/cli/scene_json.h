// SPDX-License-Identifier: BSD-3-Clause
// A segmented frame as JSON, as a label image and as a picture.
#pragma once

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "voxid/core/status.h"
#include "voxid/geometry/scene.h"

namespace voxid::cli {

/// Fields keep the order in which they are documented (doc/segmentation.md).
using Json = nlohmann::ordered_json;

/// normal, distance_m, outline (metres), residual_mm, inliers.
Json toJson(const Table& table);

/// id, pixels, box_px, centroid_m, extents_m, truncated. `classify --scene` adds its fields.
Json toJson(const Cluster& cluster);

/// file, status, table (null if there is none), objects, dropped. One frame, one line.
Json toJson(const std::string& file, const Scene& scene);

/// CV_16UC1: the object's id at each of its pixels, 0 elsewhere.
cv::Mat labelImage(const Scene& scene, int width_px, int height_px);

/// Writes the label image to FOLDER/STEM.png, STEM being the input's name without its ending; makes the folder if need
/// be.
Status writeLabels(const std::string& folder, const std::string& input, const cv::Mat& labels);

/// The colour of an object's pixels, box and caption; BGR.
cv::Scalar colourOf(int id);

/// CV_8UC3: depth in grey (near is bright), the table's outline, each object's pixels and boxes in a colour of its own.
cv::Mat drawScene(const DepthView& depth, const Scene& scene);

/// Above each object, none on another. `captions` by cluster; missing ones are the id.
void writeCaptions(const Scene& scene, const std::vector<std::string>& captions, cv::Mat& picture);

/// PATH for a single frame; with several, PATH with "-STEM" before its ending.
std::string plotPath(const std::string& path, const std::string& input, bool single);

/// CannotDo if the picture cannot be written (folder missing, unknown ending).
Status writeImage(const std::string& path, const cv::Mat& image);

/// Status of a run over frames: if none has an object NothingFound (CannotDo for BAD_INPUT) with the first frame's
/// reason.
Status statusOf(const std::vector<SceneStatus>& frames, const std::string& first_file);

/// One sentence for people: "nothing stands on the table".
const char* sentenceOf(SceneStatus status);

}  // namespace voxid::cli
