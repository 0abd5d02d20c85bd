// SPDX-License-Identifier: BSD-3-Clause
// `voxid info --bucket`: the views of an index that share a hash key.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "scene_json.h"
#include "voxid/core/index.h"

namespace voxid::cli {

struct Bucket {
  Key key = 0;
  std::vector<std::uint32_t> views;  ///< numbers in the index, ascending; at least one
};

/// By `wanted`: a key in hexadecimal as `describe` prints it ("0x..."), or "view:N", the bucket of the N-th view.
/// BadUse for anything else and for a view that the index does not have; NothingFound for a key that no view has.
Result<Bucket> findBucket(const Index& index, const std::string& wanted);

/// key, views (list of view, model, direction).
Json toJson(const Index& index, const Bucket& bucket);

/// One line for the key, one a view.
void printBucket(const Index& index, const Bucket& bucket);

/// CV_8UC3: thumbnails of the views, rendered from the meshes in `models` as the build did, near bright and far dark:
/// the paper's Fig. 10. At most 48 of them, evenly chosen. CannotDo for a model whose mesh is missing or unreadable.
Result<cv::Mat> drawBucket(const Index& index, const Bucket& bucket, const std::string& models);

}  // namespace voxid::cli
