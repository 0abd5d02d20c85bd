// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/discriminants.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

namespace voxid {
namespace {

using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXd;

/// Sums over views, from which scatters follow.
struct Moments {
  MatrixXd products;  ///< lower half, of the views less `mean`
  VectorXd mean;
  MatrixXd category_means;  ///< a row each, less `mean`
  VectorXd category_views;
  double views = 0;
};

using BytesMap = Eigen::Map<const Eigen::Matrix<std::uint8_t, Eigen::Dynamic, 1>>;

/// The mean of all views, and every category with the number of its row.
using Rows = std::map<std::string, Eigen::Index>;
Rows firstPass(const ForEachView& for_each_view, int bins, Moments& m) {
  Rows rows;
  m.mean = VectorXd::Zero(bins);
  for_each_view([&](const std::string& category, const std::uint8_t* view) {
    rows.emplace(category, 0);
    m.mean += BytesMap(view, bins).cast<double>();
    m.views += 1;
  });
  m.mean /= m.views;
  Eigen::Index next = 0;
  for (auto& row : rows) row.second = next++;
  return rows;
}

Moments momentsOf(const ForEachView& for_each_view, int bins) {
  constexpr int kBlock = 2048;
  Moments m;
  const Rows rows = firstPass(for_each_view, bins, m);
  m.products = MatrixXd::Zero(bins, bins);
  m.category_means = MatrixXd::Zero(static_cast<Eigen::Index>(rows.size()), bins);
  m.category_views = VectorXd::Zero(static_cast<Eigen::Index>(rows.size()));
  const Eigen::VectorXf mean = m.mean.cast<float>();
  MatrixXf block(bins, kBlock);
  int filled = 0;
  const auto flush = [&] {
    MatrixXf products = MatrixXf::Zero(bins, bins);
    products.selfadjointView<Eigen::Lower>().rankUpdate(block.leftCols(filled));
    m.products += products.cast<double>();
    filled = 0;
  };
  for_each_view([&](const std::string& category, const std::uint8_t* view) {
    block.col(filled) = BytesMap(view, bins).cast<float>() - mean;
    const Eigen::Index row = rows.at(category);
    m.category_means.row(row) += block.col(filled).transpose().cast<double>();
    m.category_views[row] += 1;
    if (++filled == kBlock) flush();
  });
  flush();
  for (Eigen::Index i = 0; i < m.category_views.size(); ++i) m.category_means.row(i) /= m.category_views[i];
  return m;
}

/// Linear discriminant analysis: columns along which the scatter between categories is largest, best first, when the
/// scatter inside categories is one in every direction. With W = L L' and B = C C' (C: the categories' means), the
/// columns are L'^-1 u for the left singular vectors u of L^-1 C.
MatrixXd discriminants(const Moments& m, int count, double shrinkage) {
  const Eigen::Index bins = m.mean.size();
  const MatrixXd weighted = ((m.category_views / m.views).cwiseSqrt().asDiagonal() * m.category_means).transpose();
  MatrixXd within = m.products.selfadjointView<Eigen::Lower>();
  within = within / m.views - weighted * weighted.transpose();
  within.diagonal().array() += shrinkage * within.trace() / static_cast<double>(bins);
  const Eigen::LLT<MatrixXd> cholesky(within);
  const MatrixXd whitened = cholesky.matrixL().solve(weighted);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> spectrum(whitened.transpose() * whitened);
  constexpr double kWeightPower = 0.25;  // of between over within: some weight to what tells more (doc/descriptor.md)
  const int found = std::min(count, static_cast<int>(spectrum.eigenvalues().size()));
  MatrixXd columns = MatrixXd::Zero(bins, count);
  int told = 0;
  for (int i = 0; i < found; ++i, ++told) {
    const Eigen::Index from_end = spectrum.eigenvalues().size() - 1 - i;
    const double squared = spectrum.eigenvalues()[from_end];
    if (squared < 1e-9) break;
    const VectorXd u = whitened * spectrum.eigenvectors().col(from_end) / std::sqrt(squared);
    VectorXd column = cholesky.matrixL().transpose().solve(u);
    Eigen::Index largest = 0;
    column.cwiseAbs().maxCoeff(&largest);
    const double sign = column[largest] < 0 ? -1 : 1;  // free; this one is reproducible
    columns.col(i) = sign * std::pow(squared, kWeightPower) * column;
  }
  for (int i = told; i < count && told > 0; ++i) columns.col(i) = columns.col(i % told);
  return columns;
}

/// Rows of integers whose largest is 127, each with the factor that takes it back.
IntegerMap rounded(const Moments& m, const MatrixXd& columns) {
  IntegerMap out;
  constexpr double kUnit = 4096;  // a standard deviation inside categories, before codes are brought to length
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const double step = std::max(columns.col(k).cwiseAbs().maxCoeff(), 1e-12) / 127;
    double bias = 0;
    for (Eigen::Index i = 0; i < columns.rows(); ++i) {
      const auto entry = static_cast<std::int8_t>(std::lround(columns(i, k) / step));
      out.matrix.push_back(entry);
      bias -= entry * m.mean[i];
    }
    out.bias.push_back(static_cast<std::int32_t>(std::lround(bias)));
    out.factor_q24.push_back(static_cast<std::int32_t>(std::lround(std::min(step * kUnit * (1 << 24), 2147483000.0))));
  }
  return out;
}

}  // namespace

IntegerMap learnDiscriminants(const ForEachView& for_each_view, int bins, int count, double shrinkage) {
  const Moments moments = momentsOf(for_each_view, bins);
  return rounded(moments, discriminants(moments, count, shrinkage));
}

}  // namespace voxid
