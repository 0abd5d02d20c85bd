// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/pcl/shape_distribution.h"

#include <gtest/gtest.h>
#include <pcl/features/esf.h>

#include <limits>

#include "core/clouds.h"

namespace voxid {
namespace {

using Signatures = pcl::PointCloud<pcl::Histogram<kDescriptorBytes>>;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

template <typename PointT = pcl::PointXYZ>
typename pcl::PointCloud<PointT>::Ptr toPcl(const test::Cloud& points) {
  typename pcl::PointCloud<PointT>::Ptr cloud(new pcl::PointCloud<PointT>);
  for (const PointUm& p : points) {
    PointT point;
    point.x = static_cast<float>(p.x * 1e-6);
    point.y = static_cast<float>(p.y * 1e-6);
    point.z = static_cast<float>(p.z * 1e-6);
    cloud->push_back(point);
  }
  return cloud;
}

/// Calls an estimation as its users do.
template <typename Estimation, typename Cloud, typename Output>
void estimate(Estimation& estimation, const Cloud& cloud, Output& output) {
  estimation.setInputCloud(cloud);
  estimation.compute(output);
}

void expectBins(const Signatures& signatures, const Descriptor& bins) {
  ASSERT_EQ(signatures.size(), 1u);
  for (int i = 0; i < kDescriptorBytes; ++i) {
    ASSERT_EQ(signatures[0].histogram[i], bins[static_cast<std::size_t>(i)]) << "bin " << i;
  }
}

// Floats keep micrometres below 8.3 m to half a micrometre, so the points are exactly those of the core.
TEST(ShapeDistribution, IsTheCoresDescriptorForAnyPointType) {
  Describer describer;
  for (const test::Cloud& cloud : {test::mug(), test::boxCorner(), test::sphereCap(), test::ruler()}) {
    const Described expected = describer.describe(test::spanOf(cloud));
    Signatures plain, coloured;
    ShapeDistributionEstimation<pcl::PointXYZ> estimation;
    estimate(estimation, toPcl(cloud), plain);
    expectBins(plain, expected.bins);
    ShapeDistributionEstimation<pcl::PointXYZRGBA> of_coloured;
    estimate(of_coloured, toPcl<pcl::PointXYZRGBA>(cloud), coloured);
    expectBins(coloured, expected.bins);
    EXPECT_EQ(estimation.getStatus(), DescribeStatus::Ok);
  }
}

TEST(ShapeDistribution, IsCalledLikeEsfAndAnswersInTheSameShape) {
  const auto cloud = toPcl(test::mug());
  cloud->header.frame_id = "camera";
  cloud->header.stamp = 1234;
  pcl::ESFEstimation<pcl::PointXYZ> esf;
  pcl::PointCloud<pcl::ESFSignature640> theirs;
  estimate(esf, cloud, theirs);
  ShapeDistributionEstimation<pcl::PointXYZ> ours;
  Signatures signature;
  estimate(ours, cloud, signature);
  ASSERT_EQ(theirs.size(), 1u);
  EXPECT_EQ(signature.size(), theirs.size());
  EXPECT_EQ(signature.width, theirs.width);
  EXPECT_EQ(signature.height, theirs.height);
  EXPECT_EQ(signature.header.frame_id, theirs.header.frame_id);
  EXPECT_EQ(signature.header.stamp, theirs.header.stamp);
}

TEST(ShapeDistribution, WorksThroughTheBaseClass) {
  ShapeDistributionEstimation<pcl::PointXYZ> estimation;
  pcl::Feature<pcl::PointXYZ, pcl::Histogram<kDescriptorBytes>>& base = estimation;
  Signatures direct, through_base;
  estimate(estimation, toPcl(test::mug()), direct);
  base.compute(through_base);
  ASSERT_EQ(through_base.size(), 1u);
  EXPECT_TRUE(std::equal(direct[0].histogram, direct[0].histogram + kDescriptorBytes, through_base[0].histogram));
}

TEST(ShapeDistribution, HonoursIndices) {
  test::Cloud both = test::mug();
  const std::size_t mugs = both.size();
  for (PointUm p : test::ruler()) both.push_back(p);
  pcl::IndicesPtr indices(new pcl::Indices);
  for (std::size_t i = 0; i < mugs; ++i) indices->push_back(static_cast<int>(i));
  ShapeDistributionEstimation<pcl::PointXYZ> estimation;
  estimation.setIndices(indices);
  Signatures signature;
  estimate(estimation, toPcl(both), signature);
  expectBins(signature, Describer().describe(test::spanOf(test::mug())).bins);
}

// ESF never returns from two points, or from fifty equal ones.
TEST(ShapeDistribution, AnswersDegenerateCloudsWithAStatus) {
  ShapeDistributionEstimation<pcl::PointXYZ> estimation;
  Signatures signature;
  estimate(estimation, toPcl({}), signature);
  EXPECT_TRUE(signature.empty());
  EXPECT_EQ(estimation.getStatus(), DescribeStatus::Empty);
  estimate(estimation, toPcl(test::Cloud(50, PointUm{1, 2, 3000})), signature);
  EXPECT_TRUE(signature.empty());
  EXPECT_EQ(estimation.getStatus(), DescribeStatus::Degenerate);
  const test::Cloud two{{0, 0, 1000}, {5000, 0, 1000}};
  estimate(estimation, toPcl(two), signature);
  expectBins(signature, Describer().describe(test::spanOf(two)).bins);
}

TEST(ShapeDistribution, AnswersLinesPlanesAndAMillionPointsAsTheCoreDoes) {
  test::Cloud line, plane, many;
  for (std::int32_t i = 0; i < 300; ++i) {
    line.push_back({1000 * i, 2000 * i, 3000 * i});
    plane.push_back({i % 20 * 1000, i / 20 * 1000, 1000000});
  }
  for (std::int32_t i = 0; i < 1000000; ++i) many.push_back({i % 1000 * 100, i / 1000 * 100, 900000 + i % 7 * 1000});
  for (const test::Cloud& cloud : {test::Cloud{{1, 2, 3}, {500, 2, 3}, {1, 900, 3}}, line, plane, many}) {
    ShapeDistributionEstimation<pcl::PointXYZ> estimation;
    Signatures signature;
    estimate(estimation, toPcl(cloud), signature);
    expectBins(signature, Describer().describe(test::spanOf(cloud)).bins);
  }
}

TEST(ShapeDistribution, LeavesOutEveryNumberThatIsNoPlace) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity(), kMost = std::numeric_limits<float>::max();
  ShapeDistributionEstimation<pcl::PointXYZ> estimation;
  Signatures signature;
  const auto mug = toPcl(test::mug());
  for (const float bad : {kNaN, kInfinity, -kInfinity, 1e30f, -1e30f, kMost, -kMost, 2147.1f, -2147.1f}) {
    for (int axis = 0; axis < 3; ++axis) {
      pcl::PointXYZ point(0.1f, 0.2f, 1);
      point.data[axis] = bad;
      const pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
      cloud->insert(cloud->end(), 1000, point);
      cloud->is_dense = false;
      estimate(estimation, cloud, signature);
      EXPECT_EQ(estimation.getStatus(), DescribeStatus::Empty) << bad;
      EXPECT_TRUE(signature.empty());
      cloud->insert(cloud->end(), mug->begin(), mug->end());
      estimate(estimation, cloud, signature);
      expectBins(signature, Describer().describe(test::spanOf(test::mug())).bins);
    }
  }
}

/// The farthest places that are still described, as micrometres near the limits of an int32.
TEST(ShapeDistribution, DescribesCloudsAtTheLimits) {
  constexpr float kFarthest_m = 2147, kSmallest = std::numeric_limits<float>::denorm_min();
  const std::int32_t farthest_um = 2147000000;
  pcl::PointCloud<pcl::PointXYZ>::Ptr corners(new pcl::PointCloud<pcl::PointXYZ>),
      dust(new pcl::PointCloud<pcl::PointXYZ>);
  test::Cloud expected;
  for (int i = 0; i < 8; ++i) {
    const auto sign = [i](int axis) { return (i >> axis & 1) ? 1 : -1; };
    corners->push_back({sign(0) * kFarthest_m, sign(1) * kFarthest_m, sign(2) * kFarthest_m});
    expected.push_back({sign(0) * farthest_um, sign(1) * farthest_um, sign(2) * farthest_um});
    dust->push_back({sign(0) * kSmallest, sign(1) * kSmallest, sign(2) * kSmallest});
  }
  ShapeDistributionEstimation<pcl::PointXYZ> estimation;
  Signatures signature;
  estimate(estimation, corners, signature);
  const Described described = Describer().describe(test::spanOf(expected));
  ASSERT_EQ(described.status, DescribeStatus::Ok);
  expectBins(signature, described.bins);
  estimate(estimation, dust, signature);
  EXPECT_EQ(estimation.getStatus(), DescribeStatus::Degenerate) << "one place, to a micrometre";
}

TEST(ShapeDistribution, NoIndicesAreNoPoints) {
  ShapeDistributionEstimation<pcl::PointXYZ> estimation;
  estimation.setIndices(pcl::IndicesPtr(new pcl::Indices));
  Signatures signature;
  estimate(estimation, toPcl(test::mug()), signature);
  EXPECT_TRUE(signature.empty());
  EXPECT_EQ(estimation.getStatus(), DescribeStatus::Empty);
}

TEST(ShapeDistribution, TakesTheParametersOfTheDescriptor) {
  const DescriptorParams params{4000, 7};
  ShapeDistributionEstimation<pcl::PointXYZ> estimation(params);
  Signatures signature;
  estimate(estimation, toPcl(test::mug()), signature);
  expectBins(signature, Describer(params).describe(test::spanOf(test::mug())).bins);
}

}  // namespace
}  // namespace voxid
