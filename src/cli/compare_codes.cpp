// SPDX-License-Identifier: BSD-3-Clause
#include "compare_codes.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "esf.h"
#include "float_distance.h"
#include "float_shapes.h"
#include "voxid/core/descriptor.h"

namespace voxid::cli {
namespace {

/// Bins in floats, compared by L1 in 1/`steps`.
class FloatCode : public ViewCode {
 public:
  FloatCode(std::string code_name, int bins, float steps)
      : ViewCode(std::move(code_name), static_cast<std::size_t>(bins) * sizeof(float)), bins_(bins), steps_(steps) {}

  bool describe(const DepthView& depth, Span<const std::uint32_t> pixels, std::uint8_t* out) override {
    const std::vector<PointUm> points = pointsOf(depth, pixels);
    const float* const bins = binsOf({points.data(), points.size()});
    if (bins == nullptr) return false;
    std::memcpy(out, bins, bytes);
    return true;
  }

  std::uint32_t distance(const std::uint8_t* a, const std::uint8_t* b) const override {
    const float sum = l1OfFloats(reinterpret_cast<const float*>(a), reinterpret_cast<const float*>(b), bins_);
    return static_cast<std::uint32_t>(std::lround(sum * steps_));
  }

 private:
  /// Null if there is no answer.
  virtual const float* binsOf(Span<const PointUm> points) = 0;

  int bins_;
  float steps_;
};

class EsfCode : public FloatCode {
 public:
  EsfCode() : FloatCode("esf", kEsfBins, 1e6f) {}

 private:
  const float* binsOf(Span<const PointUm> points) override {
    return esf_->accept(points) ? esf_->describe().data() : nullptr;
  }

  std::unique_ptr<Esf> esf_ = makeEsf();
};

bool differ(Span<const PointUm> points) {
  for (const PointUm& p : points) {
    if (p.x != points[0].x || p.y != points[0].y || p.z != points[0].z) return true;
  }
  return false;
}

/// The first `bins` of the paper's descriptor in floats.
class FloatShapesCode : public FloatCode {
 public:
  FloatShapesCode(std::string code_name, int bins, const DescriptorParams& params)
      : FloatCode(std::move(code_name), bins, 100), params_(params) {}

 private:
  const float* binsOf(Span<const PointUm> points) override {
    if (!differ(points)) return nullptr;
    shapes_ = floatShapesOf(points, params_);
    return shapes_.data();
  }

  DescriptorParams params_;
  FloatShapes shapes_{};
};

class ProfileCode : public ViewCode {
 public:
  explicit ProfileCode(const Profile& profile)
      : ViewCode(profile.projection ? "default" : "paper", profile.codeBytes(), profile.projection != nullptr),
        profile_(profile),
        encoder_(makeEncoder(profile)) {}

  bool describe(const DepthView& depth, Span<const std::uint32_t> pixels, std::uint8_t* out) override {
    return encoder_->encode(depth, pixels, out) == DescribeStatus::Ok;
  }
  std::uint32_t distance(const std::uint8_t* a, const std::uint8_t* b) const override {
    return codeDistance(profile_, a, b);
  }

 private:
  Profile profile_;
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace

DescriptorParams paperParamsOf(const Index& index) {
  return index.projection() ? DescriptorParams{} : index.descriptorParams();
}

std::vector<std::unique_ptr<ViewCode>> comparedCodes(const Index& index) {
  const DescriptorParams params = paperParamsOf(index);
  std::vector<std::unique_ptr<ViewCode>> codes;
  codes.push_back(std::make_unique<EsfCode>());
  codes.push_back(std::make_unique<FloatShapesCode>("d2", kDistanceBins, params));
  codes.push_back(std::make_unique<FloatShapesCode>("paper_float", kDescriptorBytes, params));
  codes.push_back(std::make_unique<ProfileCode>(Profile{params, nullptr}));
  if (index.projection()) codes.push_back(std::make_unique<ProfileCode>(index.profile()));
  return codes;
}

std::unique_ptr<ViewCode> ownCode(const Index& index) { return std::make_unique<ProfileCode>(index.profile()); }

std::vector<PointUm> pointsOf(const DepthView& depth, Span<const std::uint32_t> pixels) {
  std::vector<PointUm> points;
  for (const std::uint32_t pixel : pixels) {
    const int u = static_cast<int>(pixel) % depth.width_px, v = static_cast<int>(pixel) / depth.width_px;
    const std::int32_t z_um = depth.depthUm(u, v);
    if (z_um > 0) points.push_back(backProject(depth.camera, u, v, z_um));
  }
  return points;
}

}  // namespace voxid::cli
