// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/confidence_learner.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <thread>
#include <vector>

#include "voxid/core/classifier.h"
#include "voxid/core/confidence.h"
#include "voxid/core/search.h"

namespace voxid {
namespace {

constexpr std::uint32_t kLeastModels = 3, kLeastQueries = 200, kMostPerModel = 16, kFewQueries = 400;
constexpr std::uint64_t kMostComparedBytes = 128'000'000'000;
constexpr int kFeatures = format::Confidence::kFeatures, kUnknowns = kFeatures + 1;  // the bias first

// ---- what is asked for -------------------------------------------------------------------------------------------

struct AskedView {
  std::uint32_t model = 0, view = 0;  // number in the index
};

std::vector<std::uint32_t> askedModels(const Index& index) {
  std::vector<std::uint32_t> models;
  for (std::uint32_t i = 0; i < index.models().size; ++i) {
    if (index.categories()[index.models()[i].category].models >= kLeastModels) models.push_back(i);
  }
  return models;
}

std::uint64_t wantedQueries(const Index& index) {
  const std::uint64_t bytes = std::uint64_t{index.viewCount()} * index.parameters().code_bytes;
  return std::clamp<std::uint64_t>(kMostComparedBytes / bytes, kFewQueries, kConfidenceQueries);
}

// As many of each model; which directions, differs from model to model.
std::vector<AskedView> askedViews(const Index& index) {
  const std::vector<std::uint32_t> models = askedModels(index);
  std::vector<AskedView> asked;
  if (models.size() < kConfidenceModels) return asked;
  const std::uint64_t wanted = wantedQueries(index);
  const std::uint64_t each = std::min<std::uint64_t>((wanted + models.size() - 1) / models.size(), kMostPerModel);
  const std::size_t step = (models.size() + wanted - 1) / wanted;
  constexpr std::uint64_t kTurn = 37;
  for (std::size_t i = 0; i < models.size(); i += step) {
    const format::Model& model = index.models()[models[i]];
    const std::uint64_t views = std::min<std::uint64_t>(each, model.views);
    for (std::uint64_t k = 0; k < views; ++k) {
      const std::uint64_t view = (models[i] * kTurn + k * model.views / views) % model.views;
      asked.push_back({models[i], model.first_view + static_cast<std::uint32_t>(view)});
    }
  }
  return asked;
}

// ---- the fit -----------------------------------------------------------------------------------------------------

using Row = Eigen::Matrix<double, kUnknowns, 1>;
using Square = Eigen::Matrix<double, kUnknowns, kUnknowns>;

struct Sample {
  Row features;  // 1 first
  double right = 0;
};

Sample sampleOf(const Index& index, const AskedView& asked, Search& search) {
  const Nearest& found = search.find(index.code(asked.view), {{}, asked.model});
  const std::uint32_t category = classify(index, found, ClassifyMethod::Vote, 0).alternatives[0].category;
  const ConfidenceFeatures features = confidenceFeatures(index, found, category, asked.model);
  Sample sample;
  sample.features[0] = 1;
  for (int i = 0; i < kFeatures; ++i) sample.features[i + 1] = features[static_cast<std::size_t>(i)];
  sample.right = category == index.models()[asked.model].category ? 1 : 0;
  return sample;
}

// In the order of `asked`, whichever thread takes which.
std::vector<Sample> samplesOf(const std::shared_ptr<const Index>& index, const std::vector<AskedView>& asked) {
  std::vector<Sample> samples(asked.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    const auto search = makeSearch(index, {});
    for (std::size_t i = next++; i < asked.size(); i = next++) samples[i] = sampleOf(*index, asked[i], *search);
  };
  std::vector<std::thread> threads;
  for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  return samples;
}

// Mean and deviation of each feature; 0 and 1 of what never changes, the bias among it.
struct Scale {
  Row mean = Row::Zero(), deviation = Row::Ones();
};

Scale standardise(std::vector<Sample>& samples) {
  Row sum = Row::Zero(), squares = Row::Zero();
  for (const Sample& sample : samples) sum += sample.features;
  const Row mean = sum / static_cast<double>(samples.size());
  for (const Sample& sample : samples) squares += (sample.features - mean).cwiseAbs2();
  Scale scale;
  for (int i = 1; i < kUnknowns; ++i) {
    scale.mean[i] = mean[i];
    const double deviation = std::sqrt(squares[i] / static_cast<double>(samples.size()));
    if (deviation > 0) scale.deviation[i] = deviation;
  }
  for (Sample& sample : samples) sample.features = (sample.features - scale.mean).cwiseQuotient(scale.deviation);
  return scale;
}

// exp(x) for x <= 0 by its series: libraries differ in the last bit, this does not.
double exponential(double x) {
  constexpr int kHalvings = 10, kTerms = 8;
  const double small = std::max(x, -40.0) / (1 << kHalvings);
  double sum = 1;
  for (int i = kTerms; i >= 1; --i) sum = 1 + sum * small / i;
  for (int i = 0; i < kHalvings; ++i) sum *= sum;
  return sum;
}

double logistic(double x) {
  const double falling = exponential(-std::abs(x));
  return (x >= 0 ? 1 : falling) / (1 + falling);
}

// Newton's method on the likelihood, with a ridge that counts as much as a sample or so.
Row fit(const std::vector<Sample>& samples) {
  constexpr int kSteps = 25;
  constexpr double kRidge = 1;
  Row weights = Row::Zero();
  for (int step = 0; step < kSteps; ++step) {
    Row slope = -kRidge * weights;
    slope[0] = 0;
    Square curvature = kRidge * Square::Identity();
    for (const Sample& sample : samples) {
      const double said = logistic(sample.features.dot(weights));
      slope += (sample.right - said) * sample.features;
      curvature += said * (1 - said) * sample.features * sample.features.transpose();
    }
    weights += curvature.ldlt().solve(slope);
  }
  return weights;
}

std::int32_t inUnits(double x) {
  constexpr double kMost = 2147483647.0;
  return static_cast<std::int32_t>(std::clamp(std::round(x * format::Confidence::kUnit), -kMost, kMost));
}

format::Confidence confidenceOf(const Row& weights, const Scale& scale) {
  format::Confidence confidence{};
  double bias = weights[0];
  for (int i = 0; i < kFeatures; ++i) {
    const double weight = weights[i + 1] / scale.deviation[i + 1];
    bias -= weight * scale.mean[i + 1];
    confidence.weights[i] = inUnits(weight);
  }
  confidence.bias = inUnits(bias);
  return confidence;
}

}  // namespace

std::optional<format::Confidence> learnConfidence(const std::shared_ptr<const Index>& index) {
  const std::vector<AskedView> asked = askedViews(*index);
  if (asked.size() < kLeastQueries) return std::nullopt;
  std::vector<Sample> samples = samplesOf(index, asked);
  double right = 0;
  for (const Sample& sample : samples) right += sample.right;
  const Scale scale = standardise(samples);
  format::Confidence confidence = confidenceOf(fit(samples), scale);
  confidence.samples = static_cast<std::uint32_t>(samples.size());
  confidence.right = static_cast<std::uint32_t>(right);
  return confidence;
}

Result<Learnt> writeWithConfidence(IndexAssembler& whole, const Calibrate& calibrate, const std::string& draft,
                                   const std::string& path) {
  Status status = whole.write(draft, {}, std::nullopt);
  if (!status.ok()) return status;
  const auto index = Index::open(draft);
  std::remove(draft.c_str());
  if (!index.ok()) return index.status;
  const Learnt learnt{calibrate(index.value), learnConfidence(index.value)};
  status = whole.write(path, learnt.calibration, learnt.confidence);
  if (!status.ok()) return status;
  return learnt;
}

}  // namespace voxid
