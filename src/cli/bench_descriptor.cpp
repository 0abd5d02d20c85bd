// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>

#include "bench.h"
#include "compare_codes.h"
#include "esf.h"
#include "voxid/core/descriptor.h"

namespace voxid::cli {
namespace {

constexpr std::size_t kMostViews = 100;                   // ESF takes some 15 ms each
constexpr std::size_t kPoints[] = {0, 1300, 3000, 6000};  // 0: as they are; 1,300 to 6,000 are the paper's
constexpr int kRepetitions = 3;                           // of ours; all count

using Pixels = std::vector<std::uint32_t>;

struct Work {
  const BenchView* view;
  Pixels pixels;
};

/// `points` of the pixels, evenly.
Pixels thinned(const Pixels& pixels, std::size_t points) {
  Pixels kept;
  for (std::size_t i = 0; i < points; ++i) kept.push_back(pixels[i * pixels.size() / points]);
  return kept;
}

/// The views of at least `points` points, thinned to as many; 0: all, as they are. At most kMostViews, evenly.
std::vector<Work> workOf(const std::vector<BenchView>& views, std::size_t points) {
  std::vector<Work> all;
  for (const BenchView& view : views) {
    if (view.pixels.size() >= points) all.push_back({&view, points == 0 ? view.pixels : thinned(view.pixels, points)});
  }
  if (all.size() <= kMostViews) return all;
  std::vector<Work> some;
  for (std::size_t i = 0; i < kMostViews; ++i) some.push_back(all[i * all.size() / kMostViews]);
  return some;
}

struct Times {
  std::vector<double> ours_us, esf_us, points;
};

/// Both on every view, in turn, so that what else the machine does meets both.
Times timesOf(const std::vector<Work>& work, Encoder& encoder, std::vector<std::uint8_t>& code, Esf& esf) {
  Times times;
  for (const Work& w : work) {
    const DepthView depth = w.view->file.view();
    const std::vector<PointUm> points = pointsOf(depth, {w.pixels.data(), w.pixels.size()});
    if (!esf.accept({points.data(), points.size()})) continue;
    for (int i = 0; i < kRepetitions; ++i) {
      times.ours_us.push_back(usOf([&] { encoder.encode(depth, {w.pixels.data(), w.pixels.size()}, code.data()); }));
    }
    times.esf_us.push_back(usOf([&] { esf.describe(); }));
    times.points.push_back(static_cast<double>(points.size()));
  }
  return times;
}

std::vector<Json> rowsOf(const std::string& name, const Profile& profile, const std::vector<BenchView>& views) {
  const auto encoder = makeEncoder(profile);
  std::vector<std::uint8_t> code(profile.codeBytes());
  const std::unique_ptr<Esf> esf = makeEsf();
  std::vector<Json> rows;
  for (const std::size_t points : kPoints) {
    const Times times = timesOf(workOf(views, points), *encoder, code, *esf);
    if (times.ours_us.empty()) {
      std::fprintf(stderr, "voxid: no view has %zu points for both descriptors, its row is left out\n", points);
      continue;
    }
    Json row = benchRow(points == 0 ? name : name + "/" + std::to_string(points), times.ours_us);
    comparePeer(row, "pcl::ESFEstimation", quantile(times.esf_us, 0.5));
    row["points"] = quantile(times.points, 0.5);
    row["objects"] = times.esf_us.size();
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

std::vector<Json> benchDescriptors(const Profile& profile, const std::vector<BenchView>& views) {
  std::vector<Json> rows = rowsOf("descriptor/paper", {}, views);
  if (!profile.projection) return rows;
  for (Json& row : rowsOf("descriptor/default", profile, views)) rows.push_back(std::move(row));
  return rows;
}

}  // namespace voxid::cli
