// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/index_assembler.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <tuple>
#include <utility>

#include "bucket_spool.h"
#include "section_writer.h"
#include "string_table.h"
#include "voxid/core/kept_surface.h"
#include "voxid/core/refine.h"
#include "voxid/core/sketch.h"

namespace voxid {
namespace {

constexpr std::size_t kMaxDirections = 256;  // an 8-bit number in format::View
constexpr std::uint64_t kMaxEntries = 0xfffffffe;

// ---- what may be written ---------------------------------------------------------------------------------------

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

std::string faultOfTexts(const ModelRecord& model) {
  if (model.category.empty() || model.name.empty()) return "has an empty category or name";
  for (const std::string* const text :
       {&model.category, &model.name, &model.licence, &model.origin, &model.sense, &model.hypernyms}) {
    if (hasNul(*text)) return "has a NUL in a text";
  }
  return {};
}

std::string faultOfSurface(const ModelRecord& model) {
  const std::vector<std::uint8_t>& surface = model.surface;
  const bool whole = surface.empty() || KeptSurface::of({surface.data(), surface.size()});
  return whole ? std::string() : "has a surface that is not whole";
}

/// What has to differ from the model before, and what must not.
std::string faultOfOrder(const ModelRecord& model, const ModelRecord& before) {
  if (std::tie(model.category, model.name) < std::tie(before.category, before.name)) return "comes too late";
  if (before.category != model.category) return {};
  if (before.name == model.name) return "is there twice";
  if (before.sense != model.sense) return "has another sense than the rest of its category";
  if (before.synset != model.synset) return "has another synset than the rest of its category";
  if (before.hypernyms != model.hypernyms) return "has other hypernyms than the rest of its category";
  return {};
}

std::string faultOfWhole(const Profile& profile, std::size_t directions) {
  if (profile.params.pairs < 1 || profile.params.pairs > kMaxPairs) return "the number of pairs is out of range";
  return directions > kMaxDirections ? "there are more than 256 directions" : std::string();
}

std::string faultOfLearnt(const format::Calibration& calibration, const std::optional<format::Confidence>& confidence) {
  const auto& curve = calibration.score_permille;
  if (!std::is_sorted(std::begin(curve), std::end(curve)) || *(std::end(curve) - 1) > 1000)
    return "the calibration does not rise from 0 to 1000 at most";
  if (confidence && (confidence->samples == 0 || confidence->right > confidence->samples))
    return "the confidence has no samples, or more right ones than samples";
  return {};
}

template <typename T>
T withZeros(T entry) {
  std::fill(std::begin(entry.zero), std::end(entry.zero), std::uint8_t{0});
  return entry;
}

template <typename T>
Span<const T> only(const T& entry) {
  return {&entry, 1};
}

/// All but the views: what the next model is compared with.
ModelRecord headOf(const ModelRecord& model) {
  return {model.category, model.name, model.licence, model.origin, model.synset, {}, model.sense, model.hypernyms};
}

}  // namespace

// ---- what waits --------------------------------------------------------------------------------------------------

struct IndexAssembler::Parts {
  Parts(const Profile& p, std::vector<format::Direction> d, const std::string& out)
      : profile(p), directions(std::move(d)), path(out), mean(p.codeBytes()) {}

  std::string add(const ModelRecord& model);
  void close();
  int error() const;
  format::Header header(const format::Parameters& parameters) const;
  void writeSections(FileBeside& file, const format::Calibration& calibration,
                     const std::optional<format::Confidence>& confidence);

  const Profile profile;
  std::vector<format::Direction> directions;
  const std::string path;
  Spool models{path}, views{path}, codes{path}, sketches{path}, means{path};  // MODL, VIEW or VIE4, CODE, SUMS, MEAN
  Spool surfaces{path}, surface_offsets{path};                                // SURF, SURO
  BucketSpool buckets{path};
  std::vector<format::Category> categories;
  std::vector<std::string> category_senses, category_hypernyms;
  std::vector<std::uint32_t> senses, hypernyms;  // SYNS, HYPR; empty if no category has one
  StringTable strings;
  CodeMean mean;  // of the last category
  ModelRecord last;
  std::uint32_t model_count = 0;
  std::uint64_t view_count = 0;
  bool closed = false;

 private:
  void beginCategory(const ModelRecord& model);
  void endCategory();
  void addEntry(const ModelRecord& model);
  std::vector<std::uint32_t> offsetsOf(const std::vector<std::string>& texts);
  void addView(const ViewRecord& view);
  void addSketch(const ViewRecord& view);
  bool isSketched() const;
  bool hasSurfaces() const { return surfaces.bytes() > 0; }
};

std::string IndexAssembler::Parts::add(const ModelRecord& model) {
  std::string fault = faultOfWhole(profile, directions.size());
  if (!fault.empty()) return fault;
  fault = faultOfTexts(model);
  if (fault.empty() && model_count > 0) fault = faultOfOrder(model, last);
  if (fault.empty()) fault = faultOfViews(model, directions.size(), profile.codeBytes());
  if (fault.empty()) fault = faultOfSurface(model);
  if (!fault.empty()) return "model " + model.category + "/" + model.name + " " + fault;
  if (view_count + model.views.size() > kMaxEntries) return "there are more than 4,294,967,294 views";
  if (model_count == 0 || last.category != model.category) beginCategory(model);
  addEntry(model);
  for (const ViewRecord& view : model.views) addView(view);
  last = headOf(model);
  return strings.bytes().size() > kMaxEntries ? "the names take more than 4 GiB" : std::string();
}

void IndexAssembler::Parts::beginCategory(const ModelRecord& model) {
  endCategory();
  categories.push_back({strings.add(model.category), model.synset, model_count, 0});
  category_senses.push_back(model.sense);
  category_hypernyms.push_back(model.hypernyms);
}

void IndexAssembler::Parts::endCategory() {
  if (!profile.projection || mean.empty()) return;
  CodeNumbers numbers;
  mean.write(numbers.data());
  means.append(numbers.data(), numbers.size());
  mean.clear();
}

void IndexAssembler::Parts::addEntry(const ModelRecord& model) {
  ++categories.back().models;
  format::Model entry{};
  entry.category = static_cast<std::uint32_t>(categories.size() - 1);
  entry.name = strings.add(model.name);
  entry.licence = strings.add(model.licence);
  entry.origin = strings.add(model.origin);
  entry.first_view = static_cast<std::uint32_t>(view_count);
  entry.views = static_cast<std::uint32_t>(model.views.size());
  models.append(entry);
  surface_offsets.append(surfaces.bytes());
  surfaces.append(model.surface.data(), model.surface.size());
  ++model_count;
}

void IndexAssembler::Parts::addView(const ViewRecord& view) {
  if (profile.projection) {
    format::ShortView entry{view.direction, {}};
    for (std::size_t i = 0; i < 3; ++i) entry.extents[i] = static_cast<std::uint8_t>(view.extents[i] >> 8);
    views.append(entry);
    mean.add(view.code.data());
  } else {
    format::View entry{};
    entry.model = model_count - 1;
    std::copy(view.extents.begin(), view.extents.end(), entry.extents);
    entry.direction = view.direction;
    entry.points = view.points;
    views.append(entry);
  }
  codes.append(view.code.data(), view.code.size());
  if (!profile.projection) addSketch(view);
  buckets.add(bucketKeyOf(profile, view.code.data()), static_cast<std::uint32_t>(view_count));
  ++view_count;
}

void IndexAssembler::Parts::addSketch(const ViewRecord& view) {
  std::array<std::uint8_t, kSketchBytes> sketch;
  sketchOf(view.code.data(), sketch.data());
  sketches.append(sketch.data(), sketch.size());
}

bool IndexAssembler::Parts::isSketched() const { return !profile.projection && view_count >= kSketchedViews; }

std::vector<std::uint32_t> IndexAssembler::Parts::offsetsOf(const std::vector<std::string>& texts) {
  std::vector<std::uint32_t> offsets;
  if (std::all_of(texts.begin(), texts.end(), [](const std::string& text) { return text.empty(); })) return offsets;
  for (const std::string& text : texts) offsets.push_back(strings.add(text));
  return offsets;
}

// These stand behind all other texts: what has none keeps its bytes.
void IndexAssembler::Parts::close() {
  if (std::exchange(closed, true)) return;
  endCategory();
  surface_offsets.append(surfaces.bytes());
  buckets.finish();
  senses = offsetsOf(category_senses);
  hypernyms = offsetsOf(category_hypernyms);
}

int IndexAssembler::Parts::error() const {
  for (const Spool* const spool : {&models, &views, &codes, &sketches, &means, &surfaces, &surface_offsets}) {
    if (spool->error() != 0) return spool->error();
  }
  return buckets.error();
}

// ---- the file ----------------------------------------------------------------------------------------------------

format::Header IndexAssembler::Parts::header(const format::Parameters& parameters) const {
  format::Header header{};
  std::copy(std::begin(format::kMagic), std::end(format::kMagic), header.magic);
  header.major = format::kMajor;
  header.minor = profile.projection ? format::kMinor : std::uint16_t{0};
  if (!senses.empty()) header.minor = std::max(header.minor, format::kMinorSenses);
  if (!hypernyms.empty()) header.minor = std::max(header.minor, format::kMinorHypernyms);
  if (isSketched()) header.minor = std::max(header.minor, kMinorSketch);
  if (hasSurfaces()) header.minor = std::max(header.minor, format::kMinorSurfaces);
  header.header_bytes = sizeof header;
  header.categories = static_cast<std::uint32_t>(categories.size());
  header.models = model_count;
  header.views = static_cast<std::uint32_t>(view_count);
  header.buckets = buckets.buckets();
  header.descriptor_crc32c = crc32c(&parameters, sizeof parameters);
  return header;
}

void IndexAssembler::Parts::writeSections(FileBeside& file, const format::Calibration& calibration,
                                          const std::optional<format::Confidence>& confidence) {
  const format::Parameters parameters = parametersOf(profile);
  const format::Calibration curve = withZeros(calibration);
  const format::Confidence odds = confidence ? withZeros(*confidence) : format::Confidence{};
  std::transform(directions.begin(), directions.end(), directions.begin(), withZeros<format::Direction>);
  format::Header head = header(parameters);
  if (confidence) head.minor = std::max(head.minor, format::kMinorConfidence);

  SectionWriter out;
  out.add("PARM", only(parameters));
  out.add("CATS", categories);
  out.add("MODL", models);
  out.add("DIRS", directions);
  out.add(profile.projection ? "VIE4" : "VIEW", views);
  if (profile.projection) out.add("PROJ", profile.projection->bytes());
  out.add("CODE", codes);
  if (profile.projection) out.add("MEAN", means);
  out.add("KEYS", buckets.keys());
  out.add("BKTO", buckets.offsets());
  out.add("BKTV", buckets.views());
  out.add("STRS", Span<const char>{strings.bytes().data(), strings.bytes().size()});
  out.add("CALB", only(curve));
  if (!senses.empty()) out.add("SYNS", senses);
  if (!hypernyms.empty()) out.add("HYPR", hypernyms);
  if (confidence) out.add("CONF", only(odds));
  if (isSketched()) out.add("SUMS", sketches);
  if (hasSurfaces()) {
    out.add("SURO", surface_offsets);
    out.add("SURF", surfaces);
  }
  out.write(file, head);
}

IndexAssembler::IndexAssembler(const Profile& profile, std::vector<format::Direction> directions,
                               const std::string& path)
    : parts_(std::make_unique<Parts>(profile, std::move(directions), path)) {}

IndexAssembler::~IndexAssembler() = default;

Status IndexAssembler::add(const ModelRecord& model) {
  const std::string fault = parts_->add(model);
  if (!fault.empty()) return cannotWriteIndex(parts_->path, fault);
  const int error = parts_->error();
  return error == 0 ? Status{} : cannotWriteIndex(parts_->path, std::strerror(error));
}

std::uint32_t IndexAssembler::models() const { return parts_->model_count; }

Status IndexAssembler::write(const std::string& path, const format::Calibration& calibration,
                             const std::optional<format::Confidence>& confidence) {
  if (parts_->model_count == 0) return cannotWriteIndex(path, "there is no model");
  const std::string fault = faultOfLearnt(calibration, confidence);
  if (!fault.empty()) return cannotWriteIndex(path, fault);
  parts_->close();
  FileBeside file(path);
  parts_->writeSections(file, calibration, confidence);
  const int error = parts_->error();
  if (error != 0) return cannotWriteIndex(path, std::strerror(error));
  file.replace();
  return file.status();
}

}  // namespace voxid
