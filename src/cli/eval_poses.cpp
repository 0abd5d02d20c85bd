// SPDX-License-Identifier: BSD-3-Clause
#include "eval_poses.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <functional>
#include <thread>

#include "../library/model_folder.h"
#include "../library/random.h"
#include "counted.h"
#include "cpu_time.h"
#include "evaluation.h"
#include "pcl_pose.h"
#include "pose_truth.h"
#include "voxid/library/mesh_reader.h"
#include "voxid/library/model_aligner.h"

namespace voxid::cli {
namespace {

/// The answer about one view.
struct PoseOutcome {
  PoseError given;  ///< by the right model
  PoseError asked;  ///< by the model that was found; far off if it is another
  double given_ms = 0, asked_ms = 0;
  bool model_right = false;
  double diagonal_off = 1;  ///< of the found model's box from the truth, a share
  double normalised = -1;   ///< the error squared in deviations (of Alignment::covariance); -1: not near the truth
};

ObservedObject objectIn(const PosedView& view) {
  ObservedObject object;
  object.depth = view.image.view();
  object.pixels = {view.pixels.data(), view.pixels.size()};
  return object;
}

/// A rotation farther off is another one that looks alike, of which a covariance about the found one knows nothing.
constexpr double kNearDeg = 5;

/// Draws views of models and asks for their poses.
class PoseExaminer {
 public:
  PoseExaminer(std::shared_ptr<const Index> index, const SearchChoice& search, const PoseOptions& options)
      : index_(std::move(index)), options_(options), recogniser_(index_, search), aligner_(index_, options.models) {}

  /// A member of the index, drawn by `number`.
  Result<PoseOutcome> askSeen(int number) {
    const Result<Member> member = draw(number);
    if (!member.ok()) return member.status;
    const auto& [model, shelved, view] = member.value;
    PoseOutcome outcome;
    align(view, *shelved, outcome);
    const auto ranked = ask(view, outcome);
    if (!ranked.ok()) return ranked.status;
    outcome.model_right = !ranked.value.empty() && ranked.value[0].model == model;
    if (outcome.model_right) outcome.asked = errorIn(ranked.value[0].alignment, view, *shelved);
    return outcome;
  }

  /// The same view, by PCL, given the right model and its scale: only `given` and `given_ms`.
  Result<PoseOutcome> askPcl(int number) {
    const Result<Member> member = draw(number);
    if (!member.ok()) return member.status;
    const auto& [model, shelved, view] = member.value;
    const ModelSurface& surface = shelved->model.surface();
    const PclPose found = poseByPcl(objectIn(view), surface, view.pose.scale, static_cast<unsigned>(number));
    PoseOutcome outcome;
    outcome.given_ms = 1e-3 * found.us;
    if (found.pose) outcome.given = errorOf(*found.pose, view.pose, surface, shelved->symmetry());
    return outcome;
  }

  /// A view of a stranger, drawn by `number`.
  Result<PoseOutcome> askUnseen(const std::vector<ModelFile>& models, int number) {
    Random random(seedOf("unseen", options_.seed << 32 | static_cast<std::uint64_t>(number)));
    const auto mesh =
        readMeshFile(models[static_cast<std::size_t>(random.below(static_cast<int>(models.size())))].path);
    if (!mesh.ok()) return mesh.status;
    PoseOutcome outcome;
    const auto ranked = ask(drawPosedView(mesh.value, random.next()), outcome);
    if (!ranked.ok()) return ranked.status;
    return outcome;
  }

 private:
  struct Member {
    std::uint32_t model = 0;
    std::shared_ptr<const ShelvedModel> shelved;
    PosedView view;
  };
  Result<Member> draw(int number) {
    Random random(seedOf("seen", options_.seed << 32 | static_cast<std::uint64_t>(number)));
    Member member;
    member.model = static_cast<std::uint32_t>(random.below(static_cast<int>(index_->models().size)));
    const auto path = meshOf(options_.models, fullNameOf(*index_, member.model));
    if (!path.ok()) return path.status;
    const auto mesh = readMeshFile(path.value);
    if (!mesh.ok()) return mesh.status;
    const auto shelved = aligner_.shelf().find(member.model);
    if (!shelved.ok()) return shelved.status;
    member.shelved = shelved.value;
    member.view = drawPosedView(mesh.value, random.next());
    return member;
  }

  static PoseError errorIn(const Alignment& alignment, const PosedView& view, const ShelvedModel& shelved) {
    if (!alignment.found) return {};
    return errorOf(alignment.pose, view.pose, shelved.model.surface(), shelved.symmetry());
  }

  void align(const PosedView& view, const ShelvedModel& shelved, PoseOutcome& outcome) {
    Alignment alignment;
    outcome.given_ms = 1e-3 * usOf([&] {
                         aligner_.aligner().observe(objectIn(view));
                         alignment = aligner_.aligner().align(shelved.model);
                       });
    outcome.given = errorIn(alignment, view, shelved);
    if (outcome.given.strict() && outcome.given.rotation_deg <= kNearDeg)
      outcome.normalised = normalisedError(alignment, view.pose, shelved.symmetry());
  }

  /// Reading the models is not counted: a robot has read them before.
  Result<std::vector<RankedModel>> ask(const PosedView& view, PoseOutcome& outcome) {
    std::vector<RankedModel> ranked;
    const Nearest* const found = recogniser_.nearest(view.image.view(), {view.pixels.data(), view.pixels.size()});
    if (found == nullptr) return ranked;
    for (const RankedModel& model : modelsOf(*index_, *found, ModelAligner::kModels)) {
      const auto read = aligner_.shelf().find(model.model);
      if (!read.ok()) return read.status;
    }
    outcome.asked_ms =
        1e-3 * usOf([&] {
          const Nearest* const again = recogniser_.nearest(view.image.view(), {view.pixels.data(), view.pixels.size()});
          ranked = aligner_.rank(objectIn(view), *again).value;
        });
    if (!ranked.empty() && ranked[0].alignment.found) {
      outcome.diagonal_off = std::abs(static_cast<double>(ranked[0].alignment.pose.scale / view.pose.scale) - 1);
    }
    return ranked;
  }

  std::shared_ptr<const Index> index_;
  const PoseOptions& options_;
  Recogniser recogniser_;
  ModelAligner aligner_;
};

using Outcomes = std::vector<PoseOutcome>;

double medianOf(const Outcomes& outcomes, const std::function<double(const PoseOutcome&)>& value) {
  std::vector<double> values;
  for (const PoseOutcome& outcome : outcomes) values.push_back(value(outcome));
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double shareOf(const Outcomes& outcomes, const std::function<bool(const PoseOutcome&)>& holds) {
  const auto count = std::count_if(outcomes.begin(), outcomes.end(), holds);
  return static_cast<double>(count) / static_cast<double>(outcomes.size());
}

double roundedShare(double share) { return std::round(share * 1e4) / 1e4; }

/// Mean of the squared errors in deviations, over the unknowns: 1 if covariances are what they claim.
Json covarianceFigure(const Outcomes& outcomes) {
  double sum = 0;
  int count = 0;
  for (const PoseOutcome& outcome : outcomes) {
    if (outcome.normalised < 0) continue;
    sum += outcome.normalised;
    ++count;
  }
  return count > 0 ? Json(rounded(sum / count / kPoseUnknowns)) : Json(nullptr);
}

Json seenFigures(const Outcomes& outcomes) {
  Json json;
  json["objects"] = outcomes.size();
  json["strict_given_model"] = roundedShare(shareOf(outcomes, [](const auto& o) { return o.given.strict(); }));
  json["strict"] = roundedShare(shareOf(outcomes, [](const auto& o) { return o.model_right && o.asked.strict(); }));
  json["model_right"] = roundedShare(shareOf(outcomes, [](const auto& o) { return o.model_right; }));
  json["rotation_deg_median"] = rounded(medianOf(outcomes, [](const auto& o) { return o.given.rotation_deg; }));
  json["translation_mm_median"] = rounded(medianOf(outcomes, [](const auto& o) { return o.given.translation_mm; }));
  json["scale_percent_median"] =
      rounded(medianOf(outcomes, [](const auto& o) { return std::abs(o.given.scale_percent); }));
  json["normalised_error_mean"] = covarianceFigure(outcomes);
  json["ms_given_model_median"] = rounded(medianOf(outcomes, [](const auto& o) { return o.given_ms; }));
  json["ms_median"] = rounded(medianOf(outcomes, [](const auto& o) { return o.asked_ms; }));
  return json;
}

Json unseenFigures(const Outcomes& outcomes) {
  Json json;
  json["objects"] = outcomes.size();
  json["extents_within_share"] = roundedShare(shareOf(outcomes, [](const auto& o) { return o.diagonal_off <= 0.1; }));
  json["ms_median"] = rounded(medianOf(outcomes, [](const auto& o) { return o.asked_ms; }));
  return json;
}

/// Asks an examiner about a view by its number.
using Ask = std::function<Result<PoseOutcome>(PoseExaminer& examiner, int number)>;

/// About numbers 0 to objects - 1, in their order, by some examiners, each in a thread.
Result<Outcomes> askAll(std::vector<PoseExaminer>& examiners, int objects, const Ask& ask) {
  Outcomes outcomes(static_cast<std::size_t>(objects));
  std::vector<Status> statuses(outcomes.size());
  std::atomic<int> next{0};
  const auto work = [&](PoseExaminer& examiner) {
    for (int i = next++; i < objects; i = next++) {
      Result<PoseOutcome> outcome = ask(examiner, i);
      statuses[static_cast<std::size_t>(i)] = outcome.status;
      outcomes[static_cast<std::size_t>(i)] = outcome.value;
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 1; i < examiners.size(); ++i) threads.emplace_back(work, std::ref(examiners[i]));
  work(examiners.front());
  for (std::thread& thread : threads) thread.join();
  const auto failed = std::find_if(statuses.begin(), statuses.end(), [](const Status& s) { return !s.ok(); });
  if (failed != statuses.end()) return *failed;
  return outcomes;
}

/// PCL and voxid on each `every`-th of the views that voxid was asked about. PCL draws from one generator for all
/// threads.
Result<Json> pclFigures(PoseExaminer& examiner, const Outcomes& seen, int every) {
  Outcomes by_pcl, by_voxid;
  for (std::size_t i = 0; i < seen.size(); i += static_cast<std::size_t>(every)) {
    const Result<PoseOutcome> outcome = examiner.askPcl(static_cast<int>(i));
    if (!outcome.ok()) return outcome.status;
    by_pcl.push_back(outcome.value);
    by_voxid.push_back(seen[i]);
  }
  const auto strict = [](const PoseOutcome& o) { return o.given.strict(); };
  const auto ms = [](const PoseOutcome& o) { return o.given_ms; };
  Json json;
  json["pairs"] = by_pcl.size();
  json["strict_given_model"] = roundedShare(shareOf(by_pcl, strict));
  json["voxid_strict_given_model"] = roundedShare(shareOf(by_voxid, strict));
  json["ms_median"] = rounded(medianOf(by_pcl, ms));
  json["voxid_ms_median"] = rounded(medianOf(by_voxid, ms));
  json["times_slower"] = rounded(medianOf(by_pcl, ms) / medianOf(by_voxid, ms));
  return json;
}

}  // namespace

Result<Json> evaluatePoses(const std::shared_ptr<const Index>& index, const SearchChoice& search,
                           const PoseOptions& options) {
  const Result<ModelFolder> strangers = listModels(options.unseen);
  if (!strangers.ok()) return strangers.status;
  const std::vector<ModelFile>& models = strangers.value.models;
  if (models.empty())
    return Status::nothingFound(options.unseen + ": no model in it; expected <category>/<model>.<ext>");
  std::vector<PoseExaminer> examiners;
  for (int i = 0; i < options.jobs; ++i) examiners.emplace_back(index, search, options);
  const auto seen =
      askAll(examiners, options.objects, [](PoseExaminer& examiner, int i) { return examiner.askSeen(i); });
  if (!seen.ok()) return seen.status;
  const auto unseen =
      askAll(examiners, options.objects, [&](PoseExaminer& examiner, int i) { return examiner.askUnseen(models, i); });
  if (!unseen.ok()) return unseen.status;
  Json json{{"seen", seenFigures(seen.value)}, {"unseen", unseenFigures(unseen.value)}};
  if (options.pcl_every == 0) return json;
  const auto pcl = pclFigures(examiners.front(), seen.value, options.pcl_every);
  if (!pcl.ok()) return pcl.status;
  json["pcl"] = pcl.value;
  return json;
}

void printPoses(const Json& result) {
  const Json &seen = result["seen"], &unseen = result["unseen"];
  const auto percent = [](const Json& share) { return 100 * share.get<double>(); };
  std::printf(
      "%s of members: given the model %.1f %% strict, %.0f ms; from the view alone the model %.1f %%, model "
      "and pose %.1f %%, %.0f ms\n",
      counted(seen["objects"].get<unsigned>(), "view").c_str(), percent(seen["strict_given_model"]),
      seen["ms_given_model_median"].get<double>(), percent(seen["model_right"]), percent(seen["strict"]),
      seen["ms_median"].get<double>());
  std::printf("median errors given the model: %.2f degrees, %.2f mm, scale %.2f %%\n",
              seen["rotation_deg_median"].get<double>(), seen["translation_mm_median"].get<double>(),
              seen["scale_percent_median"].get<double>());
  std::printf("%s of unseen models: box diagonal within 10 %%: %.1f %%, %.0f ms\n",
              counted(unseen["objects"].get<unsigned>(), "view").c_str(), percent(unseen["extents_within_share"]),
              unseen["ms_median"].get<double>());
  if (!result.contains("pcl")) return;
  const Json& pcl = result["pcl"];
  std::printf(
      "%d of the members' views, given model and true scale, by PCL: %.1f %% strict, %.0f ms; voxid, given the "
      "model, %.1f %%, %.0f ms: %.1f times faster\n",
      pcl["pairs"].get<int>(), percent(pcl["strict_given_model"]), pcl["ms_median"].get<double>(),
      percent(pcl["voxid_strict_given_model"]), pcl["voxid_ms_median"].get<double>(),
      pcl["times_slower"].get<double>());
}

}  // namespace voxid::cli
