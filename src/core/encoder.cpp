// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/encoder.h"

#include <algorithm>

namespace voxid {
namespace {

class PaperEncoder : public Encoder {
 public:
  explicit PaperEncoder(const DescriptorParams& params) : describer_(params) {}

  DescribeStatus encode(const DepthView& depth, Span<const std::uint32_t> pixels, std::uint8_t* code) override {
    const Described described = describer_.describe(depth, pixels);
    std::copy(described.bins.begin(), described.bins.end(), code);
    return described.status;
  }

 private:
  Describer describer_;
};

class ProjectedEncoder : public Encoder {
 public:
  explicit ProjectedEncoder(const Profile& profile)
      : projection_(profile.projection),
        code_bytes_(profile.codeBytes()),
        describer_(projection_->descriptorParams()) {}

  DescribeStatus encode(const DepthView& depth, Span<const std::uint32_t> pixels, std::uint8_t* code) override {
    const DescribeStatus status = describer_.describe(depth, pixels, bins_);
    projection_->project(bins_, code_bytes_, code);
    return status;
  }

 private:
  std::shared_ptr<const Projection> projection_;
  std::size_t code_bytes_;
  DepthDescriber describer_;
  DepthBins bins_;
};

}  // namespace

std::unique_ptr<Encoder> makeEncoder(const Profile& profile) {
  if (profile.projection) return std::make_unique<ProjectedEncoder>(profile);
  return std::make_unique<PaperEncoder>(profile.params);
}

}  // namespace voxid
