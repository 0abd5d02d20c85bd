// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate.h"

#include <algorithm>

#include "voxid/core/search.h"
#include "voxid/library/index_writer.h"

namespace voxid {
namespace {

constexpr std::size_t kMostSamples = 600, kLeastSamples = 200;

/// Round by round one query of each category, until there are enough.
std::vector<const CalibrationQuery*> spread(const Index& index, const std::vector<CalibrationQuery>& queries) {
  std::vector<std::vector<const CalibrationQuery*>> by_category(index.categories().size);
  for (const CalibrationQuery& query : queries) {
    const std::uint32_t category = index.models()[query.model].category;
    if (!query.code.empty() && index.categories()[category].models >= 2) by_category[category].push_back(&query);
  }
  std::vector<const CalibrationQuery*> chosen;
  std::size_t before = 0;
  for (std::size_t round = 0; chosen.size() < kMostSamples; ++round) {
    for (const auto& list : by_category) {
      if (round < list.size() && chosen.size() < kMostSamples) chosen.push_back(list[round]);
    }
    if (chosen.size() == before) break;
    before = chosen.size();
  }
  return chosen;
}

int binOf(std::uint32_t nearest, std::uint32_t next) {
  if (next == 0) return 0;
  const std::uint64_t bin = std::uint64_t{format::Calibration::kBins} * (next - nearest) / next;
  return static_cast<int>(std::min<std::uint64_t>(bin, format::Calibration::kBins - 1));
}

struct Pool {
  int right, asked, bins;
};

/// right / asked of `a` above that of `b`.
bool higher(const Pool& a, const Pool& b) { return std::int64_t{a.right} * b.asked > std::int64_t{b.right} * a.asked; }

std::vector<Pool> poolViolators(const std::vector<int>& right, const std::vector<int>& asked) {
  std::vector<Pool> pools;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    Pool pool{right[i], asked[i], 1};
    const auto merges = [&] {
      return !pools.empty() && (pool.asked == 0 || pools.back().asked == 0 || higher(pools.back(), pool));
    };
    while (merges()) {
      const Pool& last = pools.back();
      pool = {last.right + pool.right, last.asked + pool.asked, last.bins + pool.bins};
      pools.pop_back();
    }
    pools.push_back(pool);
  }
  return pools;
}

}  // namespace

format::Calibration fitCalibration(const std::vector<int>& right, const std::vector<int>& asked) {
  format::Calibration calibration{};
  int bin = 0, highest = 0;
  for (const Pool& pool : poolViolators(right, asked)) {
    const int share = (1000 * (pool.right + 1) + (pool.asked + 2) / 2) / (pool.asked + 2);
    highest = std::max(highest, share);  // the added answers may turn the order of small pools
    for (int i = 0; i < pool.bins; ++i) calibration.score_permille[bin++] = static_cast<std::uint16_t>(highest);
    calibration.samples += static_cast<std::uint32_t>(pool.asked);
  }
  return calibration;
}

format::Calibration calibrate(std::shared_ptr<const Index> index, const std::vector<CalibrationQuery>& queries) {
  const auto chosen = spread(*index, queries);
  if (chosen.size() < kLeastSamples) return builtInCalibration(index->profile());
  std::vector<int> right(format::Calibration::kBins), asked(format::Calibration::kBins);
  const auto search = makeSearch(index, {});
  for (const CalibrationQuery* const query : chosen) {
    const Nearest& found = search->find(query->code.data(), {{}, query->model});
    if (found.categories.size < 2) continue;
    const int bin = binOf(found.categories[0].distance, found.categories[1].distance);
    const auto categoryOf = [&](std::uint32_t view) { return index->models()[index->modelOf(view)].category; };
    ++asked[bin];
    if (categoryOf(found.categories[0].view) == index->models()[query->model].category) ++right[bin];
  }
  return fitCalibration(right, asked);
}

}  // namespace voxid
