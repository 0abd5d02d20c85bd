// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "voxid/core/depth_view.h"
#include "voxid/core/span.h"

namespace voxid {

/// Why a frame gave what it gave. The names (nameOf) and numbers are those of the messages, ROS and LCM.
enum class SceneStatus : std::uint8_t {
  Ok = 0,
  NoDepth = 1,      ///< no pixel inside the depth range
  NoTable = 2,      ///< no plane with enough points
  EmptyTable = 3,   ///< a table, and nothing on it
  NoTransform = 4,  ///< tf2 does not know the target frame at the stamp
  NoIndex = 5,      ///< segmented, but no index is loaded to compare with
  BadInput = 6,     ///< image and camera_info disagree, an unknown encoding, no intrinsics
};
const char* nameOf(SceneStatus status);  ///< "OK", "NO_DEPTH", ...

/// The support plane, in the camera's optical frame.
struct Table {
  Eigen::Vector3f normal{0, 0, 0};        ///< unit, from the table towards the camera's side
  float distance_m = 0;                   ///< camera above the plane: normal . p + distance_m = 0 for p on the plane
  Span<const Eigen::Vector3f> outline_m;  ///< convex hull of the plane's points, on the plane, counter-clockwise seen
                                          ///< from the camera; at least 3 points
  std::uint32_t inliers = 0;  ///< pixels on the plane
  float residual_mm = 0;      ///< root mean square height of the inliers
};

struct PixelBox {
  int x = 0, y = 0, width = 0, height = 0;  ///< left, top corner and size, all pixels inside
};

/// One object on the table.
struct Cluster {
  int id = 0;                        ///< 1, 2, ... in the order of the first pixel; id in labels and messages
  Span<const std::uint32_t> pixels;  ///< row * width + column, ascending
  PixelBox box_px;
  Eigen::Vector3f centroid_m{0, 0, 0};                 ///< mean of the visible points, or of a part of their rows
  Eigen::Vector3f box_centre_m{0, 0, 0};               ///< centre of the oriented box
  Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();  ///< columns: box axes; the third is the table's normal, the
                                                       ///< first the longer side in the table's plane; right-handed
  Eigen::Vector3f extents_m{0, 0, 0};  ///< along the axes; the third is the height above the table
  bool truncated = false;              ///< touches the image's border or reaches over the table's outline
};

enum class DropReason : std::uint8_t { TooFewPoints, OutsideOutline, TooMany, kCount };
const char* nameOf(DropReason reason);  ///< "too_few_points", ...

/// A cluster that is no object.
struct LeftOut {
  DropReason reason = DropReason::TooFewPoints;
  std::uint32_t pixels = 0;
  PixelBox box_px;
};

/// What a frame shows. Lists belong to the Segmenter until its next call.
struct Scene {
  SceneStatus status = SceneStatus::NoDepth;
  Table table;  ///< only with Ok and EmptyTable
  Span<const Cluster> clusters;
  std::array<std::uint32_t, static_cast<int>(DropReason::kCount)> dropped{};  ///< clusters, by DropReason
  Span<const LeftOut> left_out;    ///< of those the largest, at most 64, in any order
  std::uint32_t valid_pixels = 0;  ///< inside the depth range
};

}  // namespace voxid
