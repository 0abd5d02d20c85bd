// SPDX-License-Identifier: BSD-3-Clause
#include "../pcl_segmentation.h"

#include <pcl/common/io.h>
#include <pcl/filters/project_inliers.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/extract_polygonal_prism_data.h>
#include <pcl/segmentation/sac_segmentation.h>
#include <pcl/surface/convex_hull.h>

#include <algorithm>

#include "../cpu_time.h"
#include "voxid/geometry/segment_params.h"

namespace voxid::cli {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr double kTable_m = 0.010, kLowest_m = 0.008, kHighest_m = 1, kGap_m = 0.015;
constexpr int kDraws = 500;
constexpr int kFewestVoxels = 40;  // 5 mm voxels hold about five pixels of a table-top scene

struct PixelCloud {
  Cloud::Ptr points{new Cloud};
  std::vector<std::uint32_t> pixels;
};

PixelCloud cloudOf(const DepthView& depth) {
  const SegmentParams range;
  PixelCloud cloud;
  for (int v = 0; v < depth.height_px; ++v) {
    for (int u = 0; u < depth.width_px; ++u) {
      const std::int32_t z_um = depth.depthUm(u, v);
      if (z_um < range.min_depth_mm * 1000 || z_um > range.max_depth_mm * 1000) continue;
      const PointUm p = backProject(depth.camera, u, v, z_um);
      cloud.points->emplace_back(static_cast<float>(p.x) * 1e-6f, static_cast<float>(p.y) * 1e-6f,
                                 static_cast<float>(p.z) * 1e-6f);
      cloud.pixels.push_back(static_cast<std::uint32_t>(v * depth.width_px + u));
    }
  }
  return cloud;
}

/// Points above the table, inside its hull.
pcl::PointIndices::Ptr aboveTable(const Cloud::ConstPtr& cloud) {
  pcl::SACSegmentation<pcl::PointXYZ> plane;
  plane.setModelType(pcl::SACMODEL_PLANE);
  plane.setMethodType(pcl::SAC_RANSAC);
  plane.setMaxIterations(kDraws);
  plane.setDistanceThreshold(kTable_m);
  plane.setOptimizeCoefficients(true);
  plane.setInputCloud(cloud);
  const pcl::PointIndices::Ptr table(new pcl::PointIndices), above(new pcl::PointIndices);
  const pcl::ModelCoefficients::Ptr coefficients(new pcl::ModelCoefficients);
  plane.segment(*table, *coefficients);
  if (table->indices.size() < 3) return above;
  // The prism's plane is that of the hull's corners: unprojected they would tilt it by their noise.
  pcl::ProjectInliers<pcl::PointXYZ> projection;
  const Cloud::Ptr projected(new Cloud), outline(new Cloud);
  projection.setModelType(pcl::SACMODEL_PLANE);
  projection.setInputCloud(cloud);
  projection.setIndices(table);
  projection.setModelCoefficients(coefficients);
  projection.filter(*projected);
  pcl::ConvexHull<pcl::PointXYZ> hull;
  hull.setDimension(2);
  hull.setInputCloud(projected);
  hull.reconstruct(*outline);
  if (outline->size() < 3) return above;
  pcl::ExtractPolygonalPrismData<pcl::PointXYZ> prism;
  prism.setInputCloud(cloud);
  prism.setInputPlanarHull(outline);
  prism.setHeightLimits(kLowest_m, kHighest_m);
  prism.setViewPoint(0, 0, 0);
  prism.segment(*above);
  return above;
}

std::vector<pcl::PointIndices> clustersOf(const Cloud::ConstPtr& cloud, int fewest) {
  std::vector<pcl::PointIndices> clusters;
  const pcl::PointIndices::Ptr above = aboveTable(cloud);
  if (above->indices.empty()) return clusters;
  pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setClusterTolerance(kGap_m);
  extraction.setMinClusterSize(fewest);
  extraction.setSearchMethod(tree);
  extraction.setInputCloud(cloud);
  extraction.setIndices(above);
  extraction.extract(clusters);
  return clusters;
}

void addPixels(const PixelCloud& cloud, const std::vector<pcl::PointIndices>& clusters, PclClusters& result) {
  for (const pcl::PointIndices& cluster : clusters) {
    auto& pixels = result.pixels.emplace_back();
    for (const int i : cluster.indices) pixels.push_back(cloud.pixels[static_cast<std::size_t>(i)]);
    std::sort(pixels.begin(), pixels.end());
  }
}

void addPixelsOfVoxels(const PixelCloud& cloud, const pcl::VoxelGrid<pcl::PointXYZ>& grid, std::size_t voxels,
                       const std::vector<pcl::PointIndices>& clusters, PclClusters& result) {
  std::vector<int> cluster_of_voxel(voxels, -1);
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    for (const int voxel : clusters[c].indices) cluster_of_voxel[static_cast<std::size_t>(voxel)] = static_cast<int>(c);
  }
  result.pixels.resize(clusters.size());
  for (std::size_t i = 0; i < cloud.pixels.size(); ++i) {
    const pcl::PointXYZ& p = (*cloud.points)[i];
    const int voxel = grid.getCentroidIndexAt(grid.getGridCoordinates(p.x, p.y, p.z));
    const int cluster = voxel < 0 ? -1 : cluster_of_voxel[static_cast<std::size_t>(voxel)];
    if (cluster >= 0) result.pixels[static_cast<std::size_t>(cluster)].push_back(cloud.pixels[i]);
  }
}

}  // namespace

PclClusters segmentByPcl(const DepthView& depth, int voxel_mm) {
  const PixelCloud cloud = cloudOf(depth);
  PclClusters result;
  if (cloud.points->empty()) return result;
  std::vector<pcl::PointIndices> clusters;
  if (voxel_mm == 0) {
    result.us = usOf([&] { clusters = clustersOf(cloud.points, SegmentParams{}.min_cluster_pixels); });
    addPixels(cloud, clusters, result);
    return result;
  }
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  const Cloud::Ptr voxels(new Cloud);
  const float side_m = static_cast<float>(voxel_mm) * 1e-3f;
  result.us = usOf([&] {
    grid.setLeafSize(side_m, side_m, side_m);
    grid.setSaveLeafLayout(true);
    grid.setInputCloud(cloud.points);
    grid.filter(*voxels);
    clusters = clustersOf(voxels, kFewestVoxels);
  });
  addPixelsOfVoxels(cloud, grid, voxels->size(), clusters, result);
  return result;
}

}  // namespace voxid::cli
