// SPDX-License-Identifier: BSD-3-Clause
#include "recogniser.h"

namespace voxid {

Recogniser::Recogniser(std::shared_ptr<const Index> index)
    : index_(std::move(index)), describer_(index_->descriptorParams()) {}

Answer Recogniser::recognise(const DepthView& depth, Span<const std::uint32_t> pixels, const ClassifyParams& params) {
  const Described described = describer_.describe(depth, pixels);
  if (described.status != DescribeStatus::Ok) return {};
  const Nearest& nearest = searchFor(params).find(described.bins.data());
  return classify(*index_, nearest, params.vote ? ClassifyMethod::Vote : ClassifyMethod::OneNn,
                  params.min_score_permille);
}

Search& Recogniser::searchFor(const ClassifyParams& params) {
  const bool same = params.exact == exact_ && (params.exact || params.radius_bits == radius_bits_);
  if (!search_ || !same) {
    search_ = params.exact ? makeExactSearch(index_) : makeLshSearch(index_, params.radius_bits);
    exact_ = params.exact;
    radius_bits_ = params.radius_bits;
  }
  return *search_;
}

}  // namespace voxid
