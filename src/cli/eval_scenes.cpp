// SPDX-License-Identifier: BSD-3-Clause
#include "eval_scenes.h"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <map>
#include <numeric>
#include <optional>

#include "compare_views.h"
#include "counted.h"
#include "evaluation.h"
#include "look_alikes.h"
#include "nearest_codes.h"
#include "scene_objects.h"
#include "voxid/geometry/longest_extent.h"
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

Result<std::vector<Choice>> choicesOf(const Index& index, const std::string& categories) {
  std::vector<Choice> choices{{"all", {}}};
  if (categories.empty()) return choices;
  auto allowed = readAllowedCategories(categories, index);
  if (!allowed.ok()) return allowed.status;
  choices.push_back({"listed", std::move(allowed.value)});
  return choices;
}

/// What counts as right.
struct Level {
  std::function<std::string(const std::string&)> class_of;               ///< of an object's first right name
  std::function<bool(const std::string&, const std::string&)> is_right;  ///< a right name; the answer
};

Level byCategory() {
  return {[](const std::string& name) { return name; }, std::equal_to<std::string>()};
}

Level byShape(const LookAlikes& look_alikes) {
  const auto group_of = [&look_alikes](const std::string& name) {
    const auto found = look_alikes.find(name);
    return found == look_alikes.end() ? name : found->second;
  };
  return {group_of, [group_of](const std::string& a, const std::string& b) { return group_of(a) == group_of(b); }};
}

Level bySynset(const SynsetPaths& paths) {
  return {[](const std::string& name) { return name; },
          [&paths](const std::string& a, const std::string& b) { return sameOrAbove(paths, a, b); }};
}

struct Tally {
  int objects = 0, right = 0, in_five = 0;
  std::map<std::string, int> wrong;  ///< labels

  void add(const Level& level, const SceneObject& object, const std::vector<std::string>& answers) {
    ++objects;
    const auto isRight = [&](const std::string& answer) {
      return std::any_of(object.right.begin(), object.right.end(),
                         [&](const std::string& name) { return level.is_right(name, answer); });
    };
    const std::string first = answers.empty() ? "" : answers[0];
    if (isRight(first))
      ++right;
    else
      ++wrong[first];
    in_five += std::any_of(answers.begin(), answers.end(), isRight);
  }
};

/// The first five.
std::vector<std::string> namesOf(const Index& index, const Answer& answer) {
  std::vector<std::string> names;
  for (int i = 0; i < std::min(answer.count, 5); ++i)
    names.emplace_back(index.categoryName(answer.alternatives[static_cast<std::size_t>(i)].category));
  return names;
}

double percent(int part, int whole) { return rounded(100.0 * part / whole); }

/// By class.
using Tallies = std::map<std::string, Tally>;

void add(const Level& level, const SceneObject& object, const std::vector<std::string>& answers, Tallies& tallies) {
  tallies[level.class_of(object.right[0])].add(level, object, answers);
}

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

/// What makes two categories as good as one.
struct Likeness {
  LookAlikes look_alikes;
  SynsetPaths synsets;
};

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
Result<Answer> answerFor(const Index& index, const ObservedObject& object, const Nearest& found,
                         const CodeSearch& search, AlignedNaming* naming) {
  if (naming == nullptr) return classify(index, found, ClassifyMethod::Vote, 0);
  auto candidates = naming->candidates(search.query(), found);
  if (!candidates.ok()) return candidates.status;
  naming->sketch(object, candidates.value);
  return naming->name(found, candidates.value, 0);
}

/// What is asked of every descriptor.
struct Questions {
  const Index& index;
  const SceneObjects& scenes;
  const std::vector<Choice>& choices;
  const Likeness& likeness;
};

/// The answers of one row, counted.
class Counts {
 public:
  Counts(const Index& index, const Likeness& likeness)
      : index_(index),
        likeness_(likeness),
        by_shape_(byShape(likeness.look_alikes)),
        by_synset_(bySynset(likeness.synsets)) {}

  void add(const SceneObject& object, const Answer& vote, const Answer& nearest) {
    const std::vector<std::string> names = namesOf(index_, vote);
    cli::add(by_category_, object, names, all_);
    cli::add(by_shape_, object, names, merged_);
    cli::add(by_synset_, object, names, synsets_);
    cli::add(by_category_, object, namesOf(index_, nearest), by_nearest_);
  }

  void write(int objects, Json& row) const {
    row["objects"] = objects;
    row.update(figuresOf(all_));
    row["nearest"] = figuresOf(by_nearest_);
    row["merged"] = figuresOf(merged_);
    row["synsets"] = likeness_.synsets.empty() ? Json(nullptr) : figuresOf(synsets_);
    row["classes"] = classesOf(all_);
  }

 private:
  const Index& index_;
  const Likeness& likeness_;
  const Level by_category_ = byCategory(), by_shape_, by_synset_;
  Tallies all_, merged_, synsets_, by_nearest_;
};

/// All objects by one descriptor, mask and choice.
Result<Json> rowOf(const Questions& questions, CodeSearch& search, std::pair<const char*, Mask> mask,
                   const Choice& choice, const Evidence& evidence) {
  const Index& index = questions.index;
  Counts counts(index, questions.likeness);
  Segmenter segmenter;
  LongestExtent extent;
  AllowedCategories fitting;
  for (const SceneObject& object : questions.scenes.objects) {
    const auto& pixels = mask.second == Mask::True ? object.true_pixels : object.own_pixels;
    const DepthView depth = object.depth->view();
    const Span<const std::uint32_t> shown{pixels.data(), pixels.size()};
    if (evidence.sizes) evidence.sizes->find(extent.of_mm(depth, shown), choice.allowed, &fitting);
    const Nearest* const found = search.find(depth, shown, evidence.sizes ? fitting : choice.allowed);
    const SupportPlane support = evidence.naming ? supportIn(depth, segmenter) : SupportPlane{};
    const auto answer =
        found ? answerFor(index, {depth, shown, support}, *found, search, evidence.naming) : Result<Answer>(Answer{});
    if (!answer.ok()) return answer.status;
    counts.add(object, answer.value, found ? classify(index, *found, ClassifyMethod::OneNn, 0) : Answer{});
  }
  Json row{{"descriptor", search.code().name}, {"mask", mask.first}, {"choice", choice.name}};
  counts.write(static_cast<int>(questions.scenes.objects.size()), row);
  return row;
}

Status addRows(const Questions& questions, CodeSearch search, const Evidence& evidence, Json& rows) {
  for (const auto& mask : kMasks) {
    for (const Choice& choice : questions.choices) {
      auto row = rowOf(questions, search, mask, choice, evidence);
      if (!row.ok()) return row.status;
      rows.push_back(std::move(row.value));
    }
  }
  return {};
}

/// The index's own descriptor on all its views.
Status addOwnRows(const Questions& questions, const Evidence& evidence, Json& rows) {
  const Index& index = questions.index;
  const auto code = ownCode(index);
  std::vector<std::uint32_t> views(index.viewCount());
  std::iota(views.begin(), views.end(), 0u);
  const auto code_at = [&](std::size_t view) { return index.code(static_cast<std::uint32_t>(view)); };
  return addRows(questions, CodeSearch(index, *code, views, code_at), evidence, rows);
}

/// Every compared descriptor on the same views.
Status addComparedRows(const Questions& questions, const CompareOptions& options, const SizeTable* sizes, Json& rows) {
  const Index& index = questions.index;
  const auto compared = describeViews(index, options.models, options.every, options.jobs);
  if (!compared.ok()) return compared.status;
  const auto codes = comparedCodes(index);
  for (std::size_t i = 0; i < codes.size(); ++i) {
    CodeSearch search(index, *codes[i], compared.value.views, compared.value.codesOf(i));
    const Status status = addRows(questions, std::move(search), {sizes}, rows);
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
  const auto look_alikes = readLookAlikes(options.look_alikes);
  if (!look_alikes.ok()) return look_alikes.status;
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
  const SizeTable table(*index, options.evidence.confirmed);
  const SizeTable* const sizes = options.evidence.size() ? &table : nullptr;
  std::optional<AlignedNaming> naming;
  if (options.evidence.align()) naming.emplace(index, options.models);
  const Likeness likeness{look_alikes.value, synsetPathsOf(*index)};
  const Questions questions{*index, scenes.value, choices.value, likeness};
  const Status status = options.comparing ? addComparedRows(questions, options.compare, sizes, json["rows"])
                                          : addOwnRows(questions, {sizes, naming ? &*naming : nullptr}, json["rows"]);
  if (!status.ok()) return status;
  return json;
}

namespace {

std::string textOf(const Json& figures) {
  char text[100];
  std::snprintf(text, sizeof text, "top-1 %.2f %%, mean of the classes %.2f %%, top-5 %.2f %%",
                figures["top1"].get<double>(), figures["mean_category"].get<double>(), figures["top5"].get<double>());
  return text;
}

void printRow(const Json& row) {
  std::printf("\n%s, mask %s, categories %s: %s\n", row["descriptor"].get<std::string>().c_str(),
              row["mask"].get<std::string>().c_str(), row["choice"].get<std::string>().c_str(), textOf(row).c_str());
  std::printf("  by the nearest view alone: %s\n", textOf(row["nearest"]).c_str());
  std::printf("  shapes that look alike as one: %s\n", textOf(row["merged"]).c_str());
  if (!row["synsets"].is_null()) std::printf("  as synsets: %s\n", textOf(row["synsets"]).c_str());
  for (const Json& c : row["classes"]) {
    std::printf("  %-12s %12s %8.2f %% %8.2f %% in five   mostly taken for %s\n", c["class"].get<std::string>().c_str(),
                counted(c["objects"].get<unsigned>(), "object").c_str(), c["top1"].get<double>(),
                c["top5"].get<double>(), c["mostly_taken_for"].get<std::string>().c_str());
  }
}

}  // namespace

void printScenes(const Json& result) {
  std::printf("%s, %s that stand alone, %d of them found by the segmentation; each %d. view of the index\n",
              counted(result["scenes"].get<unsigned>(), "scene").c_str(),
              counted(result["objects"].get<unsigned>(), "object").c_str(), result["segmented"].get<int>(),
              result["every"].get<int>());
  for (const auto& [category, count] : result["left_out"].items())
    std::printf("left out: %s, %s: no such category in the index\n", category.c_str(),
                counted(count.get<unsigned>(), "object").c_str());
  for (const Json& row : result["rows"]) printRow(row);
}

}  // namespace voxid::cli
