// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/index_editor.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <queue>
#include <set>
#include <tuple>

#include "parts_folder.h"
#include "voxid/core/index.h"
#include "voxid/library/confidence_learner.h"

namespace voxid {
namespace {

using Name = std::pair<std::string, std::string>;  // category, model

std::string textOf(const Name& name) { return name.first + "/" + name.second; }

Name nameOf(const Index& index, std::uint32_t model) {
  return {std::string(index.categoryName(index.models()[model].category)), std::string(index.modelName(model))};
}

bool sameProfile(const Index& a, const Index& b) {
  return std::memcmp(&a.parameters(), &b.parameters(), sizeof a.parameters()) == 0;
}

bool sameDirections(const Index& a, const Index& b) {
  return a.directions().size == b.directions().size &&
         std::memcmp(a.directions().data, b.directions().data, a.directions().size * sizeof(format::Direction)) == 0;
}

// ---- where models come from ------------------------------------------------------------------------------------

/// An index that is read from its first model to its last.
struct Source {
  std::shared_ptr<const Index> index;
  std::string place{};           ///< for sentences; empty = not to be named
  std::vector<bool> left_out{};  ///< by model; empty = none
};
using Sources = std::vector<Source>;

/// Damaged if the index is.
Result<Source> soundSource(const std::string& path, const std::string& place) {
  const auto index = Index::open(path);
  if (!index.ok()) return index.status;
  const Status sound = index.value->verify();
  if (!sound.ok()) return sound;
  return Source{index.value, place};
}

struct Synset {
  std::uint32_t offset = 0;
  std::string sense, hypernyms;
};
/// Each category's synset, where it has one.
using Synsets = std::map<std::string, Synset>;

Status addSynsets(Synsets& synsets, const Index& index) {
  for (std::uint32_t i = 0; i < index.categories().size; ++i) {
    const std::uint32_t offset = index.categories()[i].synset;
    if (offset == 0) continue;
    const std::string category(index.categoryName(i));
    const Synset own{offset, std::string(index.senseOf(i)), std::string(index.hypernymsOf(i))};
    Synset& known = synsets.emplace(category, own).first->second;
    if (known.sense.empty()) known.sense = own.sense;
    if (known.hypernyms.empty()) known.hypernyms = own.hypernyms;
    if (known.offset != offset) {
      return Status::cannotDo("category " + category + " has the synsets " + std::to_string(known.offset) + " and " +
                              std::to_string(offset) + "; give one of the two another name");
    }
  }
  return {};
}

/// Each later source fits the first one.
Status checkFit(const Source& first, const Source& other) {
  if (!sameProfile(*first.index, *other.index)) {
    return Status::cannotDo(
        "the descriptors differ; only indices of the same descriptor, settings and projection can be put together");
  }
  if (!sameDirections(*first.index, *other.index)) return Status::cannotDo("the view directions differ");
  return {};
}

Status at(const std::string& place, Status status) {
  if (!status.ok() && !place.empty()) status.sentence = place + ": " + status.sentence;
  return status;
}

Result<Synsets> checkedSynsets(const Sources& sources) {
  Synsets synsets;
  for (const Source& source : sources) {
    Status status = checkFit(sources.front(), source);
    if (status.ok()) status = addSynsets(synsets, *source.index);
    if (!status.ok()) return at(source.place, status);
  }
  return synsets;
}

// ---- one after another -----------------------------------------------------------------------------------------

/// The next model of a source.
struct Cursor {
  Name name;
  std::size_t source;
  std::uint32_t model;
};
/// The lowest name comes first, of equal ones that of the first source.
bool operator<(const Cursor& a, const Cursor& b) { return std::tie(b.name, b.source) < std::tie(a.name, a.source); }

/// All models of some sources in the order of an index; of models with one name the last source's.
class Merge {
 public:
  Merge(const Sources& sources, Clash clash) : sources_(sources), clash_(clash) {
    for (std::size_t i = 0; i < sources.size(); ++i) push(i, 0);
  }

  Status into(IndexAssembler& whole, const Synsets& synsets) {
    while (!cursors_.empty()) {
      Cursor cursor = pop();
      for (; !cursors_.empty() && cursors_.top().name == cursor.name; cursor = pop()) {
        if (clash_ == Clash::Refuse) return refusal(cursors_.top());
      }
      Result<ModelRecord> model = readModel(*sources_[cursor.source].index, cursor.model);
      if (!model.ok()) return model.status;
      const auto known = synsets.find(model.value.category);
      const Synset synset = known == synsets.end() ? Synset{} : known->second;
      model.value.synset = synset.offset;
      model.value.sense = synset.sense;
      model.value.hypernyms = synset.hypernyms;
      const Status status = whole.add(model.value);
      if (!status.ok()) return status;
    }
    return {};
  }

 private:
  void push(std::size_t source, std::uint32_t model) {
    const Index& index = *sources_[source].index;
    const std::vector<bool>& left_out = sources_[source].left_out;
    while (!left_out.empty() && model < left_out.size() && left_out[model]) ++model;
    if (model < index.models().size) cursors_.push({nameOf(index, model), source, model});
  }
  Cursor pop() {
    const Cursor cursor = cursors_.top();
    cursors_.pop();
    push(cursor.source, cursor.model + 1);
    return cursor;
  }
  Status refusal(const Cursor& cursor) const {
    return at(sources_[cursor.source].place,
              Status::cannotDo("model " + textOf(cursor.name) + " is there already; --replace takes the new one"));
  }

  const Sources& sources_;
  Clash clash_;
  std::priority_queue<Cursor> cursors_;
};

format::Calibration bestCalibration(const Sources& sources) {
  const auto fewer = [](const Source& a, const Source& b) {
    return a.index->calibration().samples < b.index->calibration().samples;
  };
  return std::max_element(sources.begin(), sources.end(), fewer)->index->calibration();
}

/// In the folder that WriterLock makes.
std::string draftOf(const std::string& index) { return index + ".parts/draft.vxi"; }

Status writeMerged(const Sources& sources, Clash clash, const std::string& out) {
  const Result<Synsets> synsets = checkedSynsets(sources);
  if (!synsets.ok()) return synsets.status;
  const Index& first = *sources.front().index;
  IndexAssembler whole(first.profile(), {first.directions().begin(), first.directions().end()}, out);
  const Status status = Merge(sources, clash).into(whole, synsets.value);
  if (!status.ok()) return status;
  const auto calibration = [&](const std::shared_ptr<const Index>&) { return bestCalibration(sources); };
  return writeWithConfidence(whole, calibration, draftOf(out), out).status;
}

/// Keeps other writers of an index away. What an interrupted build left for --resume stays.
class WriterLock {
 public:
  ~WriterLock() {
    if (held_ && !parts_.hasModels()) parts_.remove();
  }
  Status lock(const std::string& index) {
    const Status status = parts_.open(index, true);
    held_ = status.ok();
    return status;
  }

 private:
  PartsFolder parts_;
  bool held_ = false;
};

/// Which models `wanted` names.
Result<std::vector<bool>> namedModels(const Index& index, const std::vector<std::string>& wanted) {
  const std::set<std::string> names(wanted.begin(), wanted.end());
  std::set<std::string> met;
  std::vector<bool> named(index.models().size);
  for (std::uint32_t i = 0; i < named.size(); ++i) {
    const Name name = nameOf(index, i);
    for (const std::string& text : {name.first, textOf(name)}) {
      if (names.count(text) == 0) continue;
      met.insert(text);
      named[i] = true;
    }
  }
  for (const std::string& name : names) {
    if (met.count(name) == 0) return Status::nothingFound("there is no category or model " + name);
  }
  if (std::find(named.begin(), named.end(), false) == named.end())
    return Status::nothingFound("no model would be left; delete the file instead");
  return named;
}

Result<BuildReport> addTo(const Source& old, const BuildOptions& options, Clash clash, BuildListener& listener) {
  BuildOptions extra = options;
  extra.profile = old.index->profile();
  extra.keep_surfaces = old.index->hasSurfaces();
  extra.out = options.out + ".parts/added.vxi";
  Result<BuildReport> report = buildIndex(extra, listener);
  if (!report.ok()) return report;
  const Result<Source> added = soundSource(extra.out, "");
  std::error_code ignored;
  std::filesystem::remove(extra.out, ignored);
  report.status = added.ok() ? writeMerged({old, added.value}, clash, options.out) : added.status;
  return report;
}

}  // namespace

Result<BuildReport> addModels(const BuildOptions& options, Clash clash, BuildListener& listener) {
  WriterLock lock;
  const Status status = lock.lock(options.out);
  if (!status.ok()) return status;
  const Result<Source> old = soundSource(options.out, "");
  return old.ok() ? addTo(old.value, options, clash, listener) : old.status;
}

Status removeModels(const std::string& path, const std::vector<std::string>& wanted) {
  WriterLock lock;
  const Status status = lock.lock(path);
  if (!status.ok()) return status;
  Result<Source> old = soundSource(path, "");
  if (!old.ok()) return old.status;
  auto named = namedModels(*old.value.index, wanted);
  if (!named.ok()) return at(path, named.status);
  old.value.left_out = std::move(named.value);
  return writeMerged({old.value}, Clash::Refuse, path);
}

Status mergeIndices(const std::vector<std::string>& paths, const std::string& out, Clash clash) {
  if (paths.empty()) return Status::badUse("no index to merge is given");
  WriterLock lock;
  const Status status = lock.lock(out);
  if (!status.ok()) return status;
  Sources sources;
  for (const std::string& path : paths) {
    Result<Source> source = soundSource(path, path);
    if (!source.ok()) return source.status;
    sources.push_back(std::move(source.value));
  }
  return writeMerged(sources, clash, out);
}

}  // namespace voxid
