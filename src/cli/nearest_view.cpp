// SPDX-License-Identifier: BSD-3-Clause
#include "nearest_view.h"

#include "voxid/library/model_shelf.h"

namespace voxid::cli {

std::string NearestView::model() const {
  const std::uint32_t number = index->modelOf(found.view);
  if (number >= index->models().size) return {};  // a damaged file; `verify` says where
  return fullNameOf(*index, number);
}

Result<std::shared_ptr<const Index>> openPaperIndex(const std::string& path) {
  auto index = Index::open(path);
  if (index.ok() && index.value->projection()) {
    return Status::cannotDo(path +
                            ": is of descriptor default; expected one made with `voxid build --descriptor paper`");
  }
  return index;
}

NearestView nearestOf(std::shared_ptr<const Index> index, const Descriptor& bins) {
  const auto search = makeExactSearch(index);
  return {std::move(index), search->find(bins.data()).views[0]};
}

Json toJson(const NearestView& nearest) {
  Json json;
  json["view"] = nearest.found.view;
  json["model"] = nearest.model();
  json["direction"] = nearest.direction();
  json["distance"] = nearest.found.distance;
  return json;
}

std::string captionOf(const NearestView& nearest) {
  return nearest.model() + ", direction " + std::to_string(nearest.direction()) + ", L1 distance " +
         std::to_string(nearest.found.distance);
}

}  // namespace voxid::cli
