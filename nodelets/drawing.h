// SPDX-License-Identifier: BSD-3-Clause
// What people look at, from the messages alone: pure functions.
#pragma once

#include <visualization_msgs/MarkerArray.h>
#include <voxid/AlignedModels.h>
#include <voxid/Objects.h>
#include <voxid/Segments.h>

#include <opencv2/core.hpp>
#include <string>

#include "voxid/core/depth_view.h"

namespace voxid {

/// "mug 87 %"; "mug 45 % (container?)" where more can be said of the coarser thing; "container?" or "?" for an unknown
/// one.
std::string captionOf(const Object& object);

/// The depth image in grey, near things bright, with every object in its colour, its box and its caption, the table's
/// outline, and the clusters that are no objects with the reason; 8-bit BGR.
cv::Mat drawOverlay(const DepthView& depth, const Segments& segments, const Objects& objects);

/// Boxes (namespace "box", CUBE), captions ("label", TEXT_VIEW_FACING), the boxes of aligned models with their axes
/// ("model", LINE_LIST) and their surfaces, as far as `models` has them ("surface", POINTS), by object id, and the
/// table's outline ("table", LINE_STRIP, id 0) in the frame of `objects`. A model's x, y, z are red, green, blue; if
/// its rotation is not known, the axis that it may stand turned about is yellow instead. What `previous` showed and
/// this does not is deleted.
visualization_msgs::MarkerArray markersOf(const Objects& objects, const AlignedModels& models,
                                          const visualization_msgs::MarkerArray& previous);

}  // namespace voxid
