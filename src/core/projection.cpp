// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/projection.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstring>

#include "code_distance.h"
#include "vectorised.h"
#include "voxid/core/crc32c.h"

namespace voxid {
namespace {

constexpr std::uint32_t kMaxLists = 65536;
constexpr std::int32_t kMaxBias = 1 << 30;

std::size_t bytesOf(const format::Projection& header) {
  return sizeof header + kCodeNumbers * (header.bins + 2 * sizeof(std::int32_t) + header.lists) +
         sizeof(format::Calibration);
}

std::uint32_t sumOf(Span<const std::uint8_t> bytes, format::Projection header) {
  header.crc32c = 0;
  return crc32c(bytes.data + sizeof header, bytes.size - sizeof header, crc32c(&header, sizeof header));
}

// Every row's product with the bins: below 2,132 x 128 x 255 < 2^27. As 16-bit factors, for pmaddwd.
VOXID_VECTORISED void multiply(const std::int8_t* matrix, std::size_t rows, const std::uint8_t* bins,
                               std::int32_t* out) {
  std::array<std::int16_t, kDepthBins> wide;
  for (std::size_t i = 0; i < wide.size(); ++i) wide[i] = bins[i];
  for (std::size_t row = 0; row < rows; ++row, matrix += kDepthBins) {
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < wide.size(); ++i) sum += static_cast<std::int16_t>(matrix[i]) * wide[i];
    out[row] = sum;
  }
}

std::int64_t clamped(std::int64_t value, std::int64_t most) { return std::min(std::max(value, -most), most); }

Result<std::vector<std::uint8_t>> readBytes(const std::string& path) {
  std::FILE* const file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) return Status::cannotDo("cannot read the projection " + path + ": " + std::strerror(errno));
  std::vector<std::uint8_t> bytes;
  std::array<std::uint8_t, 65536> block;
  constexpr std::size_t kMost = std::size_t{64} << 20;
  while (const std::size_t read = std::fread(block.data(), 1, block.size(), file)) {
    bytes.insert(bytes.end(), block.begin(), block.begin() + static_cast<std::ptrdiff_t>(read));
    if (bytes.size() > kMost) break;
  }
  const bool failed = std::ferror(file) != 0;
  const int error = errno;
  std::fclose(file);
  if (failed) return Status::cannotDo("cannot read the projection " + path + ": " + std::strerror(error));
  return bytes;
}

}  // namespace

Result<std::shared_ptr<const Projection>> Projection::read(const std::string& path) {
  const auto bytes = readBytes(path);
  if (!bytes.ok()) return bytes.status;
  return fromBytes({bytes.value.data(), bytes.value.size()}, path);
}

Result<std::shared_ptr<const Projection>> Projection::fromBytes(Span<const std::uint8_t> bytes,
                                                                const std::string& name) {
  const std::shared_ptr<Projection> projection(new Projection);
  projection->bytes_.assign(bytes.begin(), bytes.end());
  const Status status = projection->check(name);
  if (!status.ok()) return status;
  const format::Projection& h = *projection->header_;
  const std::uint8_t* at = projection->bytes_.data() + sizeof h;
  projection->matrix_ = reinterpret_cast<const std::int8_t*>(at);
  at += kCodeNumbers * h.bins;
  projection->bias_ = reinterpret_cast<const std::int32_t*>(at);
  projection->factor_q24_ = projection->bias_ + kCodeNumbers;
  at += 2 * sizeof(std::int32_t) * kCodeNumbers;
  projection->centroids_ = reinterpret_cast<const std::int8_t*>(at);
  projection->calibration_ = reinterpret_cast<const format::Calibration*>(at + std::size_t{h.lists} * kCodeNumbers);
  for (std::size_t i = 0; i < kCodeNumbers; ++i) {
    const bool bounded =
        projection->bias_[i] > -kMaxBias && projection->bias_[i] < kMaxBias && projection->factor_q24_[i] >= 0;
    if (!bounded) return Status::damaged("the projection " + name + " is damaged: a number is out of range");
  }
  return std::shared_ptr<const Projection>(projection);
}

Status Projection::check(const std::string& name) {
  const auto damaged = [&](const char* what) {
    return Status::damaged("the projection " + name + " is damaged: " + what);
  };
  if (bytes_.size() < sizeof(format::Projection)) return damaged("it is too short");
  header_ = reinterpret_cast<const format::Projection*>(bytes_.data());
  const format::Projection& h = *header_;
  if (std::memcmp(h.magic, format::kProjectionMagic, sizeof h.magic) != 0) return damaged("it does not begin like one");
  if (h.version != format::kProjectionVersion || h.revision != kDepthDescriptorRevision || h.bins != kDepthBins ||
      h.numbers != kCodeNumbers) {
    return Status::cannotDo("the projection " + name + " is of version " + std::to_string(h.version) +
                            ", descriptor revision " + std::to_string(h.revision) + ", " + std::to_string(h.numbers) +
                            " numbers; this voxid uses " + std::to_string(format::kProjectionVersion) + ", " +
                            std::to_string(kDepthDescriptorRevision) + " and " + std::to_string(kCodeNumbers) +
                            "; make it anew: a projection with `voxid train`, an index with `voxid build`");
  }
  const bool sized = h.lists >= 1 && h.lists <= kMaxLists && h.pairs >= 1 && h.pairs <= kMaxPairs;
  if (!sized) return damaged("a size is out of range");
  if (bytesOf(h) != bytes_.size()) return damaged("its length is wrong");
  return sumOf(bytes(), h) == h.crc32c ? Status() : damaged("its checksum is wrong");
}

void Projection::project(const DepthBins& bins, std::size_t code_bytes, std::uint8_t* code) const {
  std::array<std::int32_t, kCodeNumbers> product;
  const std::size_t rows = numbersIn(code_bytes);
  multiply(matrix_, rows, bins.data(), product.data());
  std::array<std::int64_t, kCodeNumbers> scaled;
  for (std::size_t i = 0; i < rows; ++i) {
    scaled[i] = clamped(((std::int64_t{product[i]} + bias_[i]) * factor_q24_[i]) >> 24, (1 << 24) - 1);
  }
  packCode(scaled.data(), code_bytes, code);
}

std::uint32_t Projection::listOf(const CodeNumbers& numbers) const {
  constexpr std::uint32_t kBlock = 256;
  std::array<std::uint32_t, kBlock> distances;
  std::uint32_t nearest = 0, least = 0xffffffff;
  for (std::uint32_t first = 0; first < lists(); first += kBlock) {
    const std::uint32_t count = std::min(kBlock, lists() - first);
    squaredDistances(numbers, centroids_ + std::size_t{first} * kCodeNumbers, count, distances.data());
    const auto best = std::min_element(distances.begin(), distances.begin() + count);
    if (*best >= least) continue;
    least = *best;
    nearest = first + static_cast<std::uint32_t>(best - distances.begin());
  }
  return nearest;
}

std::vector<std::uint8_t> serialised(const ProjectionContent& content) {
  format::Projection header{};
  std::copy(std::begin(format::kProjectionMagic), std::end(format::kProjectionMagic), header.magic);
  header.version = format::kProjectionVersion;
  header.revision = kDepthDescriptorRevision;
  header.pairs = content.params.pairs;
  header.seed = content.params.seed;
  header.bins = kDepthBins;
  header.numbers = kCodeNumbers;
  header.lists = content.lists;
  header.views = content.views;
  header.models = content.models;
  header.categories = content.categories;
  std::vector<std::uint8_t> bytes(sizeof header);
  const auto append = [&](const void* data, std::size_t size) {
    const auto* const first = static_cast<const std::uint8_t*>(data);
    bytes.insert(bytes.end(), first, first + size);
  };
  append(content.matrix.data(), content.matrix.size());
  append(content.bias.data(), content.bias.size() * sizeof(std::int32_t));
  append(content.factor_q24.data(), content.factor_q24.size() * sizeof(std::int32_t));
  append(content.centroids.data(), content.centroids.size());
  append(&content.calibration, sizeof content.calibration);
  header.crc32c = sumOf({bytes.data(), bytes.size()}, header);
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes;
}

}  // namespace voxid
