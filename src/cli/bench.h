// SPDX-License-Identifier: BSD-3-Clause
// Measurements of `voxid bench`. All times are CPU times of the calling thread, so that a busy machine changes them
// less.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cpu_time.h"
#include "depth_file.h"
#include "scene_json.h"
#include "voxid/core/index.h"

namespace voxid::cli {

/// One query's picture.
struct BenchView {
  DepthFile file;
  std::vector<std::uint32_t> pixels;  ///< those with depth
  std::string category;
};

/// So many decimals as a measurement is worth.
double rounded(double x, int decimals);

/// Share 0 to 1 of the sorted samples that lie below; 0.5 is the median. 0 without samples.
double quantile(std::vector<double> samples, double share);

/// A row: name, median_us, p99_us; peer, peer_median_us, ratio (peer over ours), null where there is none.
Json benchRow(const std::string& name, const std::vector<double>& us);
void comparePeer(Json& row, const std::string& peer, double peer_median_us);

/// descriptor/paper beside pcl::ESFEstimation on the same points: the views as they are, and those that have them
/// thinned to 1,300, 3,000 and 6,000 points.
std::vector<Json> benchDescriptors(const Profile& profile, const std::vector<BenchView>& views);

/// segment/vga and segment/qvga (plane and components), segment/full (all steps) over at most `most` scenes of FOLDER
/// (evenly chosen, 640 x 480), each 20 times, beside PCL's chain on the same frames.
Result<std::vector<Json>> benchSegmentation(const std::string& folder, int most);

/// The row chain: the nodelets on FOLDER's depth images, replayed at 30 frames a second for so long. Needs a build with
/// ROS.
struct ChainAlignment {
  std::string mode = "off";  ///< off, selected, all
  std::string models;        ///< folder; empty with off
};
Result<Json> benchChain(const std::string& folder, const std::string& index, int seconds,
                        const ChainAlignment& alignment);

/// The searches of an index and of other libraries over its codes.
std::vector<Json> benchQueries(const std::shared_ptr<const Index>& index, const std::vector<BenchView>& views);

}  // namespace voxid::cli
