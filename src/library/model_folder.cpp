// SPDX-License-Identifier: BSD-3-Clause
#include "model_folder.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "synset_table.h"
#include "voxid/library/mesh_reader.h"

namespace voxid {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Status unreadable(const fs::path& folder, const std::error_code& error) {
  return Status::cannotDo(folder.string() + ": " + error.message());
}

Result<std::vector<std::string>> namesIn(const fs::path& folder) {
  std::error_code error;
  std::vector<std::string> names;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name[0] != '.') names.push_back(name);
  }
  if (error) return unreadable(folder, error);
  std::sort(names.begin(), names.end());
  return names;
}

Status addCategory(const fs::path& root, const std::string& category, ModelFolder& folder) {
  const auto files = namesIn(root / category);
  if (!files.ok()) return files.status;
  std::set<std::string> taken;
  for (const std::string& file : files.value) {
    if (!isMeshFile(file)) continue;
    ModelFile model;
    model.category = category;
    model.name = fs::path(file).stem().string();
    model.file = category + "/" + file;
    model.path = (root / category / file).string();
    if (!taken.insert(model.name).second) model.clash = "another file of this category gives the model the same name";
    folder.models.push_back(model);
  }
  return {};
}

/// WordNet 3.0 noun offset: 3797390, "03797390" or "n03797390"; 0 if it is none.
std::uint32_t synsetOf(const json& note) {
  const auto found = note.find("synset");
  if (found == note.end()) return 0;
  if (found->is_number_unsigned()) return found->get<std::uint32_t>();
  if (!found->is_string()) return 0;
  std::string digits = found->get<std::string>();
  if (!digits.empty() && digits[0] == 'n') digits.erase(0, 1);
  const bool offset =
      !digits.empty() && digits.size() <= 8 && digits.find_first_not_of("0123456789") == std::string::npos;
  return offset ? static_cast<std::uint32_t>(std::stoul(digits)) : 0;
}

std::string textOf(const json& note, const char* field) {
  const auto found = note.find(field);
  return found != note.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::string originOf(const json& note) {
  std::string origin;
  for (const char* const field : {"author", "source", "url"}) {
    const std::string text = textOf(note, field);
    if (!text.empty()) origin += (origin.empty() ? "" : "; ") + text;
  }
  return origin;
}

/// "coarser" lists them by name, the nearest first. Libraries of before listed offsets.
std::string hypernymsOf(const json& note, const std::string& sense) {
  const auto found = note.find("coarser");
  if (sense.empty() || found == note.end() || !found->is_array()) return {};
  std::string path = sense;
  for (const json& wider : *found) {
    if (!wider.is_string() || wider.get<std::string>().find('.') == std::string::npos) return {};
    path = wider.get<std::string>() + "/" + path;
  }
  return path;
}

void apply(const json& note, ModelFile& model) {
  if (!note.is_object()) return;
  const std::string licence = textOf(note, "licence"), origin = originOf(note);
  if (!licence.empty()) model.licence = licence;
  if (!origin.empty()) model.origin = origin;
  if (const std::uint32_t synset = synsetOf(note)) {
    model.synset = synset;
    model.sense = textOf(note, "sense");
    model.hypernyms = hypernymsOf(note, model.sense);
  }
}

Status readNotes(const fs::path& root, ModelFolder& folder) {
  const fs::path path = root / "library.json";
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  std::ifstream file(path);
  const json notes = json::parse(file, nullptr, false);
  if (!notes.is_object()) return Status::damaged(path.string() + " is not a JSON object of models; see doc/build.md");
  for (ModelFile& model : folder.models) {
    for (const std::string& key : {model.category, model.file}) {
      const auto note = notes.find(key);
      if (note != notes.end()) apply(*note, model);
    }
  }
  return {};
}

/// What is not said, from the table.
KnownSynset completed(const std::string& category, KnownSynset synset) {
  if (synset.offset == 0) synset = synsetOfCategory(category);
  if (synset.sense.empty()) synset.sense = senseOfOffset(synset.offset);
  if (synset.hypernyms.empty()) synset.hypernyms = hypernymPath(synset.sense);
  return synset;
}

/// A category has one synset: the first that one of its models names.
void shareSynsets(ModelFolder& folder) {
  for (auto first = folder.models.begin(); first != folder.models.end();) {
    const auto last =
        std::find_if(first, folder.models.end(), [&](const ModelFile& m) { return m.category != first->category; });
    const auto named = std::find_if(first, last, [](const ModelFile& m) { return m.synset != 0; });
    const KnownSynset own = named == last ? KnownSynset{} : KnownSynset{named->synset, named->sense, named->hypernyms};
    const KnownSynset synset = completed(first->category, own);
    for (; first != last; ++first) {
      first->synset = synset.offset;
      first->sense = synset.sense;
      first->hypernyms = synset.hypernyms;
    }
  }
}

}  // namespace

Result<ModelFolder> listModels(const std::string& path) {
  const fs::path root(path);
  const auto names = namesIn(root);
  if (!names.ok()) return names.status;
  ModelFolder folder;
  for (const std::string& name : names.value) {
    std::error_code error;
    if (!fs::is_directory(root / name, error)) continue;
    folder.categories.push_back(name);
    const Status status = addCategory(root, name, folder);
    if (!status.ok()) return status;
  }
  const Status status = readNotes(root, folder);
  if (!status.ok()) return status;
  shareSynsets(folder);
  return folder;
}

}  // namespace voxid
