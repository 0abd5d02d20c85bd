// SPDX-License-Identifier: BSD-3-Clause
#include "esf.h"

#include <pcl/features/esf.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

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

}  // namespace

struct Esf::Estimation {
  pcl::ESFEstimation<pcl::PointXYZ> esf;
  Cloud::Ptr cloud{new Cloud};
  pcl::PointCloud<pcl::ESFSignature640> output;
  std::vector<float> bins = std::vector<float>(kEsfBins);
};

Esf::Esf() : estimation_(std::make_unique<Estimation>()) {}
Esf::~Esf() = default;

bool Esf::accept(Span<const PointUm> points) {
  Cloud& cloud = *estimation_->cloud;
  cloud.clear();
  for (const PointUm& p : points) {
    cloud.push_back({static_cast<float>(p.x * 1e-6), static_cast<float>(p.y * 1e-6), static_cast<float>(p.z * 1e-6)});
  }
  return hasTriangles(cloud);
}

const std::vector<float>& Esf::describe() {
  Estimation& e = *estimation_;
  e.esf.setInputCloud(e.cloud);
  e.esf.compute(e.output);
  std::copy(e.output[0].histogram, e.output[0].histogram + kEsfBins, e.bins.begin());
  return e.bins;
}

float l1OfFloats(const float* a, const float* b, int bins) {
  constexpr int kLanes = 8;  // sums of their own, so that compilers may use vectors
  std::array<float, kLanes> sums{};
  for (int i = 0; i < bins; i += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) sums[lane] += std::abs(a[i + lane] - b[i + lane]);
  }
  return std::accumulate(sums.begin(), sums.end(), 0.0f);
}

}  // namespace voxid::cli
