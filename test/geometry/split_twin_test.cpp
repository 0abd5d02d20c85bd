// SPDX-License-Identifier: BSD-3-Clause
// Splits of noisy pictures, beside the twin that looks at one cell after the other.
#include <gtest/gtest.h>

#include <random>
#include <set>
#include <vector>

#include "components.h"
#include "geometry/rendered.h"
#include "geometry/slow_splitter.h"
#include "plane.h"
#include "split.h"

namespace voxid {
namespace {

using test::Image;
using Parts = std::set<std::vector<std::uint32_t>>;

/// A millimetre or two of noise, and pixels without depth.
Image noisy(Image image) {
  std::mt19937 random(5);
  for (std::uint16_t& depth : image.millimetres) {
    const unsigned choice = random() % 512;
    if (depth > 0) depth = choice == 0 ? 0 : static_cast<std::uint16_t>(depth + choice % 4);
  }
  return image;
}

/// What the steps before the split have made of a picture.
struct Prepared {
  InverseDepth inverse;
  PlaneSums sums;
  Rays rays;
  Plan plan;
  PlanRays plan_rays;
  double distance_m = 0;

  Prepared(const Image& image, const SegmentParams& params) {
    invert(image.view(), params.min_depth_mm, params.max_depth_mm, inverse);
    PlaneFinder finder;
    finder.reserve(image.width_px, image.height_px);
    InversePlane plane;
    EXPECT_TRUE(finder.find(inverse, image.camera, params, Upward{}, plane, sums));
    const MetricPlane metric = metricOf(plane, image.camera);
    distance_m = metric.distance_m;
    rays.fill(image.camera, image.width_px, image.height_px);
    plan.set(metric);
    plan_rays.fill(rays, plan);
  }
  Surface surface() const { return {inverse, sums, rays, plan, plan_rays, distance_m}; }
};

template <typename AnySplitter>
Parts partsOf(const Image& image, const SegmentParams& params, AnySplitter& splitter) {
  const Prepared prepared(image, params);
  Components components;
  components.reserve(image.millimetres.size(), image.width_px);
  components.find(prepared.surface(), params);
  const int fewest = params.split_min_pixels * image.width_px * image.height_px / (640 * 480);
  splitter.split(prepared.surface(), image.camera, static_cast<std::size_t>(fewest), params, components);
  Parts parts;
  for (std::size_t part = 0; part < components.parts(); ++part) {
    std::vector<Run> runs;
    components.collect(part, runs);
    std::vector<std::uint32_t> pixels(components.pixelsIn(part));
    listPixels({runs.data(), runs.size()}, pixels.data());
    parts.insert(pixels);
  }
  return parts;
}

/// The number of parts, the same by both.
std::size_t compareSplits(const Image& image, const SegmentParams& params) {
  Splitter splitter;
  splitter.reserve(image.width_px, image.height_px);
  test::SlowSplitter twin(image.width_px);
  const Parts parts = partsOf(image, params, splitter);
  EXPECT_EQ(parts, partsOf(image, params, twin));
  return parts.size();
}

TEST(SplitTwin, CutsTheSamePieces) {
  for (const int width_px : {640, 320, 200}) {
    test::View view;
    view.width_px = width_px;
    view.height_px = width_px * 3 / 4;
    const Image image = noisy(render(view,
                                     {{0, 0.55, 0.16, 0.1, 0.06},
                                      {0, 0.65, 0.16, 0.1, 0.16},
                                      {0.3, 0.6, 0.2, 0.2, 0.08},
                                      {0.3, 0.62, 0.1, 0.1, 0.2, 30, 0.08},
                                      {-0.3, 0.5, 0.1, 0.1, 0.12, 20},
                                      {-0.3, 0.6, 0.1, 0.1, 0.08, 20}},
                                     {{0, 0.9, 0.06, 0.14}}));
    EXPECT_GT(compareSplits(image, {}), 5u);
    for (const int angle_deg : {10, 60}) {
      SegmentParams params;
      params.split_angle_deg = angle_deg;
      compareSplits(image, params);
    }
    SegmentParams many;
    many.split_min_pixels = 60;
    many.split_step_mm = 3;
    many.split_share_percent = 10;
    EXPECT_GT(compareSplits(image, many), compareSplits(image, {}));
  }
}

}  // namespace
}  // namespace voxid
