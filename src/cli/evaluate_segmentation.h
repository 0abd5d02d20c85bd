// SPDX-License-Identifier: BSD-3-Clause
// Segmentation compared with hand-made labels (layout of the modified Object Segmentation Database).
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "depth_file.h"
#include "voxid/core/status.h"
#include "voxid/geometry/scene.h"
#include "voxid/geometry/segment_params.h"

namespace voxid::cli {

/// An object is right if one cluster holds at least 90 % of its labelled points and at least 95 % of that cluster is
/// the object.
struct SegmentationScore {
  int scenes = 0, tables = 0;
  int objects = 0, right = 0;      ///< all that the truth does not exclude
  int alone = 0, alone_right = 0;  ///< no other object within 2 cm, not cut by the image's border
  int whole = 0, whole_right = 0;  ///< of those, the ones that no nearer object cuts in two
  int dense = 0, dense_right = 0;  ///< another object within 2 cm, not cut by the border
  int over = 0;                    ///< objects of which two or more clusters hold at least 10 % each
  int under = 0;                   ///< objects whose best cluster is other objects by more than 5 %
  int table_clusters = 0;          ///< clusters that are mostly bare table
  std::int64_t object_points = 0, missed_points = 0, foreign_points = 0;
  std::vector<double> plane_error_mm, plane_error_deg;  ///< against least squares through the labelled table points
  std::vector<double> segment_ms;                       ///< processor time, each scene's median; empty if not asked for
  std::vector<std::string> wrong;                       ///< "scene id" of objects that stand alone and are not right

  double fOs() const;  ///< share of the objects' points outside their best clusters
  double fUs() const;  ///< foreign objects' points in best clusters, over all objects' points; may exceed 1
};

/// Labels: 0 no depth, 1 to 9 table, else id * 10 + part. `truth`: the scene's entry of objects.json.
void addScene(const std::string& name, const Scene& scene, const cv::Mat& labels, const DepthView& depth,
              const nlohmann::json& truth, SegmentationScore& score);

/// A frame of such a folder: NAME_depth.png, NAME_labels.png and its entry of objects.json.
struct LabelledScene {
  std::string name;
  DepthFile depth;
  cv::Mat labels;  ///< CV_16UC1, of the depth image's size
  nlohmann::json truth;
};

/// Every scene that FOLDER/objects.json names, in the order of the names. NothingFound if it names none.
Status visitScenes(const std::string& folder, const std::function<void(const LabelledScene&)>& visit);

/// Microseconds of the thread's processor time for each scene, the median of 20. All scenes take their turn before the
/// first comes again: a camera's frames differ, too, and a spell in which the machine is slow meets them all.
std::vector<double> segmentationUs(const std::vector<DepthView>& scenes, const SegmentParams& params);

/// Segments every scene that DIR/objects.json names; `timing`: 20 times more, for the time.
Result<SegmentationScore> evaluateFolder(const std::string& folder, const SegmentParams& params, bool timing);

nlohmann::ordered_json toJson(const SegmentationScore& score);
std::string toTable(const SegmentationScore& score);

}  // namespace voxid::cli
