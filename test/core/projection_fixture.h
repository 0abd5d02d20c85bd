// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/random.h"
#include "voxid/core/projection.h"

namespace voxid::test {

/// Any numbers that a projection may have.
inline ProjectionContent randomProjectionContent(std::uint32_t lists, std::uint64_t seed) {
  Random random(seed);
  ProjectionContent content;
  content.params = {500, 3};
  content.lists = lists;
  content.views = 7, content.models = 3, content.categories = 2;
  for (std::size_t i = 0; i < kCodeNumbers * kDepthBins; ++i)
    content.matrix.push_back(static_cast<std::int8_t>(random.between(-127, 127)));
  for (std::size_t i = 0; i < kCodeNumbers; ++i) content.bias.push_back(random.between(-100000, 100000));
  for (std::size_t i = 0; i < kCodeNumbers; ++i) content.factor_q24.push_back(random.between(0, 2000000));
  for (std::size_t i = 0; i < kCodeNumbers * lists; ++i)
    content.centroids.push_back(static_cast<std::int8_t>(random.between(-60, 60)));
  for (int bin = 0; bin < format::Calibration::kBins; ++bin)
    content.calibration.score_permille[bin] = static_cast<std::uint16_t>(10 * bin);
  content.calibration.samples = 9;
  return content;
}

inline std::shared_ptr<const Projection> projectionOf(const ProjectionContent& content) {
  const std::vector<std::uint8_t> bytes = serialised(content);
  const auto projection = Projection::fromBytes({bytes.data(), bytes.size()}, "of a test");
  EXPECT_TRUE(projection.ok()) << projection.status.sentence;
  return projection.value;
}

}  // namespace voxid::test
