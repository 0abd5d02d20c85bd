// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "voxid/core/descriptor.h"
#include "voxid/core/encoder.h"
#include "voxid/core/index_format.h"
#include "voxid/core/key.h"
#include "voxid/core/span.h"
#include "voxid/core/status.h"

namespace voxid {

/// A .vxi file, mapped read-only and shared between processes through the page cache. Opening checks the header, the
/// section table and every size, count and range that a later read relies on, and reads nothing else; a file replaced
/// by rename keeps being read in its old form. One that is cut or written over while it is mapped ends the process.
/// Thread-safe: everything is const.
class Index {
 public:
  /// Refuses with one sentence: CannotDo for a missing or unreadable file, another major version, foreign descriptor
  /// parameters; Damaged for an empty or cut file, a wrong header sum, a range that leaves the file.
  static Result<std::shared_ptr<const Index>> open(const std::string& path);
  /// The same, but a file of at most `own_bytes` is read as a whole into memory of the index's own: whatever happens to
  /// the file later changes nothing.
  static Result<std::shared_ptr<const Index>> open(const std::string& path, std::uint64_t own_bytes);
  ~Index();
  Index(const Index&) = delete;
  Index& operator=(const Index&) = delete;

  /// Reads the whole file: every section's sum, every reference, the order of what is sorted, zero padding.
  /// Damaged with the place if anything is wrong.
  Status verify() const;

  const std::string& path() const { return path_; }
  const format::Header& header() const { return *header_; }
  std::uint64_t bytes() const { return header_->file_bytes; }
  const format::Parameters& parameters() const { return *parameters_; }
  DescriptorParams descriptorParams() const { return {parameters_->pairs, parameters_->seed}; }
  /// How its codes were made; a query is to be made alike.
  Profile profile() const {
    return {descriptorParams(), projection_, projection_ && parameters_->code_bytes == kSmallCodeBytes};
  }
  /// Null in an index of profile "paper".
  const std::shared_ptr<const Projection>& projection() const { return projection_; }

  Span<const format::Category> categories() const { return categories_; }
  Span<const format::Model> models() const { return models_; }
  std::uint32_t viewCount() const { return header_->views; }
  /// A view, `i` below viewCount(). "default" stores its extents in 1/255 and not how many pixels it had (zero).
  format::View view(std::uint32_t i) const;
  /// view(i).model alone. In a damaged file any number.
  std::uint32_t modelOf(std::uint32_t view) const;
  Span<const format::Direction> directions() const { return directions_; }
  const format::Calibration& calibration() const { return *calibration_; }
  /// Null in an index that has none: then calibration() counts.
  const format::Confidence* confidence() const { return confidence_; }

  /// A model's surface as it is stored (voxid/core/kept_surface.h); empty if the index keeps none of it.
  Span<const std::uint8_t> surface(std::uint32_t model) const;
  /// Whether any model's surface is kept.
  bool hasSurfaces() const { return !surfaces_.empty(); }
  /// What they take of bytes(): not counted as a view's, as searching does without.
  std::uint64_t surfaceBytes() const { return surface_offsets_.size * sizeof(std::uint64_t) + surfaces_.size; }

  /// The stored bytes of a view, code_bytes of them.
  const std::uint8_t* code(std::uint32_t view) const { return codes_ + std::size_t{view} * parameters_->code_bytes; }

  /// The mean of the numbers of a category's codes, kCodeNumbers of them; only in "default".
  const std::int8_t* mean(std::uint32_t category) const { return means_.data + std::size_t{category} * kCodeNumbers; }

  Span<const Key> keys() const { return keys_; }
  /// The views in bucket `i` (of keys()[i]). A range outside the section (possible only in a damaged file) comes back
  /// empty.
  Span<const std::uint32_t> bucket(std::uint32_t i) const;

  /// A string of STRS; always terminated inside the section. An offset outside comes back empty.
  std::string_view string(std::uint32_t offset) const;
  /// Empty for a number that the index does not have.
  std::string_view categoryName(std::uint32_t category) const {
    return category < categories_.size ? string(categories_[category].name) : std::string_view();
  }
  /// The category's synset as NLTK names it ("mug.n.04"); empty if not known, or for a number that the index does not
  /// have.
  std::string_view senseOf(std::uint32_t category) const {
    return category < senses_.size ? string(senses_[category]) : std::string_view();
  }
  /// The category's path from WordNet's root, its own synset last, joined by slashes; empty as above.
  std::string_view hypernymsOf(std::uint32_t category) const {
    return category < hypernyms_.size ? string(hypernyms_[category]) : std::string_view();
  }
  std::string_view modelName(std::uint32_t model) const {
    return model < models_.size ? string(models_[model].name) : std::string_view();
  }

  /// The whole file, and its section table.
  Span<const std::uint8_t> file() const { return {file_, mapped_bytes_}; }
  Span<const format::Section> sections() const { return sections_; }

 private:
  Index() = default;
  Status map(std::uint64_t own_bytes);
  Status read(int file) const;
  Status checkHeader() const;
  Status checkSections() const;
  Status checkParameters() const;
  Status locateEncoding();
  Status locateTables();
  void expect(int advice) const;
  void willRead(Span<const std::uint8_t> bytes) const;

  std::string path_;
  const std::uint8_t* file_ = nullptr;
  std::size_t mapped_bytes_ = 0;
  const format::Header* header_ = nullptr;
  Span<const format::Section> sections_;
  const format::Parameters* parameters_ = nullptr;
  const format::Calibration* calibration_ = nullptr;
  const format::Confidence* confidence_ = nullptr;
  Span<const format::Category> categories_;
  Span<const format::Model> models_;
  std::shared_ptr<const Projection> projection_;
  Span<const format::View> views_;             // of "paper"
  Span<const format::ShortView> short_views_;  // of "default"
  Span<const format::Direction> directions_;
  const std::uint8_t* codes_ = nullptr;
  Span<const std::int8_t> means_;
  Span<const Key> keys_;
  Span<const std::uint32_t> bucket_offsets_, bucket_views_;
  Span<const char> strings_;
  Span<const std::uint32_t> senses_, hypernyms_;  // empty, or one a category
  Span<const std::uint64_t> surface_offsets_;     // empty, or one a model and one more
  Span<const std::uint8_t> surfaces_;
};

/// What the descriptor's settings look like in a file; a query made with others is refused.
format::Parameters parametersOf(const Profile& profile);

/// Between two codes: L1 of "paper", squared Euclidean of "default".
std::uint32_t codeDistance(const Profile& profile, const std::uint8_t* a, const std::uint8_t* b);
/// What a code is sorted into buckets by: the paper's key, or the number of its list.
Key bucketKeyOf(const Profile& profile, const std::uint8_t* code);

}  // namespace voxid
