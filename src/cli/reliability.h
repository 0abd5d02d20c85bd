// SPDX-License-Identifier: BSD-3-Clause
// How far scores may be trusted: calibration, ranking, and what share may be answered at a given risk.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace voxid::cli {

/// An answer with the chance that it was said to be right.
struct Judged {
  double said = 0;  ///< 0 to 1
  bool right = false;
};

/// A tenth of the answers, those of like score: what was said and what was so, means.
struct Bin {
  double said = 0, seen = 0;
  std::size_t answers = 0;
};

/// Ten bins of equal count (within one), by rising score; fewer if there are fewer answers.
std::vector<Bin> reliabilityOf(const std::vector<Judged>& answers);

/// Expected calibration error: mean of |said - seen| over the bins, each as often as it has answers. 0 to 1.
double calibrationError(const std::vector<Bin>& bins);

/// The chance that one of `high` is above one of `low`, equal ones half. 0.5 if one of them is empty.
double areaUnderCurve(const std::vector<double>& high, const std::vector<double>& low);
/// Of right answers against wrong ones.
double areaUnderCurve(const std::vector<Judged>& answers);

/// What share of the answers can be given, and with what share of those wrong, for each score as the least accepted
/// one; by rising coverage.
struct RiskPoint {
  double coverage = 0, risk = 0;
};
std::vector<RiskPoint> riskCoverage(std::vector<Judged> answers);

/// The largest share with at most `risk` wrong; 0 if there is none.
double coverageAt(const std::vector<RiskPoint>& curve, double risk);

/// Left the reliability diagram with a dot a bin, right the risk over the coverage: all queries in blue, and in orange
/// with categories left out, where an answer to a stranger is wrong.
cv::Mat drawReliability(const std::vector<Bin>& bins, const std::vector<RiskPoint>& closed,
                        const std::vector<RiskPoint>& open);

}  // namespace voxid::cli
