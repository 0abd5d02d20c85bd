// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "voxid/core/encoder.h"
#include "voxid/core/index.h"
#include "voxid/core/index_format.h"
#include "voxid/core/status.h"

namespace voxid {

/// One view of a model, as it goes into the index.
struct ViewRecord {
  std::uint8_t direction = 0;              ///< index into IndexContent::directions
  std::uint32_t points = 0;                ///< visible pixels; "default" does not store them
  std::array<std::uint16_t, 3> extents{};  ///< as in format::View; "default" stores the highest eight bits
  std::vector<std::uint8_t> code;          ///< code_bytes
};

/// One model with its views.
struct ModelRecord {
  std::string category, name, licence, origin;
  std::uint32_t synset = 0;       ///< of the category; WordNet 3.0 noun offset, 0 = not known
  std::vector<ViewRecord> views;  ///< by ascending direction
  std::string sense{};            ///< of the category; the synset's name in NLTK's form (mug.n.04), empty = not known
  std::string hypernyms{};        ///< of the category; as Index::hypernymsOf, empty = not known
  std::vector<std::uint8_t> surface{};  ///< as Index::surface, empty = not kept
};

/// Everything an index holds, in memory. The order of `models` does not matter: writing sorts by category and name.
struct IndexContent {
  Profile profile;                            ///< that the views' codes were made with
  std::vector<format::Direction> directions;  ///< at most 256; what the views' directions refer to
  std::vector<ModelRecord> models;
  format::Calibration calibration{};
  std::optional<format::Confidence> confidence;  ///< section CONF
};

/// The curve that is used where a library is too small to learn its own (fewer than 200 calibration queries): that of
/// the projection, or for "paper" one measured on models/train (doc/descriptor.md).
format::Calibration builtInCalibration(const Profile& profile);

/// Writes a .vxi file beside `path`, fsyncs and renames: readers see the old file or the new one, whole. The bytes
/// depend on the content only. Refuses (CannotDo) what a reader could not rely on: no model at all, a model without a
/// view, two models of one category with the same name, two synsets, senses or paths of hypernyms for one category, an
/// empty category or model name, views that do not ascend or name no direction, a code of another length, a surface
/// that is not whole, a calibration that falls, a confidence of no samples, parameters out of range. Nothing is left
/// beside `path` if it fails.
Status writeIndex(const IndexContent& content, const std::string& path);

/// A model of an index, `number` below models().size. Damaged if its views lead nowhere.
Result<ModelRecord> readModel(const Index& index, std::uint32_t number);

/// The content of an index, such that writing it gives the same bytes again. The index should have passed `verify`;
/// references of a damaged one that lead nowhere are refused as Damaged.
Result<IndexContent> readContent(const Index& index);

}  // namespace voxid
