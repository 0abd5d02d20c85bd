// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "voxid/core/crc32c.h"
#include "voxid/core/index.h"
#include "voxid/core/kept_surface.h"
#include "voxid/core/refine.h"
#include "voxid/core/sketch.h"

namespace voxid {
namespace {

// What is wrong with a part of the file; empty if nothing is.
using Fault = std::string;

template <typename T>
Fault at(const char* what, T number) {
  return std::string(what) + " " + std::to_string(number);
}

bool allZero(const std::uint8_t* first, const std::uint8_t* last) {
  return std::all_of(first, last, [](std::uint8_t byte) { return byte == 0; });
}

template <std::size_t N>
bool allZero(const std::uint8_t (&bytes)[N]) {
  return allZero(bytes, bytes + N);
}

std::string tagOf(const format::Section& section) { return {section.tag, sizeof section.tag}; }

Fault checkSums(const Index& index) {
  for (const format::Section& section : index.sections()) {
    const std::uint8_t* const start = index.file().data + section.offset;
    if (crc32c(start, static_cast<std::size_t>(section.length)) != section.crc32c) {
      return "the checksum of section " + tagOf(section) + " is wrong";
    }
  }
  return {};
}

Fault checkPadding(const Index& index) {
  const std::uint8_t* const file = index.file().data;
  const std::uint8_t* end = file + sizeof(format::Header) + index.sections().size * sizeof(format::Section);
  if (!allZero(index.header().zero)) return "the header's padding is not zero";
  for (const format::Section& section : index.sections()) {
    if (!allZero(section.zero)) return "the padding of the table entry " + tagOf(section) + " is not zero";
    if (!allZero(end, file + section.offset)) return "the padding before section " + tagOf(section) + " is not zero";
    end = file + section.offset + section.length;
  }
  return allZero(end, file + index.file().size) ? Fault() : "the padding at the end is not zero";
}

// Strings that are needed: not empty, and above the one before.
bool ascends(const Index& index, std::uint32_t name, std::string_view previous) {
  return index.string(name) > previous;
}

bool stringExists(const Index& index, std::uint32_t offset) { return offset == 0 || !index.string(offset).empty(); }

// A section of one offset a category (SYNS, HYPR) has the text that it names.
bool hasText(const Index& index, const char* tag, std::uint32_t category, std::string_view text) {
  for (const format::Section& section : index.sections()) {
    if (tagOf(section) != tag) continue;
    std::uint32_t offset = 0;
    std::memcpy(&offset, index.file().data + section.offset + category * sizeof offset, sizeof offset);
    return offset == 0 || !text.empty();
  }
  return true;
}

Fault checkCategories(const Index& index) {
  std::string_view previous;
  std::uint64_t next_model = 0;
  for (std::uint32_t i = 0; i < index.categories().size; ++i) {
    const format::Category& category = index.categories()[i];
    if (!ascends(index, category.name, previous)) return at("names do not ascend at category", i);
    if (category.first_model != next_model || category.models == 0) return at("wrong models in category", i);
    if (!hasText(index, "SYNS", i, index.senseOf(i))) return at("wrong sense of category", i);
    if (!hasText(index, "HYPR", i, index.hypernymsOf(i))) return at("wrong hypernyms of category", i);
    previous = index.string(category.name);
    next_model += category.models;
  }
  return next_model == index.models().size ? Fault() : "categories do not cover the models";
}

Fault checkModelsOf(const Index& index, std::uint32_t category, std::uint64_t& next_view) {
  const format::Category& parent = index.categories()[category];
  std::string_view previous;
  for (std::uint32_t i = parent.first_model; i < parent.first_model + parent.models; ++i) {
    const format::Model& model = index.models()[i];
    if (model.category != category || !ascends(index, model.name, previous)) return at("wrong order at model", i);
    if (!stringExists(index, model.licence) || !stringExists(index, model.origin)) return at("wrong text in model", i);
    if (model.first_view != next_view || model.views == 0) return at("wrong views in model", i);
    if (!allZero(model.zero)) return at("padding is not zero in model", i);
    previous = index.string(model.name);
    next_view += model.views;
  }
  return {};
}

// After checkCategories: the categories' ranges are the models, each once.
Fault checkModels(const Index& index) {
  std::uint64_t next_view = 0;
  for (std::uint32_t i = 0; i < index.categories().size; ++i) {
    if (Fault fault = checkModelsOf(index, i, next_view); !fault.empty()) return fault;
  }
  return next_view == index.viewCount() ? Fault() : "models do not cover the views";
}

Fault checkViewsOf(const Index& index, std::uint32_t model) {
  const format::Model& parent = index.models()[model];
  int previous = -1;
  for (std::uint32_t i = parent.first_view; i < parent.first_view + parent.views; ++i) {
    const format::View view = index.view(i);
    const bool ordered = view.model == model && view.direction > previous;
    if (!ordered || view.direction >= index.directions().size) return at("wrong model or direction in view", i);
    if (view.zero != 0) return at("padding is not zero in view", i);
    previous = view.direction;
  }
  return {};
}

Fault checkViews(const Index& index) {
  for (std::uint32_t i = 0; i < index.models().size; ++i) {
    if (Fault fault = checkViewsOf(index, i); !fault.empty()) return fault;
  }
  for (std::uint32_t i = 0; i < index.directions().size; ++i) {
    if (!allZero(index.directions()[i].zero)) return at("padding is not zero in direction", i);
  }
  return {};
}

// Views ascend in a bucket and have its key, keys differ: with the right total every view is in exactly one bucket.
Fault checkBuckets(const Index& index) {
  const Profile profile = index.profile();
  std::uint64_t total = 0;
  for (std::uint32_t i = 0; i < index.keys().size; ++i) {
    const Key key = index.keys()[i];
    if (key >> kKeyBits != 0 || (i > 0 && index.keys()[i - 1] >= key)) return at("keys do not ascend at bucket", i);
    const Span<const std::uint32_t> bucket = index.bucket(i);
    if (bucket.empty()) return at("nothing in bucket", i);
    for (std::uint32_t k = 0; k < bucket.size; ++k) {
      const bool ordered = bucket[k] < index.viewCount() && (k == 0 || bucket[k - 1] < bucket[k]);
      if (!ordered || bucketKeyOf(profile, index.code(bucket[k])) != key) return at("wrong view in bucket", i);
    }
    total += bucket.size;
  }
  return total == index.viewCount() ? Fault() : "the buckets do not hold every view";
}

Fault checkMeans(const Index& index) {
  if (!index.projection()) return {};
  CodeNumbers expected;
  for (std::uint32_t i = 0; i < index.categories().size; ++i) {
    const format::Category& category = index.categories()[i];
    const format::Model& last = index.models()[category.first_model + category.models - 1];
    CodeMean mean(index.parameters().code_bytes);
    for (std::uint32_t view = index.models()[category.first_model].first_view; view < last.first_view + last.views;
         ++view)
      mean.add(index.code(view));
    mean.write(expected.data());
    if (!std::equal(expected.begin(), expected.end(), index.mean(i))) return at("wrong mean of category", i);
  }
  return {};
}

Fault checkSketches(const Index& index) {
  const auto isSketches = [](const format::Section& section) { return tagOf(section) == "SUMS"; };
  const auto sections = std::count_if(index.sections().begin(), index.sections().end(), isSketches);
  if (sections == 0) return {};
  const Span<const std::uint8_t> sketches = sketchesOf(index);
  if (sections > 1 || sketches.empty()) return "section SUMS does not hold one sketch a view";
  for (std::uint32_t view = 0; view < index.viewCount(); ++view) {
    std::array<std::uint8_t, kSketchBytes> expected;
    sketchOf(index.code(view), expected.data());
    if (!std::equal(expected.begin(), expected.end(), sketches.data + std::size_t{view} * kSketchBytes))
      return at("wrong sketch of view", view);
  }
  return {};
}

// Surfaces follow one another and fill their section; each is whole.
Fault checkSurfaces(const Index& index) {
  if (!index.hasSurfaces()) return {};
  std::uint64_t length = 0;
  for (std::uint32_t i = 0; i < index.models().size; ++i) {
    const Span<const std::uint8_t> surface = index.surface(i);
    if (!surface.empty() && !KeptSurface::of(surface)) return at("wrong surface of model", i);
    length += surface.size;
  }
  const auto isSurfaces = [](const format::Section& section) { return tagOf(section) == "SURF"; };
  const auto* const section = std::find_if(index.sections().begin(), index.sections().end(), isSurfaces);
  return section->length == length ? Fault() : "the surfaces do not fill their section";
}

Fault checkCalibration(const Index& index) {
  const format::Calibration& curve = index.calibration();
  const auto* const first = curve.score_permille;
  const auto* const last = first + format::Calibration::kBins;
  if (!std::is_sorted(first, last) || *(last - 1) > 1000) return "the calibration does not rise from 0 to 1000 at most";
  return allZero(curve.zero) ? Fault() : "the calibration's padding is not zero";
}

Fault checkConfidence(const Index& index) {
  const format::Confidence* const confidence = index.confidence();
  if (confidence == nullptr) return {};
  if (confidence->samples == 0 || confidence->right > confidence->samples) return "the confidence's samples are wrong";
  return allZero(confidence->zero) ? Fault() : "the confidence's padding is not zero";
}

}  // namespace

Status Index::verify() const {
  for (const auto check : {checkSums, checkPadding, checkCategories, checkModels, checkViews, checkBuckets, checkMeans,
                           checkSketches, checkSurfaces, checkCalibration, checkConfidence}) {
    const Fault fault = check(*this);
    if (!fault.empty()) {
      return Status::damaged("the index " + path_ + " is damaged: " + fault +
                             "; copy it again from a good one or make it anew with `voxid build`");
    }
  }
  return {};
}

}  // namespace voxid
