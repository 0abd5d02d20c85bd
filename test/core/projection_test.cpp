// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/projection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/projection_fixture.h"

namespace voxid {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::vector<double> slowNumbers(const ProjectionContent& content, const DepthBins& bins, std::size_t rows) {
  std::vector<double> numbers;
  double squares = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    std::int64_t sum = content.bias[row];
    for (std::size_t i = 0; i < kDepthBins; ++i) sum += std::int64_t{content.matrix[row * kDepthBins + i]} * bins[i];
    numbers.push_back(static_cast<double>(sum * content.factor_q24[row]) / (1 << 24));
    squares += numbers.back() * numbers.back();
  }
  for (double& number : numbers) number *= kCodeLength / std::sqrt(squares);
  return numbers;
}

CodeNumbers projected(const ProjectionContent& content, const DepthBins& bins, std::size_t bytes) {
  Bytes code(bytes);
  test::projectionOf(content)->project(bins, bytes, code.data());
  return unpackCode(code.data(), bytes);
}

TEST(Projection, IsTheProductOfMatrixAndBinsBroughtToLength) {
  const ProjectionContent content = test::randomProjectionContent(5, 64);
  test::Random random(8);
  DepthBins bins;
  for (std::uint8_t& bin : bins) bin = static_cast<std::uint8_t>(random.below(256));
  for (const std::size_t bytes : {kSmallCodeBytes, kCodeBytes}) {
    const std::vector<double> numbers = slowNumbers(content, bins, numbersIn(bytes));
    const CodeNumbers code = projected(content, bins, bytes);
    double squares = 0;
    for (std::size_t row = 0; row < numbers.size(); ++row) {
      const double off = code[row] - std::clamp(numbers[row], -90.0, 90.0);
      squares += off * off / static_cast<double>(numbers.size());
      EXPECT_LT(std::abs(off), 32) << row;
    }
    EXPECT_LT(squares, 40) << "rounding to 16 costs 21";
  }
}

TEST(Projection, ExtremesAreCutOffNotWrapped) {
  ProjectionContent content = test::randomProjectionContent(1, 1);
  std::fill(content.matrix.begin(), content.matrix.end(), std::int8_t{127});
  std::fill(content.factor_q24.begin(), content.factor_q24.end(), 0x7fffffff);
  std::fill(content.bias.begin(), content.bias.end(), (1 << 30) - 1);
  std::fill(content.matrix.begin(), content.matrix.begin() + kDepthBins, std::int8_t{-128});
  content.bias[0] = -((1 << 30) - 1);
  DepthBins bins;
  bins.fill(255);
  const CodeNumbers code = projected(content, bins, kCodeBytes);
  for (std::size_t row = 1; row < kCodeNumbers; ++row) EXPECT_NEAR(code[row], row % 6 == 0 ? 28 : 36, 20) << row;
  EXPECT_LT(code[0], 0);
}

TEST(Projection, ACodeBelongsToTheNearestCentroid) {
  const ProjectionContent content = test::randomProjectionContent(700, 2);
  const auto projection = test::projectionOf(content);
  test::Random random(3);
  for (int query = 0; query < 50; ++query) {
    CodeNumbers code;
    for (std::int8_t& number : code) number = static_cast<std::int8_t>(random.between(-127, 127));
    std::vector<int> distances;
    for (std::size_t list = 0; list < content.lists; ++list) {
      int sum = 0;
      for (std::size_t i = 0; i < kCodeNumbers; ++i) {
        const int d = code[i] - content.centroids[list * kCodeNumbers + i];
        sum += d * d;
      }
      distances.push_back(sum);
    }
    EXPECT_EQ(projection->listOf(code), std::min_element(distances.begin(), distances.end()) - distances.begin());
  }
}

TEST(Projection, ReadsWhatWasWritten) {
  const ProjectionContent content = test::randomProjectionContent(5, 4);
  const auto projection = test::projectionOf(content);
  EXPECT_EQ(projection->descriptorParams().pairs, 500u);
  EXPECT_EQ(projection->descriptorParams().seed, 3u);
  EXPECT_EQ(projection->lists(), 5u);
  EXPECT_EQ(projection->header().categories, 2u);
  EXPECT_EQ(projection->calibration().score_permille[7], 70);
  EXPECT_TRUE(std::equal(content.centroids.begin(), content.centroids.end(), projection->centroids()));
}

void expectRefused(const Bytes& bytes, Status::Kind kind) {
  const Status status = Projection::fromBytes({bytes.data(), bytes.size()}, "x.vxp").status;
  EXPECT_EQ(status.kind, kind) << status.sentence;
  EXPECT_NE(status.sentence.find("x.vxp"), std::string::npos) << status.sentence;
}

TEST(Projection, DamageIsRefused) {
  const Bytes good = serialised(test::randomProjectionContent(3, 5));
  for (std::size_t at = 0; at < good.size(); at += at < 64 ? 1 : 997) {
    Bytes bad = good;
    bad[at] ^= 0x10;
    EXPECT_FALSE(Projection::fromBytes({bad.data(), bad.size()}, "x").ok()) << at;
  }
  expectRefused({}, Status::Kind::Damaged);
  expectRefused(Bytes(good.begin(), good.end() - 1), Status::Kind::Damaged);
  Bytes longer = good;
  longer.push_back(0);
  expectRefused(longer, Status::Kind::Damaged);
  EXPECT_EQ(Projection::read("no/such.vxp").status.kind, Status::Kind::CannotDo);
}

TEST(Projection, OfAnotherDescriptorIsRefused) {
  Bytes other = serialised(test::randomProjectionContent(3, 6));
  reinterpret_cast<format::Projection*>(other.data())->revision += 1;
  expectRefused(other, Status::Kind::CannotDo);
  other = serialised(test::randomProjectionContent(3, 6));
  reinterpret_cast<format::Projection*>(other.data())->numbers = 32;
  expectRefused(other, Status::Kind::CannotDo);
}

}  // namespace
}  // namespace voxid
