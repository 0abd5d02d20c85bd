// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/index_writer.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "voxid/core/crc32c.h"
#include "voxid/core/key.h"
#include "voxid/core/refine.h"

namespace voxid {
namespace {

constexpr std::size_t kMaxDirections = 256;  // an 8-bit number in format::View
constexpr std::uint64_t kMaxEntries = 0xfffffffe;

/// In the order in which they are written.
using Tags = std::vector<const char*>;
Tags tagsOf(const IndexContent& content, bool senses) {
  Tags tags{"PARM", "CATS", "MODL", "DIRS", "VIEW", "CODE", "KEYS", "BKTO", "BKTV", "STRS", "CALB"};
  if (content.profile.projection)
    tags = {"PARM", "CATS", "MODL", "DIRS", "VIE4", "PROJ", "CODE", "MEAN", "KEYS", "BKTO", "BKTV", "STRS", "CALB"};
  if (senses) tags.push_back("SYNS");
  if (content.confidence) tags.push_back("CONF");
  return tags;
}

using Models = std::vector<const ModelRecord*>;

// ---- what may be written ---------------------------------------------------------------------------------------

Models sorted(const IndexContent& content) {
  Models models;
  for (const ModelRecord& model : content.models) models.push_back(&model);
  std::sort(models.begin(), models.end(), [](const ModelRecord* a, const ModelRecord* b) {
    return std::tie(a->category, a->name) < std::tie(b->category, b->name);
  });
  return models;
}

bool hasNul(const std::string& text) { return text.find('\0') != std::string::npos; }

std::string faultOfViews(const ModelRecord& model, std::size_t directions, std::size_t code_bytes) {
  if (model.views.empty()) return "has no view";
  int previous = -1;
  for (const ViewRecord& view : model.views) {
    if (view.direction <= previous) return "has views whose directions do not ascend";
    if (view.direction >= directions) return "has a view whose direction is not in the list of directions";
    if (view.code.size() != code_bytes) return "has a code of " + std::to_string(view.code.size()) + " bytes";
    previous = view.direction;
  }
  return {};
}

std::string faultOfModel(const ModelRecord& model, const ModelRecord* before, std::size_t directions, std::size_t code_bytes) {
  if (model.category.empty() || model.name.empty()) return "has an empty category or name";
  if (hasNul(model.category) || hasNul(model.name) || hasNul(model.licence) || hasNul(model.origin) || hasNul(model.sense)) {
    return "has a NUL in a text";
  }
  if (before != nullptr && before->category == model.category) {
    if (before->name == model.name) return "is there twice";
    if (before->sense != model.sense) return "has another sense than the rest of its category";
    if (before->synset != model.synset) return "has another synset than the rest of its category";
  }
  return faultOfViews(model, directions, code_bytes);
}

std::string faultOf(const IndexContent& content, const Models& models) {
  if (models.empty()) return "there is no model";
  if (content.profile.params.pairs < 1 || content.profile.params.pairs > kMaxPairs) return "the number of pairs is out of range";
  if (content.directions.size() > kMaxDirections) return "there are more than 256 directions";
  const auto& curve = content.calibration.score_permille;
  if (!std::is_sorted(std::begin(curve), std::end(curve)) || *(std::end(curve) - 1) > 1000) {
    return "the calibration does not rise from 0 to 1000 at most";
  }
  if (content.confidence && (content.confidence->samples == 0 || content.confidence->right > content.confidence->samples))
    return "the confidence has no samples, or more right ones than samples";
  std::uint64_t views = 0;
  const ModelRecord* before = nullptr;
  for (const ModelRecord* const model : models) {
    const std::string fault = faultOfModel(*model, before, content.directions.size(), content.profile.codeBytes());
    if (!fault.empty()) return "model " + model->category + "/" + model->name + " " + fault;
    views += model->views.size();
    before = model;
  }
  return views > kMaxEntries ? "there are more than 4,294,967,294 views" : std::string();
}

// ---- tables that the sections are written from ------------------------------------------------------------------

// STRS: every string once, in order of first use; offset 0 is the empty one.
class Strings {
 public:
  std::uint32_t add(const std::string& text) {
    if (text.empty()) return 0;
    const auto [entry, is_new] = offsets_.emplace(text, static_cast<std::uint32_t>(bytes_.size()));
    if (is_new) bytes_.append(text).push_back('\0');
    return entry->second;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_{std::string(1, '\0')};
  std::unordered_map<std::string, std::uint32_t> offsets_;
};

struct Tables {
  std::vector<format::Category> categories;
  std::vector<format::Model> models;
  std::vector<Key> keys;
  std::vector<std::uint32_t> bucket_offsets, bucket_views;
  std::vector<std::uint32_t> senses;  // empty if no category has one
  Strings strings;
  std::uint32_t views = 0;
};

void addModel(Tables& tables, const ModelRecord& model, bool new_category) {
  const auto number = static_cast<std::uint32_t>(tables.models.size());
  if (new_category) tables.categories.push_back({tables.strings.add(model.category), model.synset, number, 0});
  ++tables.categories.back().models;
  format::Model entry{};
  entry.category = static_cast<std::uint32_t>(tables.categories.size() - 1);
  entry.name = tables.strings.add(model.name);
  entry.licence = tables.strings.add(model.licence);
  entry.origin = tables.strings.add(model.origin);
  entry.first_view = tables.views;
  entry.views = static_cast<std::uint32_t>(model.views.size());
  tables.models.push_back(entry);
  tables.views += entry.views;
}

void addBuckets(Tables& tables, const Models& models, const Profile& profile) {
  std::vector<std::pair<Key, std::uint32_t>> views;
  views.reserve(tables.views);
  for (const ModelRecord* const model : models) {
    for (const ViewRecord& view : model->views) {
      views.emplace_back(bucketKeyOf(profile, view.code.data()), static_cast<std::uint32_t>(views.size()));
    }
  }
  std::sort(views.begin(), views.end());
  for (const auto& [key, view] : views) {
    if (tables.keys.empty() || tables.keys.back() != key) {
      tables.keys.push_back(key);
      tables.bucket_offsets.push_back(static_cast<std::uint32_t>(tables.bucket_views.size()));
    }
    tables.bucket_views.push_back(view);
  }
  tables.bucket_offsets.push_back(tables.views);
}

// Behind all other texts: what has no senses keeps its bytes.
void addSenses(Tables& tables, const Models& models) {
  if (std::all_of(models.begin(), models.end(), [](const ModelRecord* model) { return model->sense.empty(); })) return;
  for (const format::Category& category : tables.categories) {
    tables.senses.push_back(tables.strings.add(models[category.first_model]->sense));
  }
}

Tables tablesOf(const Models& models, const Profile& profile) {
  Tables tables;
  const ModelRecord* before = nullptr;
  for (const ModelRecord* const model : models) {
    addModel(tables, *model, before == nullptr || before->category != model->category);
    before = model;
  }
  addBuckets(tables, models, profile);
  addSenses(tables, models);
  return tables;
}

// ---- the file ----------------------------------------------------------------------------------------------------

// A file beside the one to be replaced. Removed unless it came to `replace`.
class FileBeside {
 public:
  explicit FileBeside(std::string path) : path_(std::move(path)) {
    constexpr int kTries = 100;
    int file = -1;
    for (int i = 0; i < kTries && file < 0; ++i) {
      name_ = path_ + ".new-" + std::to_string(::getpid()) + "-" + std::to_string(i);
      file = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (file < 0 && errno != EEXIST) break;
    }
    note(file >= 0);
    if (file >= 0) stream_ = ::fdopen(file, "wb");
  }
  ~FileBeside() {
    if (stream_ == nullptr) return;
    std::fclose(stream_);
    ::unlink(name_.c_str());
  }
  FileBeside(const FileBeside&) = delete;
  FileBeside& operator=(const FileBeside&) = delete;

  void write(const void* data, std::size_t bytes) {
    if (ok() && bytes > 0) note(std::fwrite(data, 1, bytes, stream_) == bytes);
  }
  void rewind() {
    if (ok()) note(std::fseek(stream_, 0, SEEK_SET) == 0);
  }
  void replace() {
    if (ok()) note(std::fflush(stream_) == 0 && ::fsync(::fileno(stream_)) == 0);
    if (ok()) note(::rename(name_.c_str(), path_.c_str()) == 0);
    if (!ok()) return;
    std::fclose(stream_);
    stream_ = nullptr;
    syncFolder();
  }

  bool ok() const { return error_ == 0; }
  Status status() const {
    return ok() ? Status{} : Status::cannotDo("cannot write the index " + path_ + ": " + std::strerror(error_));
  }

 private:
  void note(bool success) {
    if (!success && error_ == 0) error_ = errno != 0 ? errno : EIO;
  }
  // Without it the new name may be lost with the power; not every file system knows how, so its refusal is no failure.
  void syncFolder() const {
    const std::size_t slash = path_.rfind('/');
    const std::string folder = slash == std::string::npos ? "." : path_.substr(0, slash + 1);
    const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0) return;
    ::fsync(file);
    ::close(file);
  }

  std::string path_, name_;
  std::FILE* stream_ = nullptr;
  int error_ = 0;
};

// Sections one after another, each at a multiple of 64 bytes, its sum taken on the way: nothing is held in memory.
class SectionWriter {
 public:
  SectionWriter(FileBeside& file, Tags tags) : file_(file), tags_(std::move(tags)), table_(tags_.size()) {
    const std::vector<std::uint8_t> blank(sizeof(format::Header) + tableBytes());
    file_.write(blank.data(), blank.size());
    position_ = blank.size();
  }

  void begin() {
    pad();
    format::Section& section = table_[count_];
    std::memcpy(section.tag, tags_[count_], sizeof section.tag);
    section.offset = position_;
  }
  void put(const void* data, std::size_t bytes) {
    format::Section& section = table_[count_];
    section.crc32c = crc32c(data, bytes, section.crc32c);
    section.length += bytes;
    file_.write(data, bytes);
    position_ += bytes;
  }
  void end() { ++count_; }

  template <typename T>
  void section(const std::vector<T>& entries) {
    section(entries.data(), entries.size() * sizeof(T));
  }
  void section(const void* data, std::size_t bytes) {
    begin();
    put(data, bytes);
    end();
  }

  // Header and table go in last, when lengths and sums are known.
  void finish(format::Header header) {
    pad();
    header.file_bytes = position_;
    header.sections = static_cast<std::uint32_t>(tags_.size());
    header.crc32c = crc32c(table_.data(), tableBytes(), crc32c(&header, sizeof header));
    file_.rewind();
    file_.write(&header, sizeof header);
    file_.write(table_.data(), tableBytes());
  }

 private:
  std::size_t tableBytes() const { return table_.size() * sizeof(format::Section); }

  void pad() {
    constexpr std::uint8_t kZeros[format::kAlignment] = {};
    const std::size_t bytes = (format::kAlignment - position_ % format::kAlignment) % format::kAlignment;
    file_.write(kZeros, bytes);
    position_ += bytes;
  }

  FileBeside& file_;
  Tags tags_;
  std::vector<format::Section> table_;
  std::size_t count_ = 0;
  std::uint64_t position_ = 0;
};

void writeDirections(SectionWriter& out, const std::vector<format::Direction>& directions) {
  out.begin();
  for (format::Direction direction : directions) {
    std::fill(std::begin(direction.zero), std::end(direction.zero), std::uint8_t{0});
    out.put(&direction, sizeof direction);
  }
  out.end();
}

void writeViews(SectionWriter& out, const Models& models) {
  out.begin();
  for (std::size_t number = 0; number < models.size(); ++number) {
    for (const ViewRecord& view : models[number]->views) {
      format::View entry{};
      entry.model = static_cast<std::uint32_t>(number);
      std::copy(view.extents.begin(), view.extents.end(), entry.extents);
      entry.direction = view.direction;
      entry.points = view.points;
      out.put(&entry, sizeof entry);
    }
  }
  out.end();
}

void writeShortViews(SectionWriter& out, const Models& models) {
  out.begin();
  for (const ModelRecord* const model : models) {
    for (const ViewRecord& view : model->views) {
      format::ShortView entry{view.direction, {}};
      for (std::size_t i = 0; i < 3; ++i) entry.extents[i] = static_cast<std::uint8_t>(view.extents[i] >> 8);
      out.put(&entry, sizeof entry);
    }
  }
  out.end();
}

void writeCodes(SectionWriter& out, const Models& models) {
  out.begin();
  for (const ModelRecord* const model : models) {
    for (const ViewRecord& view : model->views) out.put(view.code.data(), view.code.size());
  }
  out.end();
}

// Models come by category.
void writeMeans(SectionWriter& out, const Models& models, std::size_t code_bytes) {
  CodeMean mean(code_bytes);
  std::vector<std::int8_t> bytes(code_bytes);
  out.begin();
  for (std::size_t i = 0; i < models.size(); ++i) {
    for (const ViewRecord& view : models[i]->views) mean.add(view.code.data());
    if (i + 1 < models.size() && models[i + 1]->category == models[i]->category) continue;
    mean.write(bytes.data());
    out.put(bytes.data(), bytes.size());
    mean.clear();
  }
  out.end();
}

format::Header headerOf(const IndexContent& content, const Tables& tables, const format::Parameters& parameters) {
  format::Header header{};
  std::copy(std::begin(format::kMagic), std::end(format::kMagic), header.magic);
  header.major = format::kMajor;
  header.minor = content.profile.projection ? format::kMinor : std::uint16_t{0};
  if (!tables.senses.empty()) header.minor = std::max(header.minor, format::kMinorSenses);
  if (content.confidence) header.minor = std::max(header.minor, format::kMinorConfidence);
  header.header_bytes = sizeof header;
  header.categories = static_cast<std::uint32_t>(tables.categories.size());
  header.models = static_cast<std::uint32_t>(tables.models.size());
  header.views = tables.views;
  header.buckets = static_cast<std::uint32_t>(tables.keys.size());
  header.descriptor_crc32c = crc32c(&parameters, sizeof parameters);
  return header;
}

// In the order of tagsOf.
void writeSections(FileBeside& file, const IndexContent& content, const Models& models, const Tables& tables) {
  const format::Parameters parameters = parametersOf(content.profile);
  format::Calibration calibration = content.calibration;
  std::fill(std::begin(calibration.zero), std::end(calibration.zero), std::uint8_t{0});
  SectionWriter out(file, tagsOf(content, !tables.senses.empty()));
  out.section(&parameters, sizeof parameters);
  out.section(tables.categories);
  out.section(tables.models);
  writeDirections(out, content.directions);
  if (const auto& projection = content.profile.projection) {
    writeShortViews(out, models);
    out.section(projection->bytes().data, projection->bytes().size);
  } else {
    writeViews(out, models);
  }
  writeCodes(out, models);
  if (content.profile.projection) writeMeans(out, models, content.profile.codeBytes());
  out.section(tables.keys);
  out.section(tables.bucket_offsets);
  out.section(tables.bucket_views);
  out.section(tables.strings.bytes().data(), tables.strings.bytes().size());
  out.section(&calibration, sizeof calibration);
  if (!tables.senses.empty()) out.section(tables.senses);
  if (content.confidence) {
    format::Confidence confidence = *content.confidence;
    std::fill(std::begin(confidence.zero), std::end(confidence.zero), std::uint8_t{0});
    out.section(&confidence, sizeof confidence);
  }
  out.finish(headerOf(content, tables, parameters));
}

// ---- back into memory --------------------------------------------------------------------------------------------

ViewRecord viewRecord(const Index& index, std::uint32_t number) {
  const format::View view = index.view(number);
  const std::uint8_t* const code = index.code(number);
  return {view.direction,
          view.points,
          {view.extents[0], view.extents[1], view.extents[2]},
          {code, code + index.parameters().code_bytes}};
}

ModelRecord modelRecord(const Index& index, const format::Model& model) {
  const format::Category& category = index.categories()[model.category];
  const auto text = [&](std::uint32_t offset) { return std::string(index.string(offset)); };
  ModelRecord record{text(category.name), text(model.name), text(model.licence),
                     text(model.origin),  category.synset,  {}, std::string(index.senseOf(model.category))};
  record.views.reserve(model.views);
  for (std::uint32_t i = 0; i < model.views; ++i) record.views.push_back(viewRecord(index, model.first_view + i));
  return record;
}

bool leadsNowhere(const Index& index, const format::Model& model) {
  return model.category >= index.categories().size ||
         std::uint64_t{model.first_view} + model.views > index.viewCount();
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
  const Models models = sorted(content);
  const std::string fault = faultOf(content, models);
  if (!fault.empty()) return Status::cannotDo("cannot write the index " + path + ": " + fault);
  const Tables tables = tablesOf(models, content.profile);
  FileBeside file(path);
  writeSections(file, content, models, tables);
  file.replace();
  return file.status();
}

Result<IndexContent> readContent(const Index& index) {
  IndexContent content;
  content.profile = index.profile();
  content.directions.assign(index.directions().begin(), index.directions().end());
  content.calibration = index.calibration();
  if (index.confidence() != nullptr) content.confidence = *index.confidence();
  for (const format::Model& model : index.models()) {
    if (leadsNowhere(index, model)) {
      return Status::damaged("the index " + index.path() + " is damaged: a model's views lead nowhere; " +
                             "`voxid verify` tells more");
    }
    content.models.push_back(modelRecord(index, model));
  }
  return content;
}

}  // namespace voxid
