// SPDX-License-Identifier: BSD-3-Clause
#include "../esf.h"

#include <pcl/features/esf.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>

namespace voxid::cli {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr float kGridRadius = 32;  // to which ESF scales a cloud before it looks at its triangles
constexpr float kLeastArea = 0.001f;

float distance(const pcl::PointXYZ& a, const pcl::PointXYZ& b) {
  return (a.getVector3fMap() - b.getVector3fMap()).norm();
}

/// The largest distance from the centroid.
float radiusOf(const Cloud& cloud) {
  Eigen::Vector3f centroid = Eigen::Vector3f::Zero();
  for (const auto& p : cloud) centroid += p.getVector3fMap();
  centroid /= static_cast<float>(cloud.size());
  float radius = 0;
  for (const auto& p : cloud) radius = std::max(radius, (p.getVector3fMap() - centroid).norm());
  return radius;
}

/// ESF's own condition on a triple, by Heron's formula; NaN fails.
bool spansTriangle(const pcl::PointXYZ& p, const pcl::PointXYZ& q, const pcl::PointXYZ& r, float scale) {
  const float a = distance(p, q) * scale, b = distance(q, r) * scale, c = distance(r, p) * scale;
  const float s = (a + b + c) / 2;
  return s * (s - a) * (s - b) * (s - c) > kLeastArea;
}

/// At least an eighth of the triples of points that are far apart in the cloud's order.
bool hasTriangles(const Cloud& cloud) {
  constexpr std::size_t kTriples = 64;
  if (cloud.size() < 3) return false;
  const float scale = kGridRadius / radiusOf(cloud);
  const std::size_t n = cloud.size();
  std::size_t good = 0;
  for (std::size_t i = 0; i < kTriples; ++i) {
    const std::size_t first = i * n / kTriples;
    good += spansTriangle(cloud[first], cloud[(first + n / 3) % n], cloud[(first + 2 * n / 3) % n], scale);
  }
  return good * 8 >= kTriples;
}

class PclEsf : public Esf {
 public:
  bool accept(Span<const PointUm> points) override {
    cloud_->clear();
    for (const PointUm& p : points) {
      cloud_->push_back(
          {static_cast<float>(p.x * 1e-6), static_cast<float>(p.y * 1e-6), static_cast<float>(p.z * 1e-6)});
    }
    return hasTriangles(*cloud_);
  }
  const std::vector<float>& describe() override {
    esf_.setInputCloud(cloud_);
    esf_.compute(output_);
    std::copy(output_[0].histogram, output_[0].histogram + kEsfBins, bins_.begin());
    return bins_;
  }

 private:
  pcl::ESFEstimation<pcl::PointXYZ> esf_;
  Cloud::Ptr cloud_{new Cloud};
  pcl::PointCloud<pcl::ESFSignature640> output_;
  std::vector<float> bins_ = std::vector<float>(kEsfBins);
};

}  // namespace

std::unique_ptr<Esf> makeEsf() { return std::make_unique<PclEsf>(); }

}  // namespace voxid::cli
