// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace voxid {

/// STRS: every string once, in order of first use; offset 0 is the empty one. Found by open addressing, four bytes a
/// slot, because there may be millions.
class StringTable {
 public:
  std::uint32_t add(std::string_view text) {
    if (text.empty()) return 0;
    if (2 * (count_ + 1) > slots_.size()) grow();
    std::uint32_t& slot = slotOf(text);
    if (slot == 0) {
      slot = static_cast<std::uint32_t>(bytes_.size());
      bytes_.append(text).push_back('\0');
      ++count_;
    }
    return slot;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  // Its own, or the empty one (0) where it belongs.
  std::uint32_t& slotOf(std::string_view text) {
    std::size_t i = std::hash<std::string_view>()(text) % slots_.size();
    while (slots_[i] != 0 && textAt(slots_[i]) != text) i = (i + 1) % slots_.size();
    return slots_[i];
  }
  std::string_view textAt(std::uint32_t offset) const { return bytes_.data() + offset; }
  void grow() {
    std::vector<std::uint32_t> old(slots_.size() * 2);
    old.swap(slots_);
    for (const std::uint32_t offset : old) {
      if (offset != 0) slotOf(textAt(offset)) = offset;
    }
  }

  std::string bytes_{std::string(1, '\0')};
  std::vector<std::uint32_t> slots_ = std::vector<std::uint32_t>(64);
  std::size_t count_ = 0;
};

}  // namespace voxid
