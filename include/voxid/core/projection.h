// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "voxid/core/code.h"
#include "voxid/core/depth_descriptor.h"
#include "voxid/core/index_format.h"
#include "voxid/core/span.h"
#include "voxid/core/status.h"

namespace voxid {

/// What makes the depth descriptor small: a linear map of its bins, learnt once from rendered views by
/// `voxid train` (linear discriminant analysis: directions along which categories differ most against what differs
/// inside a category), in integers, its result brought to one length (how far a view is from the mean says less than in
/// which direction: doc/descriptor.md); with it the centroids that sort codes into lists, and the calibration of
/// libraries too small for their own. One file, and one section of an index. Thread-safe: everything is const.
class Projection {
 public:
  /// CannotDo for a missing or unreadable file or one of another voxid, Damaged for a cut or altered one.
  static Result<std::shared_ptr<const Projection>> read(const std::string& path);
  /// The same from a file's content, which is copied; `name` is for sentences.
  static Result<std::shared_ptr<const Projection>> fromBytes(Span<const std::uint8_t> bytes, const std::string& name);

  /// The file's content.
  Span<const std::uint8_t> bytes() const { return {bytes_.data(), bytes_.size()}; }
  const format::Projection& header() const { return *header_; }
  const format::Calibration& calibration() const { return *calibration_; }
  /// What the bins to be projected must be made with.
  DescriptorParams descriptorParams() const { return {header_->pairs, header_->seed}; }

  /// Writes a code (packCode).
  void project(const DepthBins& bins, std::size_t code_bytes, std::uint8_t* code) const;

  /// The list that a code's numbers (unpackCode) belong to: that of the nearest centroid, the first of equally near
  /// ones.
  std::uint32_t listOf(const CodeNumbers& numbers) const;
  std::uint32_t lists() const { return header_->lists; }
  const std::int8_t* centroids() const { return centroids_; }  ///< lists() rows of kCodeNumbers

 private:
  Projection() = default;
  Status check(const std::string& name);

  std::vector<std::uint8_t> bytes_;
  const format::Projection* header_ = nullptr;
  const std::int8_t* matrix_ = nullptr;
  const std::int32_t* bias_ = nullptr;
  const std::int32_t* factor_q24_ = nullptr;
  const std::int8_t* centroids_ = nullptr;
  const format::Calibration* calibration_ = nullptr;
};

/// A projection to be written, as `voxid train` makes it.
struct ProjectionContent {
  DescriptorParams params;  ///< of the depth descriptor
  std::uint32_t lists = 0;
  std::uint32_t views = 0, models = 0, categories = 0;  ///< that it was learnt from
  std::vector<std::int8_t> matrix;                      ///< kCodeNumbers rows of kDepthBins
  std::vector<std::int32_t> bias;                       ///< by row; below 2^30 in size
  std::vector<std::int32_t> factor_q24;                 ///< a number before it is brought to length:
                                                        ///< (row . bins + bias) factor / 2^24; 0 to 2^31 - 1
  std::vector<std::int8_t> centroids;                   ///< lists rows of kCodeNumbers
  format::Calibration calibration{};
};
/// The file's bytes.
std::vector<std::uint8_t> serialised(const ProjectionContent& content);

}  // namespace voxid
