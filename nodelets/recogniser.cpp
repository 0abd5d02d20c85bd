// SPDX-License-Identifier: BSD-3-Clause
#include "recogniser.h"

namespace voxid {

Recogniser::Recogniser(std::shared_ptr<const Index> index, std::shared_ptr<const AnswerScope> scope)
    : index_(std::move(index)),
      scope_(std::move(scope)),
      encoder_(makeEncoder(index_->profile())),
      code_(index_->parameters().code_bytes) {}

const Nearest* Recogniser::nearest(const DepthView& depth, Span<const std::uint32_t> pixels,
                                   const ClassifyParams& params, std::optional<std::uint32_t> only) {
  if (encoder_->encode(depth, pixels, code_.data()) != DescribeStatus::Ok) return nullptr;
  SearchScope scope;
  if (only) {
    only_.assign(index_->categories().size, 0);
    only_[*only] = 1;
    scope.categories = {only_.data(), only_.size()};
  } else if (scope_) {
    scope.categories = scope_->of(depth, pixels, workspace_);
  }
  return &searchFor(params).find(code_.data(), scope);
}

Answer Recogniser::recognise(const DepthView& depth, Span<const std::uint32_t> pixels, const ClassifyParams& params) {
  const Nearest* const found = nearest(depth, pixels, params);
  if (!found) return {};
  return classify(*index_, *found, params.vote ? ClassifyMethod::Vote : ClassifyMethod::OneNn,
                  params.min_score_permille);
}

Search& Recogniser::searchFor(const ClassifyParams& params) {
  const SearchParams wanted = searchParamsOf(params);
  if (!search_ || !(wanted == made_for_)) {
    search_ = makeSearch(index_, wanted);
    made_for_ = wanted;
  }
  return *search_;
}

}  // namespace voxid
