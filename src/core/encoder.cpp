// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/encoder.h"

#include <algorithm>
#include <array>
#include <utility>

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
  ProjectedEncoder(std::shared_ptr<const Projection> projection, bool packed)
      : projection_(std::move(projection)), packed_(packed), describer_(projection_->descriptorParams()) {}

  DescribeStatus encode(const DepthView& depth, Span<const std::uint32_t> pixels, std::uint8_t* code) override {
    const DescribeStatus status = describer_.describe(depth, pixels, bins_);
    projection_->project(bins_, packed_ ? unpacked_.data() : code);
    if (packed_) packCode(unpacked_.data(), code);
    return status;
  }

 private:
  std::shared_ptr<const Projection> projection_;
  bool packed_;
  DepthDescriber describer_;
  DepthBins bins_;
  std::array<std::uint8_t, kCodeNumbers> unpacked_;
};

}  // namespace

std::unique_ptr<Encoder> makeEncoder(const Profile& profile) {
  if (profile.projection) return std::make_unique<ProjectedEncoder>(profile.projection, profile.packed);
  return std::make_unique<PaperEncoder>(profile.params);
}

}  // namespace voxid
