// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/index.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <limits>

#include "code_distance.h"
#include "voxid/core/crc32c.h"

namespace voxid {
namespace {

constexpr char kPaperProfile[] = "paper", kDefaultProfile[] = "default";
constexpr char kRemedy[] = "copy it again from a good one or make it anew with `voxid build`";

Status cannotOpen(const std::string& path, const std::string& why) {
  return Status::cannotDo("cannot open the index " + path + ": " + why);
}

Status damaged(const std::string& path, const std::string& what) {
  return Status::damaged("the index " + path + " is damaged: " + what + "; " + kRemedy);
}

std::string foundExpected(std::uint64_t found, std::uint64_t expected) {
  return std::to_string(found) + " found, " + std::to_string(expected) + " expected";
}

std::string tagOf(const format::Section& section) { return {section.tag, sizeof section.tag}; }

std::uint64_t alignedUp(std::uint64_t bytes) {
  return (bytes + format::kAlignment - 1) / format::kAlignment * format::kAlignment;
}

std::string profileName(const format::Parameters& parameters) {
  return {parameters.profile, ::strnlen(parameters.profile, sizeof parameters.profile)};
}

// The sum of header and table, the header's own field taken as zero.
std::uint32_t headerSum(const std::uint8_t* file, const format::Header& header) {
  format::Header blank = header;
  blank.crc32c = 0;
  const std::uint32_t sum = crc32c(&blank, sizeof blank);
  return crc32c(file + sizeof blank, std::size_t{header.sections} * sizeof(format::Section), sum);
}

}  // namespace

Status Index::map(std::uint64_t own_bytes) {
  const int file = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe would wait for a writer
  if (file < 0) return cannotOpen(path_, std::string(std::strerror(errno)) + "; make one with `voxid build`");
  struct stat info {};
  Status status;
  if (::fstat(file, &info) != 0 || !S_ISREG(info.st_mode)) {
    status = cannotOpen(path_, "it is not a regular file");
  } else if (info.st_size == 0) {
    status = Status::damaged("the index " + path_ + " is empty; " + kRemedy);
  } else if (static_cast<std::uint64_t>(info.st_size) > std::numeric_limits<std::size_t>::max()) {
    status = cannotOpen(path_, "it is larger than this machine's address space");
  } else {
    const bool own = static_cast<std::uint64_t>(info.st_size) <= own_bytes;
    const auto bytes = static_cast<std::size_t>(info.st_size);
    void* const start = own ? ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)
                            : ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, file, 0);
    if (start == MAP_FAILED) {
      status = cannotOpen(path_, std::string("it cannot be mapped: ") + std::strerror(errno));
    } else {
      file_ = static_cast<const std::uint8_t*>(start);
      mapped_bytes_ = bytes;
      if (own)
        status = read(file);
      else
        expect(MADV_RANDOM);
    }
  }
  ::close(file);
  return status;
}

Status Index::read(int file) const {
  for (std::size_t at = 0; at < mapped_bytes_;) {
    const ssize_t got =
        ::pread(file, const_cast<std::uint8_t*>(file_) + at, mapped_bytes_ - at, static_cast<off_t>(at));
    if (got == 0) return damaged(path_, "it was cut while it was read");
    if (got < 0) return cannotOpen(path_, std::string("it cannot be read: ") + std::strerror(errno));
    at += static_cast<std::size_t>(got);
  }
  return {};
}

// Opening looks at a few places far apart; reading ahead of each, by megabytes on some machines, would take longer than
// all else. Searches go through codes from end to end.
void Index::willRead(Span<const std::uint8_t> bytes) const {
  constexpr std::size_t kPage = 4096;
  const auto into = static_cast<std::size_t>(bytes.data - file_) % kPage;
  ::madvise(const_cast<std::uint8_t*>(bytes.data - into), bytes.size + into, MADV_WILLNEED);
}
void Index::expect(int advice) const { ::madvise(const_cast<std::uint8_t*>(file_), mapped_bytes_, advice); }

Status Index::checkHeader() const {
  const auto cut = [&](std::uint64_t expected) {
    return damaged(path_, "its length is wrong, bytes: " + foundExpected(mapped_bytes_, expected));
  };
  if (mapped_bytes_ < sizeof(format::Header)) return cut(sizeof(format::Header));
  if (std::memcmp(header_->magic, format::kMagic, sizeof format::kMagic) != 0) {
    return damaged(path_, "it does not begin like a voxid index");
  }
  if (header_->major != format::kMajor) {
    return Status::cannotDo("the index " + path_ + " has format version " + std::to_string(header_->major) +
                            ", this voxid reads version " + std::to_string(format::kMajor) +
                            "; make the index anew with `voxid build`");
  }
  if (header_->file_bytes != mapped_bytes_) return cut(header_->file_bytes);
  const std::uint64_t table_end = sizeof(format::Header) + std::uint64_t{header_->sections} * sizeof(format::Section);
  if (header_->header_bytes != sizeof(format::Header) || header_->sections > format::kMaxSections ||
      table_end > mapped_bytes_) {
    return damaged(path_, "its section table does not fit");
  }
  if (headerSum(file_, *header_) != header_->crc32c) return damaged(path_, "the header's checksum is wrong");
  return {};
}

// Sections follow one another without overlap, and the last one ends the file.
Status Index::checkSections() const {
  std::uint64_t end = sizeof(format::Header) + sections_.size * sizeof(format::Section);
  for (const format::Section& section : sections_) {
    const bool fits = section.offset == alignedUp(end) && section.offset <= mapped_bytes_ &&
                      section.length <= mapped_bytes_ - section.offset;
    if (!fits) return damaged(path_, "section " + tagOf(section) + " leaves its place");
    end = section.offset + section.length;
  }
  if (alignedUp(end) != mapped_bytes_) return damaged(path_, "the last section does not end the file");
  return {};
}

Status Index::checkParameters() const {
  const format::Parameters own = parametersOf(profile());
  const bool same = std::memcmp(parameters_, &own, sizeof own) == 0;
  if (same && parameters_->pairs >= 1 && parameters_->pairs <= kMaxPairs) return {};
  return Status::cannotDo("the index " + path_ + " was made with descriptor \"" + profileName(*parameters_) +
                          "\" revision " + std::to_string(parameters_->revision) + ", " +
                          std::to_string(parameters_->pairs) + " pairs, " + std::to_string(parameters_->code_bytes) +
                          " bytes a view; this voxid makes \"" + own.profile + "\" revision " +
                          std::to_string(own.revision) + ", 1 to " + std::to_string(kMaxPairs) + " pairs, " +
                          std::to_string(own.code_bytes) + " bytes; make the index anew with `voxid build`");
}

namespace {

// Finds sections by tag and length; remembers the first that is missing, doubled or of the wrong length.
class Locator {
 public:
  Locator(const std::uint8_t* file, Span<const format::Section> sections) : file_(file), sections_(sections) {}

  template <typename T>
  Span<const T> any(const char* tag) {
    const format::Section* const section = find(tag);
    if (section == nullptr) return {};
    if (section->length % sizeof(T) != 0) complain(tag, "is no whole number of entries");
    return {reinterpret_cast<const T*>(file_ + section->offset), static_cast<std::size_t>(section->length / sizeof(T))};
  }

  template <typename T>
  Span<const T> exactly(const char* tag, std::uint64_t count) {
    const Span<const T> found = any<T>(tag);
    if (found.size != count) complain(tag, "has the wrong length, entries: " + foundExpected(found.size, count));
    return found;
  }

  bool has(const char* tag) const {
    return std::any_of(sections_.begin(), sections_.end(),
                       [tag](const format::Section& s) { return std::memcmp(s.tag, tag, sizeof s.tag) == 0; });
  }

  const std::string& complaint() const { return complaint_; }

 private:
  const format::Section* find(const char* tag) {
    const format::Section* found = nullptr;
    for (const format::Section& section : sections_) {
      if (std::memcmp(section.tag, tag, sizeof section.tag) != 0) continue;
      if (found != nullptr) complain(tag, "is there twice");
      found = &section;
    }
    if (found == nullptr) complain(tag, "is missing");
    return found;
  }
  void complain(const char* tag, const std::string& what) {
    if (complaint_.empty()) complaint_ = std::string("section ") + tag + " " + what;
  }

  const std::uint8_t* file_;
  Span<const format::Section> sections_;
  std::string complaint_;
};

}  // namespace

// The descriptor's parameters and, of profile default, its projection.
Status Index::locateEncoding() {
  Locator find(file_, sections_);
  parameters_ = find.exactly<format::Parameters>("PARM", 1).data;
  if (!find.complaint().empty()) return damaged(path_, find.complaint());
  if (crc32c(parameters_, sizeof *parameters_) != header_->descriptor_crc32c) {
    return damaged(path_, "the descriptor's parameters do not fit their checksum");
  }
  if (profileName(*parameters_) == kDefaultProfile) {
    const Span<const std::uint8_t> section = find.any<std::uint8_t>("PROJ");
    if (!find.complaint().empty()) return damaged(path_, find.complaint());
    willRead(section);
    auto projection = Projection::fromBytes(section, "of the index " + path_);
    if (!projection.ok()) return projection.status;
    projection_ = std::move(projection.value);
  }
  return checkParameters();
}

Status Index::locateTables() {
  Locator find(file_, sections_);
  const format::Header& h = *header_;
  categories_ = find.exactly<format::Category>("CATS", h.categories);
  models_ = find.exactly<format::Model>("MODL", h.models);
  if (projection_)
    short_views_ = find.exactly<format::ShortView>("VIE4", h.views);
  else
    views_ = find.exactly<format::View>("VIEW", h.views);
  directions_ = find.any<format::Direction>("DIRS");
  codes_ = find.exactly<std::uint8_t>("CODE", std::uint64_t{h.views} * parameters_->code_bytes).data;
  if (projection_) means_ = find.exactly<std::int8_t>("MEAN", std::uint64_t{h.categories} * kCodeNumbers);
  keys_ = find.exactly<Key>("KEYS", h.buckets);
  bucket_offsets_ = find.exactly<std::uint32_t>("BKTO", std::uint64_t{h.buckets} + 1);
  bucket_views_ = find.exactly<std::uint32_t>("BKTV", h.views);
  strings_ = find.any<char>("STRS");
  calibration_ = find.exactly<format::Calibration>("CALB", 1).data;
  if (find.has("SYNS")) senses_ = find.exactly<std::uint32_t>("SYNS", h.categories);
  if (find.has("HYPR")) hypernyms_ = find.exactly<std::uint32_t>("HYPR", h.categories);
  if (find.has("SURO") || find.has("SURF")) {
    surface_offsets_ = find.exactly<std::uint64_t>("SURO", std::uint64_t{h.models} + 1);
    surfaces_ = find.any<std::uint8_t>("SURF");
  }
  if (find.has("CONF")) confidence_ = find.exactly<format::Confidence>("CONF", 1).data;
  if (!find.complaint().empty()) return damaged(path_, find.complaint());
  if (strings_.empty() || strings_[0] != 0 || strings_[strings_.size - 1] != 0) {
    return damaged(path_, "section STRS does not begin and end with a NUL");
  }
  return {};
}

Result<std::shared_ptr<const Index>> Index::open(const std::string& path) { return open(path, 0); }

Result<std::shared_ptr<const Index>> Index::open(const std::string& path, std::uint64_t own_bytes) {
  const std::shared_ptr<Index> index(new Index);
  index->path_ = path;
  if (Status status = index->map(own_bytes); !status.ok()) return status;
  index->header_ = reinterpret_cast<const format::Header*>(index->file_);
  if (Status status = index->checkHeader(); !status.ok()) return status;
  const auto* const table = reinterpret_cast<const format::Section*>(index->file_ + sizeof(format::Header));
  index->sections_ = {table, index->header_->sections};
  if (Status status = index->checkSections(); !status.ok()) return status;
  if (Status status = index->locateEncoding(); !status.ok()) return status;
  if (Status status = index->locateTables(); !status.ok()) return status;
  index->expect(MADV_NORMAL);
  return std::shared_ptr<const Index>(index);
}

Index::~Index() {
  if (file_ != nullptr) ::munmap(const_cast<std::uint8_t*>(file_), mapped_bytes_);
}

Span<const std::uint32_t> Index::bucket(std::uint32_t i) const {
  if (i >= keys_.size) return {};
  const std::uint32_t first = bucket_offsets_[i], last = bucket_offsets_[i + 1];
  if (first > last || last > bucket_views_.size) return {};
  return {bucket_views_.data + first, last - first};
}

Span<const std::uint8_t> Index::surface(std::uint32_t model) const {
  if (model >= models_.size || surface_offsets_.empty()) return {};
  const std::uint64_t first = surface_offsets_[model], last = surface_offsets_[model + 1];
  if (first > last || last > surfaces_.size) return {};
  return {surfaces_.data + first, static_cast<std::size_t>(last - first)};
}

std::string_view Index::string(std::uint32_t offset) const {
  return offset < strings_.size ? std::string_view(strings_.data + offset) : std::string_view();
}

format::View Index::view(std::uint32_t i) const {
  if (!projection_) return views_[i];
  const format::ShortView& stored = short_views_[i];
  format::View view{};
  view.model = modelOf(i);
  for (int axis = 0; axis < 3; ++axis) view.extents[axis] = static_cast<std::uint16_t>(stored.extents[axis] * 257);
  view.direction = stored.direction;
  return view;
}

// Most models have as many views as the others, so that the place in proportion is near the right one.
std::uint32_t Index::modelOf(std::uint32_t view) const {
  if (!projection_) return views_[view].model;
  const auto models = static_cast<std::uint32_t>(models_.size);
  if (models == 0) return 0;
  const auto near = static_cast<std::uint32_t>(std::uint64_t{view} * models / viewCount());
  std::uint32_t low = near, high = near, step = 1;
  for (; low > 0 && models_[low].first_view > view; step *= 2) low -= std::min(low, step);
  for (step = 1; high < models && models_[high].first_view <= view; step *= 2) high += std::min(models - high, step);
  while (high - low > 1 && low < high) {
    const std::uint32_t middle = low + (high - low) / 2;
    (models_[middle].first_view <= view ? low : high) = middle;
  }
  return low;
}

format::Parameters parametersOf(const Profile& profile) {
  format::Parameters p{};
  const char* const name = profile.projection ? kDefaultProfile : kPaperProfile;
  std::memcpy(p.profile, name, std::strlen(name));
  p.revision = profile.projection ? kDepthDescriptorRevision : kDescriptorRevision;
  const DescriptorParams params = profile.projection ? profile.projection->descriptorParams() : profile.params;
  p.pairs = params.pairs;
  p.seed = params.seed;
  p.code_bytes = static_cast<std::uint32_t>(profile.codeBytes());
  if (profile.projection)
    p.projection_crc32c = crc32c(profile.projection->bytes().data, profile.projection->bytes().size);
  return p;
}

std::uint32_t codeDistance(const Profile& profile, const std::uint8_t* a, const std::uint8_t* b) {
  return profile.projection ? squaredDistance(a, b, profile.codeBytes()) : l1(a, b);
}

Key bucketKeyOf(const Profile& profile, const std::uint8_t* code) {
  if (!profile.projection) return keyOf(code);
  return Key{profile.projection->listOf(unpackCode(code, profile.codeBytes()))};
}

}  // namespace voxid
