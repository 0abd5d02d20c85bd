// SPDX-License-Identifier: BSD-3-Clause
#include "eval_memory.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "counted.h"
#include "evaluation.h"
#include "voxid/core/crc32c.h"
#include "voxid/core/evidence.h"
#include "voxid/library/mesh_reader.h"
#include "voxid/library/sensor_model.h"

namespace voxid::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 12;
constexpr std::array<int, 5> kAccumulated{1, 2, 3, 6, 12};

/// From the camera's frame on a circle round the model, which is centred and has a diagonal of 1.
Placement placeOf(int frame, std::uint32_t draw) {
  constexpr double kAbove = 35 * M_PI / 180;
  constexpr std::uint32_t kLeastDiagonal_mm = 120, kDiagonals_mm = 261, kLeastDistance_mm = 650, kDistances_mm = 501;
  const double around = 2 * M_PI * frame / kFrames;
  const Eigen::Vector3d forward =
      -Eigen::Vector3d(std::cos(kAbove) * std::sin(around), std::sin(kAbove), std::cos(kAbove) * std::cos(around));
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitY()).normalized();
  Placement pose;
  pose.rotation.row(0) = right.cast<float>();
  pose.rotation.row(1) = forward.cross(right).cast<float>();
  pose.rotation.row(2) = forward.cast<float>();
  pose.translation = {0, 0, static_cast<float>(kLeastDistance_mm + draw / kDiagonals_mm % kDistances_mm)};
  pose.scale = static_cast<float>(kLeastDiagonal_mm + draw % kDiagonals_mm);
  return pose;
}

/// Of one model: how often the answer was right, over all starts on the circle.
struct Seen {
  int by_vote = 0;                                ///< of one frame
  std::array<int, kAccumulated.size()> next{};    ///< of so many, each 30 degrees after the one before
  std::array<int, kAccumulated.size()> spread{};  ///< of so many, evenly round the circle
};

struct ModelPath {
  std::string category, name, path;
};

/// What a search found in one frame, kept.
struct Found {
  std::vector<Neighbour> views, categories;
  Answer answer;

  Nearest nearest() const { return {{views.data(), views.size()}, {categories.data(), categories.size()}, 0}; }
};

/// One object a thread.
class Observer {
 public:
  Observer(std::shared_ptr<const Index> index, const SearchChoice& search)
      : recogniser_(index, search), evidence_(index->categories().size) {}

  Status observe(const ModelPath& model, Seen& seen) {
    const auto mesh = readMeshFile(model.path);
    if (!mesh.ok()) return mesh.status;
    RayScene scene;
    scene.add(mesh.value, unitPlacement(mesh.value));
    scene.commit();
    const std::uint32_t draw = crc32c(model.name.data(), model.name.size());
    for (int frame = 0; frame < kFrames; ++frame) {
      const DepthImage image = voxid::observe(scene, Imager(), placeOf(frame, draw), SensorParams(),
                                              draw + static_cast<std::uint64_t>(frame));
      find(image, found_[static_cast<std::size_t>(frame)]);
    }
    for (int start = 0; start < kFrames; ++start) goRound(model.category, start, seen);
    return {};
  }

 private:
  void find(const DepthImage& image, Found& found) {
    found = {};
    const std::vector<std::uint32_t> pixels = image.setPixels();
    const Nearest* const nearest = recogniser_.nearest(image.view(), {pixels.data(), pixels.size()});
    if (nearest == nullptr) return;
    found.views.assign(nearest->views.begin(), nearest->views.end());
    found.categories.assign(nearest->categories.begin(), nearest->categories.end());
    found.answer = classify(recogniser_.index(), *nearest, ClassifyMethod::Vote, 0);
  }

  void goRound(const std::string& category, int start, Seen& seen) {
    seen.by_vote += isRight(found_[static_cast<std::size_t>(start)].answer, category);
    for (std::size_t i = 0; i < kAccumulated.size(); ++i) {
      seen.next[i] += isRightAfter(category, start, kAccumulated[i], 1);
      seen.spread[i] += isRightAfter(category, start, kAccumulated[i], kFrames / kAccumulated[i]);
    }
  }

  /// `count` frames of the circle from `start` on, `stride` places apart.
  bool isRightAfter(const std::string& category, int start, int count, int stride) {
    evidence_.clear();
    for (int i = 0; i < count; ++i) {
      const Found& found = found_[static_cast<std::size_t>((start + i * stride) % kFrames)];
      evidence_.add(recogniser_.index(), found.nearest(), found.answer);
    }
    return isRight(evidence_.answer(recogniser_.index(), 0, 0), category);
  }

  bool isRight(const Answer& answer, const std::string& category) const {
    return answer.count > 0 && recogniser_.index().categoryName(answer.alternatives[0].category) == category;
  }

  Recogniser recogniser_;
  Evidence evidence_;
  std::array<Found, kFrames> found_;
};

/// The models of the index's categories, by category, then file; of those `count`, evenly chosen.
Result<std::vector<ModelPath>> chosenModels(const Index& index, const std::string& folder, int count) {
  std::vector<ModelPath> models;
  for (std::uint32_t i = 0; i < index.categories().size; ++i) {
    const std::string category(index.categoryName(i));
    std::error_code missing;
    std::vector<ModelPath> own;
    for (const auto& entry : fs::directory_iterator(fs::path(folder) / category, missing)) {
      if (isMeshFile(entry.path().string()))
        own.push_back({category, category + "/" + entry.path().filename().string(), entry.path().string()});
    }
    std::sort(own.begin(), own.end(), [](const ModelPath& a, const ModelPath& b) { return a.name < b.name; });
    models.insert(models.end(), own.begin(), own.end());
  }
  if (models.empty())
    return Status::nothingFound(folder + ": no mesh of a category of the index; expected <category>/<model>.<ext>");
  const auto wanted = std::min(models.size(), static_cast<std::size_t>(count));
  std::vector<ModelPath> chosen;
  for (std::size_t i = 0; i < wanted; ++i) chosen.push_back(models[i * models.size() / wanted]);
  return chosen;
}

Result<std::vector<Seen>> observeAll(const std::shared_ptr<const Index>& index, const std::vector<ModelPath>& models,
                                     const MemoryOptions& options) {
  std::vector<Seen> seen(models.size());
  std::vector<Status> statuses(models.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    Observer observer(index, options.search);
    for (std::size_t i = next++; i < models.size(); i = next++) statuses[i] = observer.observe(models[i], seen[i]);
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < options.jobs; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  const auto failed = std::find_if(statuses.begin(), statuses.end(), [](const Status& s) { return !s.ok(); });
  if (failed != statuses.end()) return *failed;
  return seen;
}

}  // namespace

Result<Json> evaluateMemory(const std::shared_ptr<const Index>& index, const MemoryOptions& options) {
  const auto models = chosenModels(*index, options.models, options.count);
  if (!models.ok()) return models.status;
  const auto seen = observeAll(index, models.value, options);
  if (!seen.ok()) return seen.status;
  Seen sum;
  for (const Seen& one : seen.value) {
    sum.by_vote += one.by_vote;
    for (std::size_t i = 0; i < kAccumulated.size(); ++i) {
      sum.next[i] += one.next[i];
      sum.spread[i] += one.spread[i];
    }
  }
  const double asked = static_cast<double>(models.value.size()) * kFrames;
  Json json{
      {"models", models.value.size()}, {"frames", kFrames}, {"one_frame_vote", rounded(100 * sum.by_vote / asked)}};
  json["rows"] = Json::array();
  for (std::size_t i = 0; i < kAccumulated.size(); ++i) {
    json["rows"].push_back({{"frames", kAccumulated[i]},
                            {"top1", rounded(100 * sum.next[i] / asked)},
                            {"minus_vote", rounded(100 * (sum.next[i] - sum.by_vote) / asked)},
                            {"spread_top1", rounded(100 * sum.spread[i] / asked)},
                            {"spread_minus_vote", rounded(100 * (sum.spread[i] - sum.by_vote) / asked)}});
  }
  return json;
}

void printMemory(const Json& result) {
  std::printf("%s, each from %d places on a circle; one frame by vote: %.2f %% named rightly\n",
              counted(result["models"].get<std::size_t>(), "model").c_str(), result["frames"].get<int>(),
              result["one_frame_vote"].get<double>());
  std::printf("            next to each other   evenly round the circle\n");
  for (const Json& row : result["rows"]) {
    std::printf("%9s  %6.2f %%  %+6.2f   %6.2f %%  %+6.2f\n", counted(row["frames"].get<unsigned>(), "frame").c_str(),
                row["top1"].get<double>(), row["minus_vote"].get<double>(), row["spread_top1"].get<double>(),
                row["spread_minus_vote"].get<double>());
  }
}

}  // namespace voxid::cli
