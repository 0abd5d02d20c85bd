// SPDX-License-Identifier: BSD-3-Clause
// The view of an index that is nearest to a descriptor.
#pragma once

#include <memory>
#include <string>

#include "scene_json.h"
#include "voxid/core/search.h"

namespace voxid::cli {

struct NearestView {
  std::shared_ptr<const Index> index;
  Neighbour found;

  const std::uint8_t* bins() const { return index->code(found.view); }  ///< 416
  std::string model() const;                                            ///< <category>/<model>
  int direction() const { return index->view(found.view).direction; }
};

/// Index::open(), which also refuses (CannotDo) an index of other descriptors than the paper's.
Result<std::shared_ptr<const Index>> openPaperIndex(const std::string& path);

/// Of all views; the index has at least one.
NearestView nearestOf(std::shared_ptr<const Index> index, const Descriptor& bins);

/// view, model, direction, distance.
Json toJson(const NearestView& nearest);

/// "mug/blue_mug, direction 12, L1 distance 3456".
std::string captionOf(const NearestView& nearest);

}  // namespace voxid::cli
