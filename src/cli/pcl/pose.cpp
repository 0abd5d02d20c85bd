// SPDX-License-Identifier: BSD-3-Clause
#include "../pcl_pose.h"

#include <pcl/features/fpfh.h>
#include <pcl/features/normal_3d.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/sample_consensus_prerejective.h>
#include <pcl/search/kdtree.h>

#include <cstdlib>

#include "../cpu_time.h"
#include "voxid/geometry/symmetry.h"

namespace voxid::cli {
namespace {

using Points = pcl::PointCloud<pcl::PointNormal>;
using Features = pcl::PointCloud<pcl::FPFHSignature33>;
using Tree = pcl::search::KdTree<pcl::PointNormal>;

constexpr float kLeaf_m = 0.005f;
constexpr double kNormalRadius_m = 0.01, kFeatureRadius_m = 0.025;
constexpr int kIterations = 50000, kSamples = 3, kRandomness = 5, kIcpSteps = 50;
constexpr float kSimilarity = 0.9f, kInliers = 0.25f;

struct Described {
  Points::Ptr points{new Points};
  Features::Ptr features{new Features};
};

/// The normals face the origin: the camera of what was seen, the centre of a model.
Points::Ptr thinnedWithNormals(const Points::Ptr& cloud) {
  const Points::Ptr thin(new Points);
  pcl::VoxelGrid<pcl::PointNormal> grid;
  grid.setLeafSize(kLeaf_m, kLeaf_m, kLeaf_m);
  grid.setInputCloud(cloud);
  grid.filter(*thin);
  pcl::NormalEstimation<pcl::PointNormal, pcl::PointNormal> normals;
  normals.setRadiusSearch(kNormalRadius_m);
  normals.setInputCloud(thin);
  normals.setSearchMethod(Tree::Ptr(new Tree));
  normals.compute(*thin);
  return thin;
}

Described described(const Points::Ptr& points) {
  Described cloud;
  cloud.points = points;
  pcl::FPFHEstimation<pcl::PointNormal, pcl::PointNormal, pcl::FPFHSignature33> fpfh;
  fpfh.setRadiusSearch(kFeatureRadius_m);
  fpfh.setInputCloud(points);
  fpfh.setInputNormals(points);
  fpfh.setSearchMethod(Tree::Ptr(new Tree));
  fpfh.compute(*cloud.features);
  return cloud;
}

pcl::PointNormal pointAt(const Eigen::Vector3f& metres) {
  pcl::PointNormal point;
  point.getVector3fMap() = metres;
  return point;
}

Described describeModel(const ModelSurface& surface, float scale_mm) {
  constexpr int kSamplesOfSurface = 20000;
  const SurfaceSamples samples(surface, kSamplesOfSurface);
  const Points::Ptr cloud(new Points);
  for (const Eigen::Vector3f& p : samples.points()) cloud->push_back(pointAt(p * scale_mm * 1e-3f));
  const Points::Ptr thin = thinnedWithNormals(cloud);
  for (pcl::PointNormal& point : *thin) point.getNormalVector3fMap() *= -1;  // outwards, as a camera sees it
  return described(thin);
}

Described describeObject(const ObservedObject& object) {
  const Points::Ptr cloud(new Points);
  for (const std::uint32_t pixel : object.pixels) {
    const auto width = static_cast<std::uint32_t>(object.depth.width_px);
    const int u = static_cast<int>(pixel % width), v = static_cast<int>(pixel / width);
    const PointUm p = backProject(object.depth.camera, u, v, object.depth.depthUm(u, v));
    cloud->push_back(
        pointAt(Eigen::Vector3f(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)) * 1e-6f));
  }
  return described(thinnedWithNormals(cloud));
}

/// Model to camera.
std::optional<Eigen::Matrix4f> roughPose(const Described& model, const Described& object) {
  pcl::SampleConsensusPrerejective<pcl::PointNormal, pcl::PointNormal, pcl::FPFHSignature33> search;
  search.setInputSource(model.points);
  search.setSourceFeatures(model.features);
  search.setInputTarget(object.points);
  search.setTargetFeatures(object.features);
  search.setMaximumIterations(kIterations);
  search.setNumberOfSamples(kSamples);
  search.setCorrespondenceRandomness(kRandomness);
  search.setSimilarityThreshold(kSimilarity);
  search.setMaxCorrespondenceDistance(2.5 * static_cast<double>(kLeaf_m));
  search.setInlierFraction(kInliers);
  Points aligned;
  search.align(aligned);
  if (!search.hasConverged()) return std::nullopt;
  return search.getFinalTransformation();
}

/// The object's points all lie on the model, not the other way round.
Eigen::Matrix4f refined(const Eigen::Matrix4f& rough, const Described& model, const Described& object) {
  pcl::IterativeClosestPoint<pcl::PointNormal, pcl::PointNormal> icp;
  icp.setInputSource(object.points);
  icp.setInputTarget(model.points);
  icp.setMaxCorrespondenceDistance(2 * static_cast<double>(kLeaf_m));
  icp.setMaximumIterations(kIcpSteps);
  Points aligned;
  icp.align(aligned, rough.inverse());
  return icp.hasConverged() ? Eigen::Matrix4f(icp.getFinalTransformation().inverse()) : rough;
}

Placement placementOf(const Eigen::Matrix4f& metres, float scale_mm) {
  Placement pose;
  pose.rotation = metres.topLeftCorner<3, 3>();
  pose.translation = metres.topRightCorner<3, 1>() * 1e3f;
  pose.scale = scale_mm;
  return pose;
}

}  // namespace

PclPose poseByPcl(const ObservedObject& object, const ModelSurface& surface, float scale_mm, unsigned seed) {
  const Described model = describeModel(surface, scale_mm);
  std::srand(seed);
  PclPose found;
  found.us = usOf([&] {
    const Described seen = describeObject(object);
    const auto rough = roughPose(model, seen);
    if (rough) found.pose = placementOf(refined(*rough, model, seen), scale_mm);
  });
  return found;
}

}  // namespace voxid::cli
