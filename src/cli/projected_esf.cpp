// SPDX-License-Identifier: BSD-3-Clause
#include "projected_esf.h"

#include <array>
#include <cmath>

#include "esf.h"
#include "voxid/core/code.h"
#include "voxid/library/discriminants.h"
#include "voxid/library/trainer.h"

namespace voxid::cli {
namespace {

using Roots = std::array<std::uint8_t, kEsfBins>;

/// ESF's bins add up to one over all 640, so that few roots are above 50 of 255.
Roots rootsOf(const float* bins) {
  Roots roots;
  for (std::size_t i = 0; i < roots.size(); ++i) {
    roots[i] = static_cast<std::uint8_t>(std::lround(255 * std::sqrt(std::min(std::max(bins[i], 0.0f), 1.0f))));
  }
  return roots;
}

/// As Projection::project.
void project(const IntegerMap& map, const Roots& bins, std::uint8_t* code) {
  std::array<std::int64_t, kCodeNumbers> projected;
  for (std::size_t k = 0; k < kCodeNumbers; ++k) {
    std::int64_t sum = map.bias[k];
    for (std::size_t i = 0; i < bins.size(); ++i) sum += map.matrix[k * bins.size() + i] * bins[i];
    projected[k] = sum * map.factor_q24[k] >> 24;
  }
  packCode(projected.data(), kCodeBytes, code);
}

class ProjectedEsfCode : public ViewCode {
 public:
  explicit ProjectedEsfCode(IntegerMap map) : ViewCode("esf_projected", kCodeBytes, true), map_(std::move(map)) {}

  bool describe(const DepthView& depth, Span<const std::uint32_t> pixels, std::uint8_t* out) override {
    const std::vector<PointUm> points = pointsOf(depth, pixels);
    if (!esf_->accept({points.data(), points.size()})) return false;
    project(map_, rootsOf(esf_->describe().data()), out);
    return true;
  }
  std::uint32_t distance(const std::uint8_t* a, const std::uint8_t* b) const override {
    return squaredDistance(a, b, bytes);
  }

 private:
  IntegerMap map_;
  std::unique_ptr<Esf> esf_ = makeEsf();
};

const float* binsOf(const CodeTable& esf, std::size_t row) { return reinterpret_cast<const float*>(esf.code(row)); }

IntegerMap learn(const Index& index, const std::vector<std::uint32_t>& views, const CodeTable& esf) {
  const auto for_each_view = [&](const TakeView& take) {
    for (std::size_t row = 0; row < views.size(); ++row) {
      if (!esf.hasAnswer(row)) continue;
      const std::uint32_t category = index.models()[index.modelOf(views[row])].category;
      take(std::string(index.categoryName(category)), rootsOf(binsOf(esf, row)).data());
    }
  };
  return learnDiscriminants(for_each_view, kEsfBins, static_cast<int>(kCodeNumbers), TrainOptions().shrinkage);
}

}  // namespace

ProjectedEsf projectEsf(const Index& index, const std::vector<std::uint32_t>& views, const CodeTable& esf) {
  const IntegerMap map = learn(index, views, esf);
  ProjectedEsf made{std::make_unique<ProjectedEsfCode>(map), std::make_unique<CodeTable>(views.size(), kCodeBytes)};
  for (std::size_t row = 0; row < views.size(); ++row) {
    if (!esf.hasAnswer(row)) continue;
    project(map, rootsOf(binsOf(esf, row)), made.table->code(row));
    made.table->answered.data()[row] = 1;
  }
  return made;
}

}  // namespace voxid::cli
