// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/trainer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "calibrate.h"
#include "model_folder.h"
#include "parts_folder.h"
#include "render_models.h"
#include "shard.h"
#include "voxid/library/discriminants.h"
#include "voxid/library/index_writer.h"
#include "voxid/library/views.h"

namespace voxid {
namespace {

/// What is learnt from: bins of views, each view's category.
struct Lessons {
  std::vector<ModelRecord> models;                     ///< their codes are bins
  std::vector<std::vector<std::uint8_t>> calibration;  ///< bins of one more view of each model
  std::vector<std::string> categories;
  std::size_t views = 0;
};

EncodeView encodeBins(const DescriptorParams& params) {
  const auto describer = std::make_shared<DepthDescriber>(params);
  const auto bins = std::make_shared<DepthBins>();
  return [describer, bins](const DepthView& depth, Span<const std::uint32_t> pixels) -> std::vector<std::uint8_t> {
    if (describer->describe(depth, pixels, *bins) != DescribeStatus::Ok) return {};
    return {bins->begin(), bins->end()};
  };
}

/// The shards' parameters: nothing else reads them.
format::Parameters binsParameters(const DescriptorParams& params) {
  format::Parameters parameters = parametersOf(Profile{params, nullptr});
  std::fill(std::begin(parameters.profile), std::end(parameters.profile), '\0');
  parameters.profile[0] = 'b';
  parameters.revision = kDepthDescriptorRevision;
  parameters.code_bytes = kDepthBins;
  return parameters;
}

// ---- the lists ---------------------------------------------------------------------------------------------------

std::shared_ptr<const Projection> projectionOf(const ProjectionContent& content) {
  const std::vector<std::uint8_t> bytes = serialised(content);
  return Projection::fromBytes({bytes.data(), bytes.size()}, "in the making").value;
}

/// As an index of the views would hold them.
std::vector<std::uint8_t> codesOf(const Lessons& lessons, const Projection& projection) {
  std::vector<std::uint8_t> codes(lessons.views * kCodeBytes);
  std::uint8_t* at = codes.data();
  DepthBins bins;
  for (const ModelRecord& model : lessons.models) {
    for (const ViewRecord& view : model.views) {
      std::copy(view.code.begin(), view.code.end(), bins.begin());
      projection.project(bins, kCodeBytes, at);
      at += kCodeBytes;
    }
  }
  return codes;
}

std::vector<CodeNumbers> unpacked(const std::vector<std::uint8_t>& codes) {
  std::vector<CodeNumbers> numbers;
  numbers.reserve(codes.size() / kCodeBytes);
  for (std::size_t at = 0; at < codes.size(); at += kCodeBytes) numbers.push_back(unpackCode(&codes[at], kCodeBytes));
  return numbers;
}

/// Moves every centroid to the mean of its codes; one without codes stays.
void moveCentroids(ProjectionContent& content, const std::vector<CodeNumbers>& codes) {
  const auto projection = projectionOf(content);
  std::vector<double> sums(content.centroids.size());
  std::vector<double> members(content.lists);
  for (const CodeNumbers& numbers : codes) {
    const std::uint32_t list = projection->listOf(numbers);
    ++members[list];
    for (std::size_t i = 0; i < kCodeNumbers; ++i) sums[list * kCodeNumbers + i] += numbers[i];
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double count = members[i / kCodeNumbers];
    if (count > 0) content.centroids[i] = static_cast<std::int8_t>(std::lround(sums[i] / count));
  }
}

/// Lloyd's algorithm, begun at views evenly spread over the library.
void learnLists(ProjectionContent& content, const Lessons& lessons) {
  constexpr int kRounds = 12;
  content.lists = static_cast<std::uint32_t>(std::min<std::size_t>(content.lists, lessons.views));
  content.centroids.assign(content.lists * kCodeNumbers, 0);
  const std::vector<CodeNumbers> codes = unpacked(codesOf(lessons, *projectionOf(content)));
  for (std::size_t list = 0; list < content.lists; ++list) {
    const CodeNumbers& first = codes[list * codes.size() / content.lists];
    std::copy(first.begin(), first.end(), content.centroids.begin() + static_cast<std::ptrdiff_t>(list * kCodeNumbers));
  }
  for (int round = 0; round < kRounds; ++round) moveCentroids(content, codes);
}

// ---- all of it ---------------------------------------------------------------------------------------------------

class Trainer {
 public:
  Trainer(const TrainOptions& options, BuildListener& listener) : options_(options), listener_(listener) {}

  Result<TrainReport> train() {
    Result<ModelFolder> folder = listModels(options_.models);
    if (!folder.ok()) return folder.status;
    folder_ = std::move(folder.value);
    leaveOut();
    Status status = parts_.open(options_.out, false);
    if (!status.ok()) return status;
    status = render();
    if (status.ok()) status = collect();
    if (status.ok()) learn();
    if (status.ok()) status = calibrateIt();
    if (status.ok()) status = write();
    parts_.remove();
    if (!status.ok()) return status;
    return std::move(report_);
  }

 private:
  void leaveOut() {
    const auto unwanted = [&](const ModelFile& model) {
      return std::count(options_.without.begin(), options_.without.end(), model.category) > 0;
    };
    folder_.models.erase(std::remove_if(folder_.models.begin(), folder_.models.end(), unwanted), folder_.models.end());
  }

  ViewChoice choice() const { return {options_.views_every, true, false}; }

  Status render() {
    const std::string parts = parts_.path();
    RenderWork work{folder_, parts, listener_};
    work.jobs = options_.jobs;
    work.choice = choice();
    work.parameters = binsParameters(options_.params);
    work.mesh_limits = options_.mesh_limits;
    work.makeEncode = [this] { return encodeBins(options_.params); };
    return renderModels(work, died_);
  }

  Status collect() {
    std::set<std::string> categories;
    for (std::size_t i = 0; i < folder_.models.size(); ++i) {
      const ModelFile& file = folder_.models[i];
      Result<ModelViews> shard =
          readShard(shardPath(parts_.path(), file), originOf(file, binsParameters(options_.params), choice()));
      const auto died = died_.find(static_cast<int>(i));
      if (!shard.ok()) shard.value.refusal = died == died_.end() ? shard.status.sentence : died->second;
      if (!shard.ok() || shard.value.views.empty()) {
        report_.skipped.push_back({file.file, shard.value.refusal});
        continue;
      }
      categories.insert(file.category);
      lessons_.views += shard.value.views.size();
      lessons_.models.push_back({file.category, file.name, {}, {}, 0, std::move(shard.value.views)});
      lessons_.calibration.push_back(std::move(shard.value.calibration));
    }
    lessons_.categories.assign(categories.begin(), categories.end());
    report_.categories = static_cast<int>(categories.size());
    report_.models = static_cast<int>(lessons_.models.size());
    report_.views = static_cast<int>(lessons_.views);
    if (categories.size() >= 2 && lessons_.views >= kCodeNumbers) return {};
    return Status::nothingFound(options_.models + " has views: " + std::to_string(lessons_.views) +
                                ", categories: " + std::to_string(categories.size()) +
                                "; a projection is learnt from two categories and " + std::to_string(kCodeNumbers) +
                                " views at least");
  }

  void learn() {
    content_.params = options_.params;
    content_.lists = options_.lists;
    content_.views = static_cast<std::uint32_t>(lessons_.views);
    content_.models = static_cast<std::uint32_t>(lessons_.models.size());
    content_.categories = static_cast<std::uint32_t>(lessons_.categories.size());
    const ForEachView for_each_view = [this](const TakeView& take) {
      for (const ModelRecord& model : lessons_.models) {
        for (const ViewRecord& view : model.views) take(model.category, view.code.data());
      }
    };
    IntegerMap map = learnDiscriminants(for_each_view, kDepthBins, static_cast<int>(kCodeNumbers), options_.shrinkage);
    content_.matrix = std::move(map.matrix);
    content_.bias = std::move(map.bias);
    content_.factor_q24 = std::move(map.factor_q24);
    learnLists(content_, lessons_);
  }

  /// As a build calibrates an index, on an index of the views that were learnt from.
  Status calibrateIt() {
    content_.calibration = builtInCalibration({});
    const auto projection = projectionOf(content_);
    const std::vector<std::uint8_t> codes = codesOf(lessons_, *projection);
    IndexContent library;
    library.profile.projection = projection;
    library.directions.assign(viewDirections().begin(), viewDirections().end());
    library.models = lessons_.models;
    std::size_t at = 0;
    for (ModelRecord& model : library.models) {
      for (ViewRecord& view : model.views) {
        view.code.assign(codes.begin() + static_cast<std::ptrdiff_t>(at),
                         codes.begin() + static_cast<std::ptrdiff_t>(at + kCodeBytes));
        at += kCodeBytes;
      }
    }
    const std::string draft = parts_.path() + "/draft.vxi";
    const Status status = writeIndex(library, draft);
    if (!status.ok()) return status;
    const auto index = Index::open(draft);
    if (!index.ok()) return index.status;
    content_.calibration = calibrate(index.value, queriesFor(*index.value, *projection));
    report_.calibration_samples = static_cast<int>(content_.calibration.samples);
    return {};
  }

  std::vector<CalibrationQuery> queriesFor(const Index& index, const Projection& projection) const {
    std::map<std::pair<std::string, std::string>, std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < index.models().size; ++i) {
      numbers[{std::string(index.categoryName(index.models()[i].category)), std::string(index.modelName(i))}] = i;
    }
    std::vector<CalibrationQuery> queries;
    DepthBins bins;
    for (std::size_t i = 0; i < lessons_.models.size(); ++i) {
      if (lessons_.calibration[i].empty()) continue;
      std::copy(lessons_.calibration[i].begin(), lessons_.calibration[i].end(), bins.begin());
      std::vector<std::uint8_t> code(kCodeBytes);
      projection.project(bins, kCodeBytes, code.data());
      queries.push_back({numbers[{lessons_.models[i].category, lessons_.models[i].name}], std::move(code)});
    }
    return queries;
  }

  Status write() {
    const std::vector<std::uint8_t> bytes = serialised(content_);
    report_.bytes = bytes.size();
    return writeWhole(options_.out, std::string(bytes.begin(), bytes.end()));
  }

  const TrainOptions& options_;
  BuildListener& listener_;
  ModelFolder folder_;
  PartsFolder parts_;
  std::map<int, std::string> died_;
  Lessons lessons_;
  ProjectionContent content_;
  TrainReport report_;
};

}  // namespace

Result<TrainReport> trainProjection(const TrainOptions& options, BuildListener& listener) {
  return Trainer(options, listener).train();
}

}  // namespace voxid
