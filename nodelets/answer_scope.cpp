// SPDX-License-Identifier: BSD-3-Clause
#include "answer_scope.h"

namespace voxid {

AnswerScope::AnswerScope(const Index& index, const std::string& list, bool size, const std::string& confirmed)
    : confirmed_(confirmed) {
  const auto read = confirmed.empty() ? ConfirmedSizes() : ConfirmedSizes::read(confirmed);
  if (!read.ok()) trouble_ = "~confirmed_sizes: " + read.status.sentence + ": the reviewed sizes alone count";
  if (size) sizes_ = std::make_shared<const SizeTable>(index, read.value);
  if (list.empty()) return;
  auto listed = readAllowedCategories(list, index);
  if (listed.ok()) listed_ = std::move(listed.value);
  if (!listed.ok()) trouble_ = "~categories: " + listed.status.sentence + ": objects may be of any category";
}

Status AnswerScope::confirm(const Index& index, const std::string& category, int longest_mm) {
  if (confirmed_.empty()) return Status::cannotDo("~confirmed_sizes names no file to keep sizes in");
  auto sizes = ConfirmedSizes::read(confirmed_);
  if (!sizes.ok()) return sizes.status;
  sizes.value.add(category, longest_mm);
  const Status written = sizes.value.write(confirmed_);
  if (!written.ok()) return written;
  auto table = std::make_shared<const SizeTable>(index, sizes.value);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (sizes_) sizes_.swap(table);
  return {};
}

Span<const std::uint8_t> AnswerScope::of(const DepthView& depth, Span<const std::uint32_t> pixels,
                                         Workspace& workspace) const {
  std::shared_ptr<const SizeTable> sizes;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    sizes = sizes_;
  }
  if (!sizes) return {listed_.data(), listed_.size()};
  sizes->find(workspace.extent.of_mm(depth, pixels), listed_, &workspace.fitting);
  return {workspace.fitting.data(), workspace.fitting.size()};
}

}  // namespace voxid
