// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/segmenter.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "box.h"
#include "components.h"
#include "floors.h"
#include "inverse_depth.h"
#include "join.h"
#include "plan.h"
#include "plane.h"
#include "rim.h"
#include "split.h"

namespace voxid {
namespace {

constexpr int kLongestSide_px = 8192;  // keeps the plane's sums within 64 bits
constexpr std::int64_t kMostPixels = 1 << 24;
constexpr std::int64_t kReferencePixels = 640 * 480;  // at which pixel counts are given
constexpr std::size_t kMostClusters = 255;            // the parameter's upper limit
constexpr std::size_t kMostLeftOut = 64;              // that are told one by one
constexpr std::size_t kOutlineProbes = 64;            // points of a cluster that are compared with the outline
constexpr std::size_t kMeasuredPixels = 1 << 15;      // of all clusters; where there are more, rows are left out

bool usable(const DepthView& depth) {
  if (depth.empty() || !depth.camera.valid()) return false;
  if (depth.width_px > kLongestSide_px || depth.height_px > kLongestSide_px) return false;
  if (static_cast<std::int64_t>(depth.width_px) * depth.height_px > kMostPixels) return false;
  const std::size_t pixel_bytes = depth.unit == DepthUnit::MillimetreU16 ? 2 : 4;
  return depth.row_bytes >= pixel_bytes * static_cast<std::size_t>(depth.width_px);
}

/// A pixel count given for 640 x 480, for this image.
std::size_t scaled(int pixels, const InverseDepth& inverse) {
  return static_cast<std::size_t>(pixels * static_cast<std::int64_t>(inverse.values.size()) / kReferencePixels);
}

Upward upwardOf(const SegmentParams& params, const std::optional<Eigen::Vector3f>& up) {
  constexpr int kKnownUpTilt_deg = 30;  // a mount's and a table's own tilt are less, a wall's is 90
  if (!up) return {{0, -1, 0}, params.max_tilt_deg};
  return {up->cast<double>(), std::min(params.max_tilt_deg, kKnownUpTilt_deg)};
}

/// Of the smallest rectangle around the points whose sides are parallel to the axes.
std::array<Point2, 4> cornersAround(Span<const Point2> points) {
  Point2 low = points[0], high = points[0];
  for (const Point2& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  return {low, {high.x, low.y}, high, {low.x, high.y}};
}

}  // namespace

struct Segmenter::Workspace {
  InverseDepth inverse;
  PlaneFinder plane_finder;
  PlaneSums sums;
  Rays rays;
  Plan plan;
  PlanRays plan_rays;
  Outline outline;
  Components components;
  FloorFinder floors;
  Splitter splitter;
  Joiner joiner;
  RimGrower rim;
  BoxFitter boxes;
  std::vector<Run> runs;  ///< of the regions
  std::vector<Region> regions;
  std::vector<Point2> probes;  ///< feet of a region's points
  std::vector<LeftOut> left_out;
  std::vector<std::uint32_t> pixels;  ///< of the clusters; as long as it ever had to be
  std::vector<Cluster> clusters;
  Scene scene;

  void segment(const DepthView& depth, const SegmentParams& params, const std::optional<Eigen::Vector3f>& up);
  void reserve(int width_px, int height_px);
  bool findTable(const DepthView& depth, const SegmentParams& params, const std::optional<Eigen::Vector3f>& up);
  void findClusters(const DepthView& depth, const SegmentParams& params);
  void drop(DropReason reason, const Region& gone);
  void findParts(const Surface& surface, const Camera& camera, const SegmentParams& params);
  void takeRegions(const Surface& surface, const SegmentParams& params);
  void probe(const Surface& surface, const Region& region);
  int shareInside_percent(const Surface& surface, const Region& region, std::int32_t margin_um);
  void keep(const Region& region, std::size_t most);
  void sortRegions();
  void measure(const Surface& surface);
};

/// All memory that an image of this size can need, whatever it shows.
void Segmenter::Workspace::reserve(int width_px, int height_px) {
  const std::size_t count = static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px);
  inverse.values.reserve(count);
  plane_finder.reserve(width_px, height_px);
  sums.reserve(width_px, height_px);
  rays.reserve(width_px, height_px);
  plan_rays.reserve(width_px, height_px);
  outline.reserve(height_px);
  components.reserve(count, width_px);
  floors.reserve(count, width_px, height_px);
  splitter.reserve(width_px, height_px);
  joiner.reserve(count);
  rim.reserve(count, width_px, height_px);
  boxes.reserve(count);
  runs.reserve(count);
  regions.reserve(kMostClusters);
  pixels.reserve(count);
  probes.reserve(2 * kOutlineProbes);
  clusters.reserve(kMostClusters);
  left_out.reserve(kMostLeftOut);
}

void Segmenter::Workspace::segment(const DepthView& depth, const SegmentParams& params,
                                   const std::optional<Eigen::Vector3f>& up) {
  scene = Scene{};
  clusters.clear();
  left_out.clear();
  if (!usable(depth)) {
    scene.status = SceneStatus::BadInput;
    return;
  }
  reserve(depth.width_px, depth.height_px);
  invert(depth, params.min_depth_mm, params.max_depth_mm, inverse);
  scene.valid_pixels = inverse.valid;
  scene.status = SceneStatus::NoDepth;
  if (inverse.valid == 0) return;
  scene.status = SceneStatus::NoTable;
  if (!findTable(depth, params, up)) return;
  findClusters(depth, params);
  scene.clusters = {clusters.data(), clusters.size()};
  scene.left_out = {left_out.data(), left_out.size()};
  scene.status = clusters.empty() ? SceneStatus::EmptyTable : SceneStatus::Ok;
}

bool Segmenter::Workspace::findTable(const DepthView& depth, const SegmentParams& params,
                                     const std::optional<Eigen::Vector3f>& up) {
  InversePlane plane;
  if (!plane_finder.find(inverse, depth.camera, params, upwardOf(params, up), plane, sums)) return false;
  const MetricPlane metric = metricOf(plane, depth.camera);
  const PlaneSupport support = supportOf(inverse, sums, fineTolerance(params), metric.distance_m);
  if (support.inliers < std::max<std::size_t>(scaled(params.min_table_pixels, inverse), 3)) return false;
  rays.fill(depth.camera, depth.width_px, depth.height_px);
  plan.set(metric);
  plan_rays.fill(rays, plan);
  if (!outline.fill(inverse, sums, fineTolerance(params), rays, plan)) return false;
  scene.table.normal = metric.normal.cast<float>();
  scene.table.distance_m = static_cast<float>(metric.distance_m);
  scene.table.outline_m = outline.points_m();
  scene.table.inliers = support.inliers;
  scene.table.residual_mm = static_cast<float>(support.residual_mm);
  return true;
}

/// The feet on the table of evenly spaced points.
void Segmenter::Workspace::probe(const Surface& surface, const Region& region) {
  const std::uint32_t step = std::max<std::uint32_t>(1, region.pixels / kOutlineProbes);
  probes.clear();
  std::uint32_t next = step / 2;  // counted from the run's first pixel
  for (const Run& run : region.runs) {
    const int v = surface.row(run.begin), u = static_cast<int>(run.begin) - v * inverse.width_px;
    for (; next < run.size(); next += step)
      probes.push_back(plan.project(surface.pointAt(u + static_cast<int>(next), v, run.begin + next)));
    next -= run.size();
  }
}

/// Share of points whose feet on the table lie inside the widened outline, from evenly spaced ones. The outline is
/// convex: if it holds the corners of a rectangle around the feet, it holds them all.
int Segmenter::Workspace::shareInside_percent(const Surface& surface, const Region& region, std::int32_t margin_um) {
  probe(surface, region);
  const auto isInside = [&](const Point2& foot) { return outline.contains(foot, margin_um); };
  const auto corners = cornersAround({probes.data(), probes.size()});
  if (std::all_of(corners.begin(), corners.end(), isInside)) return 100;
  return static_cast<int>(100 * std::count_if(probes.begin(), probes.end(), isInside) /
                          static_cast<std::ptrdiff_t>(probes.size()));
}

void Segmenter::Workspace::drop(DropReason reason, const Region& gone) {
  ++scene.dropped[static_cast<std::size_t>(reason)];
  const LeftOut cluster{reason, gone.pixels, pixelBoxOf(gone.runs, inverse.width_px)};
  if (left_out.size() < kMostLeftOut) {
    left_out.push_back(cluster);
    return;
  }
  const auto smallest = std::min_element(left_out.begin(), left_out.end(),
                                         [](const LeftOut& a, const LeftOut& b) { return a.pixels < b.pixels; });
  if (smallest->pixels < cluster.pixels) *smallest = cluster;
}

/// Past the limit the smallest makes room; of equal ones the later. The limit bounds the work a group costs.
void Segmenter::Workspace::keep(const Region& region, std::size_t most) {
  const auto goesFirst = [](const Region& a, const Region& b) {
    return a.pixels != b.pixels ? a.pixels < b.pixels : a.runs[0].begin > b.runs[0].begin;
  };
  if (regions.size() >= most) {
    const auto smallest = std::min_element(regions.begin(), regions.end(), goesFirst);
    const Region& gone = goesFirst(region, *smallest) ? region : *smallest;
    drop(DropReason::TooMany, gone);
    if (&gone == &region) return;
    regions.erase(smallest);
  }
  regions.push_back(region);
}

void Segmenter::Workspace::findParts(const Surface& surface, const Camera& camera, const SegmentParams& params) {
  components.find(surface, params);
  floors.addFloors(surface, params, components);
  const auto atLeastOne = [](std::size_t fewest) { return std::max<std::size_t>(fewest, 1); };
  if (params.split) {
    splitter.split(surface, camera, atLeastOne(scaled(params.split_min_pixels, inverse)), params, components);
  }
  if (params.join) joiner.join(surface, camera, atLeastOne(scaled(params.min_cluster_pixels, inverse) / 5), components);
}

/// Groups of parts that are large enough and stand on the table.
void Segmenter::Workspace::takeRegions(const Surface& surface, const SegmentParams& params) {
  constexpr int kOnTheTable_percent = 30, kMostlyInside_percent = 95;
  const std::size_t fewest = std::max<std::size_t>(scaled(params.min_cluster_pixels, inverse), 1);
  const auto most = std::min(static_cast<std::size_t>(std::max(params.max_clusters, 1)), kMostClusters);
  runs.clear();
  regions.clear();
  for (std::size_t part = 0; part < components.parts(); ++part) {
    if (!components.firstOfGroup(part)) continue;
    const std::size_t first = runs.size();
    components.collect(part, runs);
    Region region{{runs.data() + first, runs.size() - first}, components.pixelsInGroup(part)};
    if (region.pixels < fewest) {
      drop(DropReason::TooFewPoints, region);
      runs.resize(first);
      continue;
    }
    const int inside_percent = shareInside_percent(surface, region, params.outline_margin_mm * 1000);
    region.truncated = inside_percent < kMostlyInside_percent;
    if (inside_percent < kOnTheTable_percent) {
      drop(DropReason::OutsideOutline, region);
    } else {
      keep(region, most);
    }
  }
}

/// Each region becomes a cluster.
void Segmenter::Workspace::measure(const Surface& surface) {
  const auto count = std::accumulate(regions.begin(), regions.end(), std::size_t{0},
                                     [](std::size_t sum, const Region& region) { return sum + region.pixels; });
  const int row_step = 1 + static_cast<int>(count / kMeasuredPixels);
  pixels.resize(std::max(pixels.size(), count));
  std::uint32_t* first = pixels.data();
  for (const Region& region : regions) {
    Cluster cluster;
    cluster.id = static_cast<int>(clusters.size()) + 1;
    cluster.truncated = region.truncated;
    cluster.pixels = {first, region.pixels};
    first = listPixels(region.runs, first);
    boxes.fit(surface, region, row_step, cluster);
    clusters.push_back(cluster);
  }
}

/// By first pixels.
void Segmenter::Workspace::sortRegions() {
  std::sort(regions.begin(), regions.end(),
            [](const Region& a, const Region& b) { return a.runs[0].begin < b.runs[0].begin; });
}

void Segmenter::Workspace::findClusters(const DepthView& depth, const SegmentParams& params) {
  const Surface surface{inverse, sums, rays, plan, plan_rays, scene.table.distance_m};
  findParts(surface, depth.camera, params);
  takeRegions(surface, params);
  sortRegions();
  if (params.rim) {
    rim.grow(surface, params, regions);
    sortRegions();  // a rim may begin before its object did
  }
  measure(surface);
}

Segmenter::Segmenter() : workspace_(std::make_unique<Workspace>()) {}
Segmenter::~Segmenter() = default;
Segmenter::Segmenter(Segmenter&&) noexcept = default;
Segmenter& Segmenter::operator=(Segmenter&&) noexcept = default;

const Scene& Segmenter::segment(const DepthView& depth, const SegmentParams& params,
                                const std::optional<Eigen::Vector3f>& up) {
  workspace_->segment(depth, params, up);
  return workspace_->scene;
}

}  // namespace voxid
