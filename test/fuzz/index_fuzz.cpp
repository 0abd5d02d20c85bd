// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as an index: refused, or used without harm. Once as they are, once with the sums that a writer would have
// made, without which next to nothing would pass the header.
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

#include "memory_file.h"
#include "voxid/core/classifier.h"
#include "voxid/core/crc32c.h"
#include "voxid/core/index.h"
#include "voxid/core/kept_surface.h"
#include "voxid/core/search.h"
#include "voxid/library/index_writer.h"

namespace {

using namespace voxid;
using Bytes = std::vector<std::uint8_t>;

void search(const std::shared_ptr<const Index>& index) {
  const std::vector<std::uint8_t> code(index->parameters().code_bytes, 9);
  for (const SearchParams& params :
       {SearchParams{true, 0, 0}, SearchParams{false, 4, 2}, SearchParams{false, kKeyBits, 65536}}) {
    const std::unique_ptr<Search> search = makeSearch(index, params);
    const Answer answer = classify(*index, search->find(code.data()), ClassifyMethod::Vote, 0);
    for (int i = 0; i < answer.count; ++i) {
      const Alternative& alternative = answer.alternatives[static_cast<std::size_t>(i)];
      if (alternative.view >= index->viewCount()) std::abort();
      index->categoryName(alternative.category);
      index->modelName(index->modelOf(alternative.view));
    }
  }
}

void lookAtSurfaces(const Index& index) {
  std::uint64_t sum = 0;
  for (std::uint32_t model = 0; model < index.models().size; ++model) {
    const auto kept = KeptSurface::of(index.surface(model));
    for (std::uint32_t i = 0; kept && i < kept->header().triangles; ++i) {
      for (const std::uint16_t corner : kept->triangle(i)) sum += static_cast<std::uint64_t>(kept->vertex(corner)[2]);
    }
  }
  volatile std::uint64_t read = sum;
  (void)read;
}

void use(const Bytes& bytes) {
  const fuzz::MemoryFile file(bytes.data(), bytes.size());
  const auto index = Index::open(file.path());
  if (index.ok() == !index.status.sentence.empty()) std::abort();  // a refusal has a reason
  if (!index.ok()) return;
  search(index.value);
  lookAtSurfaces(*index.value);
  (void)index.value->verify();
  (void)readContent(*index.value);
}

/// visit(tag, first byte, length, section's sum) of each section that lies in the file.
template <typename Visit>
void visitSections(Bytes& bytes, std::uint32_t sections, Visit visit) {
  for (std::uint32_t i = 0; i < sections; ++i) {
    std::uint8_t* const entry = bytes.data() + sizeof(format::Header) + i * sizeof(format::Section);
    format::Section section;
    std::memcpy(&section, entry, sizeof section);
    if (section.offset > bytes.size() || section.length > bytes.size() - section.offset) continue;
    visit(std::string(section.tag, sizeof section.tag), bytes.data() + section.offset, section.length, section.crc32c);
    std::memcpy(entry, &section, sizeof section);
  }
}

/// The sum inside PROJ, and the one of PROJ in PARM.
void sumProjection(Bytes& bytes, std::uint32_t sections) {
  std::uint32_t sum = 0;
  visitSections(bytes, sections,
                [&](const std::string& tag, std::uint8_t* first, std::uint64_t length, std::uint32_t&) {
                  if (tag != "PROJ" || length < sizeof(format::Projection)) return;
                  std::uint8_t* const own = first + offsetof(format::Projection, crc32c);
                  std::memset(own, 0, sizeof sum);
                  sum = crc32c(first, length);
                  std::memcpy(own, &sum, sizeof sum);
                  sum = crc32c(first, length);
                });
  visitSections(bytes, sections,
                [&](const std::string& tag, std::uint8_t* first, std::uint64_t length, std::uint32_t&) {
                  if (tag == "PARM" && length == sizeof(format::Parameters))
                    std::memcpy(first + offsetof(format::Parameters, projection_crc32c), &sum, sizeof sum);
                });
}

void sumSections(Bytes& bytes, format::Header& header) {
  visitSections(bytes, header.sections,
                [&](const std::string& tag, const std::uint8_t* first, std::uint64_t length, std::uint32_t& sum) {
                  sum = crc32c(first, length);
                  if (tag == "PARM") header.descriptor_crc32c = sum;
                });
}

/// Makes the header and all sums fit what follows.
void repair(Bytes& bytes) {
  bytes.resize((bytes.size() + format::kAlignment - 1) / format::kAlignment * format::kAlignment);
  format::Header header;
  if (bytes.size() < sizeof header) return;
  std::memcpy(&header, bytes.data(), sizeof header);
  std::memcpy(header.magic, format::kMagic, sizeof header.magic);
  header.major = format::kMajor;
  header.header_bytes = sizeof header;
  header.file_bytes = bytes.size();
  const std::size_t room = (bytes.size() - sizeof header) / sizeof(format::Section);
  header.sections = static_cast<std::uint32_t>(std::min<std::size_t>({header.sections, format::kMaxSections, room}));
  sumProjection(bytes, header.sections);
  sumSections(bytes, header);
  header.crc32c = 0;
  std::memcpy(bytes.data(), &header, sizeof header);
  header.crc32c = crc32c(bytes.data(), sizeof header + header.sections * sizeof(format::Section));
  std::memcpy(bytes.data(), &header, sizeof header);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, data + size);
  use(bytes);
  repair(bytes);
  use(bytes);
  return 0;
}
