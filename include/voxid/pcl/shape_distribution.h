// SPDX-License-Identifier: BSD-3-Clause
// The paper's descriptor for users of PCL. Whoever uses pcl::ESFEstimation changes two lines:
//
//   voxid::ShapeDistributionEstimation<pcl::PointXYZ> estimation;  // was pcl::ESFEstimation<pcl::PointXYZ>
//   pcl::PointCloud<pcl::Histogram<416>> signature;                // was pcl::PointCloud<pcl::ESFSignature640>
//   estimation.setInputCloud(cloud);
//   estimation.compute(signature);
#pragma once

#include <pcl/features/feature.h>
#include <pcl/point_types.h>

#include <cmath>
#include <vector>

#include "voxid/core/descriptor.h"

namespace voxid {

/// One 416-bin shape distribution for a whole cloud (profile `paper`, see voxid/core/descriptor.h): D2 coarse 32,
/// D2 fine 128, ON 64, OFF 64, MIXED 64, ratio 64. A bin is a whole number, 0 to 255; compare by L1.
///
/// Takes any point type with x, y, z in metres. Honours setIndices; needs no normals, no search tree and no search
/// surface, and ignores them. Points that are not finite, or lie beyond 2,147 m, are left out. The same cloud gives the
/// same bins on every machine; every cloud gives an answer in bounded time.
///
/// Takes its memory (about 1.4 MiB) at construction, so keep one and use it again. One object a thread.
template <typename PointInT>
class ShapeDistributionEstimation : public pcl::Feature<PointInT, pcl::Histogram<kDescriptorBytes>> {
  using Base = pcl::Feature<PointInT, pcl::Histogram<kDescriptorBytes>>;

 public:
  using typename Base::PointCloudOut;

  explicit ShapeDistributionEstimation(const DescriptorParams& params = {}) : describer_(params) {
    this->feature_name_ = "ShapeDistributionEstimation";
  }

  /// One signature, or an empty cloud where getStatus() says why there is none.
  void compute(PointCloudOut& output) {
    status_ = DescribeStatus::Empty;
    output.clear();
    if (!initCompute()) return;
    output.header = this->input_->header;
    computeFeature(output);
    this->deinitCompute();
  }

  /// Of the last compute(): Ok, Empty (no usable point), Degenerate (one point, or all in one place).
  DescribeStatus getStatus() const { return status_; }

 protected:
  /// Without the search tree that pcl::Feature would build.
  bool initCompute() override { return pcl::PCLBase<PointInT>::initCompute(); }

 private:
  void computeFeature(PointCloudOut& output) override {
    points_.clear();
    for (const auto index : *this->indices_) append((*this->input_)[static_cast<std::size_t>(index)]);
    const Described described = describer_.describe({points_.data(), points_.size()});
    status_ = described.status;
    output.clear();
    output.is_dense = true;
    if (status_ != DescribeStatus::Ok) return;
    pcl::Histogram<kDescriptorBytes> signature;
    for (int i = 0; i < kDescriptorBytes; ++i) signature.histogram[i] = described.bins[static_cast<std::size_t>(i)];
    output.push_back(signature);
  }

  void append(const PointInT& p) {
    constexpr double kFarthest_m = 2147;  // as micrometres still an int32
    for (const double c : {p.x, p.y, p.z}) {
      if (!(std::abs(c) <= kFarthest_m)) return;  // also if it is NaN
    }
    const auto um = [](double m) { return static_cast<std::int32_t>(std::lround(m * 1e6)); };
    points_.push_back({um(p.x), um(p.y), um(p.z)});
  }

  Describer describer_;
  std::vector<PointUm> points_;
  DescribeStatus status_ = DescribeStatus::Empty;
};

}  // namespace voxid
