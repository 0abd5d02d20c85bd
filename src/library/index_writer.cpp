// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/index_writer.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "voxid/library/index_assembler.h"

namespace voxid {
namespace {

std::vector<const ModelRecord*> sorted(const IndexContent& content) {
  std::vector<const ModelRecord*> models;
  for (const ModelRecord& model : content.models) models.push_back(&model);
  std::sort(models.begin(), models.end(), [](const ModelRecord* a, const ModelRecord* b) {
    return std::tie(a->category, a->name) < std::tie(b->category, b->name);
  });
  return models;
}

ViewRecord viewRecord(const Index& index, std::uint32_t number) {
  const format::View view = index.view(number);
  const std::uint8_t* const code = index.code(number);
  return {view.direction,
          view.points,
          {view.extents[0], view.extents[1], view.extents[2]},
          {code, code + index.parameters().code_bytes}};
}

}  // namespace

format::Calibration builtInCalibration(const Profile& profile) {
  if (profile.projection) {
    format::Calibration curve = profile.projection->calibration();
    curve.samples = 0;
    return curve;
  }
  format::Calibration curve{};
  for (int bin = 0; bin < format::Calibration::kBins; ++bin) {
    curve.score_permille[bin] = static_cast<std::uint16_t>(std::min(250 + 60 * bin, 980));
  }
  return curve;
}

Status writeIndex(const IndexContent& content, const std::string& path) {
  IndexAssembler whole(content.profile, content.directions, path);
  for (const ModelRecord* const model : sorted(content)) {
    const Status status = whole.add(*model);
    if (!status.ok()) return status;
  }
  return whole.write(path, content.calibration, content.confidence);
}

Result<ModelRecord> readModel(const Index& index, std::uint32_t number) {
  const format::Model& model = index.models()[number];
  if (model.category >= index.categories().size || std::uint64_t{model.first_view} + model.views > index.viewCount()) {
    return Status::damaged("the index " + index.path() + " is damaged: a model's views lead nowhere; " +
                           "`voxid verify` tells more");
  }
  const format::Category& category = index.categories()[model.category];
  const auto text = [&](std::uint32_t offset) { return std::string(index.string(offset)); };
  const Span<const std::uint8_t> surface = index.surface(number);
  ModelRecord record{text(category.name),
                     text(model.name),
                     text(model.licence),
                     text(model.origin),
                     category.synset,
                     {},
                     std::string(index.senseOf(model.category)),
                     std::string(index.hypernymsOf(model.category)),
                     {surface.begin(), surface.end()}};
  record.views.reserve(model.views);
  for (std::uint32_t i = 0; i < model.views; ++i) record.views.push_back(viewRecord(index, model.first_view + i));
  return record;
}

Result<IndexContent> readContent(const Index& index) {
  IndexContent content;
  content.profile = index.profile();
  content.directions.assign(index.directions().begin(), index.directions().end());
  content.calibration = index.calibration();
  if (index.confidence() != nullptr) content.confidence = *index.confidence();
  for (std::uint32_t number = 0; number < index.models().size; ++number) {
    Result<ModelRecord> model = readModel(index, number);
    if (!model.ok()) return model.status;
    content.models.push_back(std::move(model.value));
  }
  return content;
}

}  // namespace voxid
