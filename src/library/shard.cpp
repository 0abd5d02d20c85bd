// SPDX-License-Identifier: BSD-3-Clause
#include "shard.h"

#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

#include "random.h"
#include "voxid/core/crc32c.h"
#include "voxid/core/index.h"

namespace voxid {
namespace {

constexpr char kMagic[] = "voxid shard 2\n";

class Writer {
 public:
  void bytes(const void* data, std::size_t size) { text_.append(static_cast<const char*>(data), size); }
  template <typename T>
  void number(T value) {
    bytes(&value, sizeof value);
  }
  template <typename Bytes>
  void sized(const Bytes& data) {
    number(static_cast<std::uint32_t>(data.size()));
    bytes(data.data(), data.size());
  }
  std::string text_;
};

class Reader {
 public:
  Reader(const std::string& text, std::size_t end) : text_(text), end_(end) {}

  bool failed() const { return failed_; }
  bool atEnd() const { return !failed_ && at_ == end_; }

  void bytes(void* data, std::size_t size) {
    if (size > end_ - at_) failed_ = true;
    if (failed_) return;
    std::memcpy(data, text_.data() + at_, size);
    at_ += size;
  }
  template <typename T>
  T number() {
    T value{};
    bytes(&value, sizeof value);
    return value;
  }
  template <typename Bytes>
  Bytes sized() {
    const std::size_t size = number<std::uint32_t>();
    if (size > end_ - at_) failed_ = true;
    Bytes data;
    if (failed_ || size == 0) return data;
    data.resize(size);
    bytes(&data[0], size);
    return data;
  }

 private:
  const std::string& text_;
  std::size_t at_ = 0, end_;
  bool failed_ = false;
};

void put(Writer& out, const ViewRecord& view) {
  out.number(view.direction);
  out.number(view.points);
  for (const std::uint16_t extent : view.extents) out.number(extent);
  out.sized(view.code);
}

ViewRecord takeView(Reader& in) {
  ViewRecord view;
  view.direction = in.number<std::uint8_t>();
  view.points = in.number<std::uint32_t>();
  for (std::uint16_t& extent : view.extents) extent = in.number<std::uint16_t>();
  view.code = in.sized<std::vector<std::uint8_t>>();
  return view;
}

ModelViews takeViews(Reader& in) {
  ModelViews views;
  views.refusal = in.sized<std::string>();
  views.calibration = in.sized<std::vector<std::uint8_t>>();
  views.surface = in.sized<std::vector<std::uint8_t>>();
  const std::uint32_t count = in.number<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && !in.failed(); ++i) views.views.push_back(takeView(in));
  return views;
}

Status writeFile(const std::string& path, const std::string& text) {
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return Status::cannotDo("cannot write " + path + ": " + std::strerror(errno));
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  const int write_error = errno;
  if (std::fclose(file) == 0 && written) return {};
  return Status::cannotDo("cannot write " + path + ": " + std::strerror(written ? errno : write_error));
}

}  // namespace

std::string ShardOrigin::bytes() const {
  Writer out;
  out.sized(file);
  out.number(file_bytes);
  out.number(file_mtime_ns);
  out.bytes(&parameters, sizeof parameters);
  out.number(views_every);
  out.number(keep_surface);
  out.number(kRecipeRevision);
  return out.text_;
}

ShardOrigin originOf(const ModelFile& model, const format::Parameters& parameters, const ViewChoice& choice) {
  ShardOrigin origin;
  origin.file = model.file;
  origin.parameters = parameters;
  origin.views_every = static_cast<std::uint32_t>(choice.views_every);
  origin.keep_surface = choice.keep_surface;
  struct stat about {};
  if (::stat(model.path.c_str(), &about) == 0) {
    origin.file_bytes = static_cast<std::uint64_t>(about.st_size);
    origin.file_mtime_ns = std::int64_t{about.st_mtim.tv_sec} * 1000000000 + about.st_mtim.tv_nsec;
  }
  return origin;
}

std::string shardPath(const std::string& parts, const ModelFile& model) {
  char name[32];
  std::snprintf(name, sizeof name, "/%016llx.shard", static_cast<unsigned long long>(seedOf(model.file)));
  return parts + name;
}

Status writeShard(const std::string& path, const ShardOrigin& origin, const ModelViews& views) {
  Writer out;
  out.bytes(kMagic, sizeof kMagic);
  out.sized(origin.bytes());
  out.sized(views.refusal);
  out.sized(views.calibration);
  out.sized(views.surface);
  out.number(static_cast<std::uint32_t>(views.views.size()));
  for (const ViewRecord& view : views.views) put(out, view);
  out.number(crc32c(out.text_.data(), out.text_.size()));

  return writeWhole(path, out.text_);
}

Status writeWhole(const std::string& path, const std::string& text) {
  const std::string beside = path + ".new";
  Status status = writeFile(beside, text);
  if (status.ok() && std::rename(beside.c_str(), path.c_str()) != 0) {
    status = Status::cannotDo("cannot write " + path + ": " + std::strerror(errno));
  }
  if (!status.ok()) std::remove(beside.c_str());
  return status;
}

Result<ModelViews> readShard(const std::string& path, const ShardOrigin& origin) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Status::cannotDo(path + ": " + std::strerror(errno));
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  std::uint32_t sum = 0;
  if (text.size() < sizeof kMagic + sizeof sum) return Status::damaged(path + " is cut");
  const std::size_t end = text.size() - sizeof sum;
  std::memcpy(&sum, text.data() + end, sizeof sum);
  if (std::memcmp(text.data(), kMagic, sizeof kMagic) != 0 || crc32c(text.data(), end) != sum) {
    return Status::damaged(path + " has a wrong sum");
  }
  Reader in(text, end);
  char magic[sizeof kMagic];
  in.bytes(magic, sizeof magic);
  if (in.sized<std::string>() != origin.bytes())
    return Status::cannotDo(path + " was made of another file or with other settings");
  ModelViews views = takeViews(in);
  if (!in.atEnd()) return Status::damaged(path + " is not whole");
  return views;
}

}  // namespace voxid
