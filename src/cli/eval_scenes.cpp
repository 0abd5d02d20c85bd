// SPDX-License-Identifier: BSD-3-Clause
#include "eval_scenes.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <numeric>
#include <optional>

#include "compare_views.h"
#include "evaluation.h"
#include "nearest_codes.h"
#include "scene_objects.h"
#include "voxid/geometry/segmenter.h"

namespace voxid::cli {
namespace {

enum class Mask { True, Own };
constexpr std::pair<const char*, Mask> kMasks[] = {{"true", Mask::True}, {"own", Mask::Own}};

/// Which categories may be answers.
struct Choice {
  const char* name;
  AllowedCategories allowed;
};

Result<AllowedCategories> readAllowed(const Index& index, const std::string& path) {
  std::ifstream file(path);
  if (!file)
    return Status::cannotDo(path + ": cannot be read; --categories expects a file of category names, one a line");
  AllowedCategories allowed(index.categories().size);
  for (std::string line; std::getline(file, line);) {
    const std::size_t end = line.find_last_not_of(" \t\r");
    line.resize(end == std::string::npos ? 0 : end + 1);
    for (std::uint32_t i = 0; i < allowed.size(); ++i) {
      if (index.categoryName(i) == line) allowed[i] = true;
    }
  }
  if (std::find(allowed.begin(), allowed.end(), true) == allowed.end()) {
    return Status::cannotDo(path + ": none of its categories is in the index; expected names, one a line");
  }
  return allowed;
}

Result<std::vector<Choice>> choicesOf(const Index& index, const std::string& categories) {
  std::vector<Choice> choices{{"all", {}}};
  if (categories.empty()) return choices;
  auto allowed = readAllowed(index, categories);
  if (!allowed.ok()) return allowed.status;
  choices.push_back({"listed", std::move(allowed.value)});
  return choices;
}

bool isRight(const SceneObject& object, std::string_view label) {
  return std::find(object.right.begin(), object.right.end(), label) != object.right.end();
}

struct Tally {
  int objects = 0, right = 0, in_five = 0;
  std::map<std::string, int> wrong;  ///< labels

  void add(const Index& index, const SceneObject& object, const Answer& answer) {
    ++objects;
    const auto labelAt = [&](int i) {
      return index.categoryName(answer.alternatives[static_cast<std::size_t>(i)].category);
    };
    const std::string label(answer.count > 0 ? labelAt(0) : "");
    if (isRight(object, label))
      ++right;
    else
      ++wrong[label];
    bool met = false;
    for (int i = 0; i < std::min(answer.count, 5); ++i) met |= isRight(object, labelAt(i));
    in_five += met;
  }
};

double percent(int part, int whole) { return rounded(100.0 * part / whole); }

/// By class, which is an object's first right name.
using Tallies = std::map<std::string, Tally>;

std::string mostFrequent(const std::map<std::string, int>& counts) {
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == counts.end() ? std::string() : most->first;
}

Json figuresOf(const Tallies& tallies) {
  int objects = 0, right = 0, in_five = 0;
  double shares = 0;
  for (const auto& [name, tally] : tallies) {
    objects += tally.objects;
    right += tally.right;
    in_five += tally.in_five;
    shares += 100.0 * tally.right / tally.objects;
  }
  Json figures;
  figures["objects"] = objects;
  figures["top1"] = percent(right, objects);
  figures["mean_category"] = rounded(shares / static_cast<double>(tallies.size()));
  figures["top5"] = percent(in_five, objects);
  return figures;
}

Json classesOf(const Tallies& tallies) {
  Json classes = Json::array();
  for (const auto& [name, tally] : tallies) {
    classes.push_back({{"class", name},
                       {"objects", tally.objects},
                       {"top1", percent(tally.right, tally.objects)},
                       {"top5", percent(tally.in_five, tally.objects)},
                       {"mostly_taken_for", mostFrequent(tally.wrong)}});
  }
  return classes;
}

/// What counts beside the codes; null: does not.
struct Evidence {
  const SizeTable* sizes = nullptr;
  AlignedNaming* naming = nullptr;
};

/// The table under the objects, where the segmentation finds it.
SupportPlane supportIn(const DepthView& depth, Segmenter& segmenter) {
  const Scene& scene = segmenter.segment(depth, SegmentParams{});
  return scene.status == SceneStatus::Ok ? SupportPlane{scene.table.normal, 1000 * scene.table.distance_m}
                                         : SupportPlane{};
}

/// By vote, or by models aligned with the object.
Result<Answer> answerFor(const Index& index, const ObservedObject& object, const Nearest& found, const CodeSearch& search,
                         AlignedNaming* naming) {
  if (naming == nullptr) return classify(index, found, ClassifyMethod::Vote, 0);
  auto candidates = naming->candidates(search.query(), found);
  if (!candidates.ok()) return candidates.status;
  naming->sketch(object, candidates.value);
  return naming->name(found, candidates.value, 0);
}

/// All objects by one descriptor, mask and choice.
Result<Json> rowOf(const Index& index, const SceneObjects& scenes, CodeSearch& search,
                   std::pair<const char*, Mask> mask, const Choice& choice, const Evidence& evidence) {
  Tallies all, by_nearest;
  Segmenter segmenter;
  for (const SceneObject& object : scenes.objects) {
    const auto& pixels = mask.second == Mask::True ? object.true_pixels : object.own_pixels;
    const DepthView depth = object.depth->view();
    const Span<const std::uint32_t> shown{pixels.data(), pixels.size()};
    const AllowedCategories allowed =
        evidence.sizes ? evidence.sizes->allowed(longestExtent_mm(depth, shown), choice.allowed) : choice.allowed;
    const Nearest* const found = search.find(depth, shown, allowed);
    const SupportPlane support = evidence.naming ? supportIn(depth, segmenter) : SupportPlane{};
    const auto answer =
        found ? answerFor(index, {depth, shown, support}, *found, search, evidence.naming) : Result<Answer>(Answer{});
    if (!answer.ok()) return answer.status;
    all[object.right[0]].add(index, object, answer.value);
    by_nearest[object.right[0]].add(index, object,
                                    found ? classify(index, *found, ClassifyMethod::OneNn, 0) : Answer{});
  }
  Json row{{"descriptor", search.code().name}, {"mask", mask.first}, {"choice", choice.name}};
  row.update(figuresOf(all));
  row["nearest"] = figuresOf(by_nearest);
  row["nearest"].erase("objects");
  row["classes"] = classesOf(all);
  return row;
}

Status addRows(const Index& index, const SceneObjects& scenes, CodeSearch search, const std::vector<Choice>& choices,
               const Evidence& evidence, Json& rows) {
  for (const auto& mask : kMasks) {
    for (const Choice& choice : choices) {
      auto row = rowOf(index, scenes, search, mask, choice, evidence);
      if (!row.ok()) return row.status;
      rows.push_back(std::move(row.value));
    }
  }
  return {};
}

/// The index's own descriptor on all its views.
Status addOwnRows(const Index& index, const SceneObjects& scenes, const std::vector<Choice>& choices,
                  const Evidence& evidence, Json& rows) {
  const auto code = ownCode(index);
  std::vector<std::uint32_t> views(index.viewCount());
  std::iota(views.begin(), views.end(), 0u);
  const auto code_at = [&](std::size_t view) { return index.code(static_cast<std::uint32_t>(view)); };
  return addRows(index, scenes, CodeSearch(index, *code, views, code_at), choices, evidence, rows);
}

/// Every compared descriptor on the same views.
Status addComparedRows(const Index& index, const SceneObjects& scenes, const CompareOptions& options,
                       const std::vector<Choice>& choices, const SizeTable* sizes, Json& rows) {
  const auto compared = describeViews(index, options.models, options.every, options.jobs);
  if (!compared.ok()) return compared.status;
  const auto codes = comparedCodes(index);
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const Status status = addRows(
        index, scenes, CodeSearch(index, *codes[i], compared.value.views, compared.value.codesOf(i)), choices, {sizes}, rows);
    if (!status.ok()) return status;
  }
  return {};
}

}  // namespace

Result<Json> evaluateScenes(const std::shared_ptr<const Index>& index, const SceneOptions& options) {
  const auto aliases = readAliases(options.aliases);
  if (!aliases.ok()) return aliases.status;
  const auto choices = choicesOf(*index, options.categories);
  if (!choices.ok()) return choices.status;
  const auto scenes = readSceneObjects(options.folder, *index, aliases.value);
  if (!scenes.ok()) return scenes.status;
  Json json;
  json["scenes"] = scenes.value.scenes;
  json["objects"] = scenes.value.objects.size();
  json["left_out"] = scenes.value.left_out;
  json["segmented"] = std::count_if(scenes.value.objects.begin(), scenes.value.objects.end(),
                                    [](const SceneObject& o) { return !o.own_pixels.empty(); });
  json["every"] = options.comparing ? options.compare.every : 1;
  json["evidence"] = options.evidence.names;
  json["rows"] = Json::array();
  const SizeTable table(*index);
  const SizeTable* const sizes = options.evidence.size() ? &table : nullptr;
  std::optional<AlignedNaming> naming;
  if (options.evidence.align()) naming.emplace(index, options.models);
  const Status status =
      options.comparing
          ? addComparedRows(*index, scenes.value, options.compare, choices.value, sizes, json["rows"])
          : addOwnRows(*index, scenes.value, choices.value, {sizes, naming ? &*naming : nullptr}, json["rows"]);
  if (!status.ok()) return status;
  return json;
}

void printScenes(const Json& result) {
  std::printf(
      "%d scenes, %d objects that stand alone, %d of them found by the segmentation; each %d. view of the index\n",
      result["scenes"].get<int>(), result["objects"].get<int>(), result["segmented"].get<int>(),
      result["every"].get<int>());
  for (const auto& [category, count] : result["left_out"].items())
    std::printf("left out: %s, %d objects: no such category in the index\n", category.c_str(), count.get<int>());
  for (const Json& row : result["rows"]) {
    std::printf(
        "\n%s, mask %s, categories %s: top-1 %.2f %%, mean of the classes %.2f %%, top-5 %.2f %%; by the nearest view "
        "alone %.2f, %.2f, %.2f\n",
        row["descriptor"].get<std::string>().c_str(), row["mask"].get<std::string>().c_str(),
        row["choice"].get<std::string>().c_str(), row["top1"].get<double>(), row["mean_category"].get<double>(),
        row["top5"].get<double>(), row["nearest"]["top1"].get<double>(), row["nearest"]["mean_category"].get<double>(),
        row["nearest"]["top5"].get<double>());
    for (const Json& c : row["classes"]) {
      std::printf("  %-12s %4d objects %8.2f %% %8.2f %% in five   mostly taken for %s\n",
                  c["class"].get<std::string>().c_str(), c["objects"].get<int>(), c["top1"].get<double>(),
                  c["top5"].get<double>(), c["mostly_taken_for"].get<std::string>().c_str());
    }
  }
}

}  // namespace voxid::cli
