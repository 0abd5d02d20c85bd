// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/index_editor.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <set>

#include "parts_folder.h"
#include "voxid/core/index.h"
#include "voxid/library/confidence_learner.h"

namespace voxid {
namespace {

using Name = std::pair<std::string, std::string>;  // category, model

std::string textOf(const Name& name) { return name.first + "/" + name.second; }

bool sameProfile(const Profile& a, const Profile& b) {
  const format::Parameters first = parametersOf(a), second = parametersOf(b);
  return std::memcmp(&first, &second, sizeof first) == 0;
}

bool sameDirections(const IndexContent& a, const IndexContent& b) {
  return a.directions.size() == b.directions.size() &&
         std::memcmp(a.directions.data(), b.directions.data(), a.directions.size() * sizeof(format::Direction)) == 0;
}

struct Synset {
  std::uint32_t offset = 0;
  std::string sense;
};
/// Each category's synset, where it has one.
using Synsets = std::map<std::string, Synset>;

Status addSynsets(Synsets& synsets, const IndexContent& content) {
  for (const ModelRecord& model : content.models) {
    if (model.synset == 0) continue;
    Synset& known = synsets.emplace(model.category, Synset{model.synset, model.sense}).first->second;
    if (known.sense.empty()) known.sense = model.sense;
    if (known.offset != model.synset) {
      return Status::cannotDo("category " + model.category + " has the synsets " + std::to_string(known.offset) + " and " +
                              std::to_string(model.synset) + "; give one of the two another name");
    }
  }
  return {};
}

/// Damaged if the index is.
Result<IndexContent> contentOf(const std::string& path) {
  const auto index = Index::open(path);
  if (!index.ok()) return index.status;
  const Status sound = index.value->verify();
  if (!sound.ok()) return sound;
  return readContent(*index.value);
}

/// Keeps other writers of an index away. What an interrupted build left for --resume stays.
class WriterLock {
 public:
  ~WriterLock() {
    if (held_ && !was_there_) parts_.remove();
  }
  Status lock(const std::string& index) {
    std::error_code ignored;
    was_there_ = std::filesystem::exists(index + ".parts", ignored);
    const Status status = parts_.open(index, true);
    held_ = status.ok();
    return status;
  }

 private:
  PartsFolder parts_;
  bool held_ = false, was_there_ = false;
};

/// In the folder that WriterLock makes.
std::string draftOf(const std::string& index) { return index + ".parts/draft.vxi"; }

Status edit(const std::string& path, const std::function<Status(IndexContent&)>& change) {
  WriterLock lock;
  Status status = lock.lock(path);
  if (!status.ok()) return status;
  Result<IndexContent> content = contentOf(path);
  status = content.status;
  if (content.ok()) status = change(content.value);
  return status.ok() ? writeWithConfidence(content.value, draftOf(path), path) : status;
}

}  // namespace

Status mergeInto(IndexContent& content, const IndexContent& other, Clash clash) {
  if (!sameProfile(content.profile, other.profile)) {
    return Status::cannotDo(
        "the descriptors differ; only indices of the same descriptor, settings and projection can be put together");
  }
  if (!sameDirections(content, other)) return Status::cannotDo("the view directions differ");
  Synsets synsets;
  for (const IndexContent* const part : {static_cast<const IndexContent*>(&content), &other}) {
    const Status status = addSynsets(synsets, *part);
    if (!status.ok()) return status;
  }
  std::set<Name> coming;
  for (const ModelRecord& model : other.models) coming.insert({model.category, model.name});
  const auto clashes = [&](const ModelRecord& model) { return coming.count({model.category, model.name}) > 0; };
  const auto clashing = std::find_if(content.models.begin(), content.models.end(), clashes);
  if (clash == Clash::Refuse && clashing != content.models.end()) {
    return Status::cannotDo("model " + textOf({clashing->category, clashing->name}) +
                            " is there already; --replace takes the new one");
  }
  content.models.erase(std::remove_if(content.models.begin(), content.models.end(), clashes), content.models.end());
  content.models.insert(content.models.end(), other.models.begin(), other.models.end());
  for (ModelRecord& model : content.models) {
    const auto known = synsets.find(model.category);
    const Synset synset = known == synsets.end() ? Synset{} : known->second;
    model.synset = synset.offset;
    model.sense = synset.sense;
  }
  if (other.calibration.samples > content.calibration.samples) content.calibration = other.calibration;
  return {};
}

Status removeFrom(IndexContent& content, const std::vector<std::string>& wanted) {
  const std::set<std::string> names(wanted.begin(), wanted.end());
  std::set<std::string> met;
  std::vector<ModelRecord> rest;
  for (const ModelRecord& model : content.models) {
    bool out = false;
    for (const std::string& name : {model.category, textOf({model.category, model.name})}) {
      if (names.count(name) == 0) continue;
      met.insert(name);
      out = true;
    }
    if (!out) rest.push_back(model);
  }
  for (const std::string& name : names) {
    if (met.count(name) == 0) return Status::nothingFound("there is no category or model " + name);
  }
  if (rest.empty()) return Status::nothingFound("no model would be left; delete the file instead");
  content.models = std::move(rest);
  return {};
}

Result<BuildReport> addModels(const BuildOptions& options, Clash clash, BuildListener& listener) {
  Result<BuildReport> report = BuildReport{};
  report.status = edit(options.out, [&](IndexContent& content) {
    BuildOptions extra = options;
    extra.profile = content.profile;
    extra.out = options.out + ".parts/added.vxi";
    report = buildIndex(extra, listener);
    if (!report.ok()) return report.status;
    const Result<IndexContent> added = contentOf(extra.out);
    std::error_code ignored;
    std::filesystem::remove(extra.out, ignored);
    return added.ok() ? mergeInto(content, added.value, clash) : added.status;
  });
  return report;
}

Status removeModels(const std::string& path, const std::vector<std::string>& wanted) {
  return edit(path, [&](IndexContent& content) {
    Status status = removeFrom(content, wanted);
    if (!status.ok()) status.sentence = path + ": " + status.sentence;
    return status;
  });
}

Status mergeIndices(const std::vector<std::string>& paths, const std::string& out, Clash clash) {
  WriterLock lock;
  Status status = lock.lock(out);
  if (!status.ok()) return status;
  Result<IndexContent> whole = contentOf(paths.at(0));
  status = whole.status;
  for (std::size_t i = 1; i < paths.size() && status.ok(); ++i) {
    const Result<IndexContent> part = contentOf(paths[i]);
    status = part.ok() ? mergeInto(whole.value, part.value, clash) : part.status;
    if (!status.ok() && part.ok()) status.sentence = paths[i] + ": " + status.sentence;
  }
  return status.ok() ? writeWithConfidence(whole.value, draftOf(out), out) : status;
}

}  // namespace voxid
