// SPDX-License-Identifier: BSD-3-Clause
#include "answer_scope.h"

namespace voxid {

AnswerScope::AnswerScope(const Index& index, const std::string& list, bool size) {
  if (size) sizes_.emplace(index);
  if (list.empty()) return;
  auto listed = readAllowedCategories(list, index);
  if (listed.ok()) listed_ = std::move(listed.value);
  if (!listed.ok()) trouble_ = "~categories: " + listed.status.sentence + ": objects may be of any category";
}

Span<const std::uint8_t> AnswerScope::of(const DepthView& depth, Span<const std::uint32_t> pixels,
                                         Workspace& workspace) const {
  if (!sizes_) return {listed_.data(), listed_.size()};
  sizes_->find(workspace.extent.of_mm(depth, pixels), listed_, &workspace.fitting);
  return {workspace.fitting.data(), workspace.fitting.size()};
}

}  // namespace voxid
