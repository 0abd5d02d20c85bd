// SPDX-License-Identifier: BSD-3-Clause
// The views of an index, rendered again and described in other ways.
#pragma once

#include <sys/mman.h>

#include <memory>
#include <new>
#include <string>
#include <vector>

#include "compare_codes.h"
#include "nearest_codes.h"
#include "voxid/core/index.h"
#include "voxid/core/status.h"

namespace voxid::cli {

/// Zeroed memory that forked processes share.
class SharedBytes {
 public:
  explicit SharedBytes(std::size_t size) : size_(size) {
    void* const bytes = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (bytes == MAP_FAILED) throw std::bad_alloc();
    bytes_ = static_cast<std::uint8_t*>(bytes);
  }
  ~SharedBytes() { ::munmap(bytes_, size_); }
  SharedBytes(const SharedBytes&) = delete;
  SharedBytes& operator=(const SharedBytes&) = delete;

  std::uint8_t* data() const { return bytes_; }
  std::size_t size() const { return size_; }

 private:
  std::uint8_t* bytes_;
  std::size_t size_;
};

/// The codes of chosen views, by one descriptor.
struct CodeTable {
  CodeTable(std::size_t views, std::size_t code_bytes)
      : bytes(code_bytes), codes(views * code_bytes), answered(views) {}

  std::uint8_t* code(std::size_t row) const { return codes.data() + row * bytes; }
  bool hasAnswer(std::size_t row) const { return answered.data()[row] != 0; }

  std::size_t bytes;
  SharedBytes codes, answered;  ///< answered: 1 where the descriptor has an answer
};

struct ComparedViews {
  std::vector<std::uint32_t> views;                ///< numbers in the index, ascending
  std::vector<std::unique_ptr<CodeTable>> tables;  ///< by descriptor

  /// For a search by one of the descriptors; `this` outlives it.
  CodeSearch::CodeAt codesOf(std::size_t descriptor) const {
    const CodeTable* const table = tables[descriptor].get();
    return [table](std::size_t row) { return table->hasAnswer(row) ? table->code(row) : nullptr; };
  }
};

/// Renders every view of the index whose direction is a multiple of `every` as the build did, from the meshes in
/// `models`, and describes it in all ways, in `jobs` processes. CannotDo for a model whose mesh is missing, or if a
/// view's code is not the one in the index: then `models` is not what the index was made from.
Result<ComparedViews> describeViews(const Index& index, const std::string& models, int every, int jobs);

}  // namespace voxid::cli
