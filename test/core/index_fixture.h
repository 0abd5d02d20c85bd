// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "core/random.h"
#include "voxid/core/crc32c.h"
#include "voxid/library/index_writer.h"

namespace voxid::test {

/// A folder of its own, so that tests run in parallel; removed with the files that were asked for by name.
class Folder {
 public:
  Folder() : path_(testing::TempDir() + "voxid-XXXXXX") { EXPECT_NE(::mkdtemp(path_.data()), nullptr); }
  ~Folder() {
    for (const std::string& file : files_) std::remove(file.c_str());
    ::rmdir(path_.c_str());
  }
  std::string file(const std::string& name) {
    files_.push_back(path_ + "/" + name);
    return files_.back();
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::vector<std::string> files_;
};

inline std::string readBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void writeBytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

/// 416 bytes with few peaks, so that keys repeat and distances tie now and then.
inline std::vector<std::uint8_t> randomCode(Random& random) {
  std::vector<std::uint8_t> code(kDescriptorBytes);
  for (const SubHistogram& part : kSubHistograms) {
    const int peak = part.first_bin + random.below(3) * 8;
    for (int i = 0; i < 6; ++i) code[static_cast<std::size_t>(peak + i)] = static_cast<std::uint8_t>(random.below(50));
    code[static_cast<std::size_t>(peak)] = 60;
  }
  return code;
}

inline std::vector<format::Direction> someDirections(int count) {
  std::vector<format::Direction> directions(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    directions[static_cast<std::size_t>(i)].to_camera[i % 3] = static_cast<std::int16_t>(i < 3 ? 32767 : -32767);
    directions[static_cast<std::size_t>(i)].up[(i + 1) % 3] = 32767;
  }
  return directions;
}

/// Models "c<category>/m<number>" in shuffled order, each with `views` views.
inline IndexContent randomContent(int categories, int models, int views, std::uint64_t seed) {
  Random random(seed);
  IndexContent content;
  content.directions = someDirections(views);
  content.calibration = builtInCalibration({});
  for (int i = 0; i < categories * models; ++i) {
    const int shuffled = i * 7919 % (categories * models);
    ModelRecord model;
    model.category = "c" + std::to_string(100 + shuffled / models);
    model.name = "m" + std::to_string(shuffled % models);
    model.licence = "CC0";
    model.synset = static_cast<std::uint32_t>(1000 + shuffled / models);
    for (int k = 0; k < views; ++k) {
      model.views.push_back(
          {static_cast<std::uint8_t>(k), static_cast<std::uint32_t>(500 + k), {1, 2, 3}, randomCode(random)});
    }
    content.models.push_back(std::move(model));
  }
  return content;
}

/// The file `index` with one section more, the last.
inline std::string withSection(const std::string& index, const char* tag, const std::string& content) {
  const auto aligned = [](std::size_t bytes) {
    return (bytes + format::kAlignment - 1) / format::kAlignment * format::kAlignment;
  };
  format::Header header;
  std::memcpy(&header, index.data(), sizeof header);
  std::vector<format::Section> table(header.sections);
  std::memcpy(table.data(), index.data() + sizeof header, table.size() * sizeof table[0]);
  const std::size_t start = table[0].offset, moved = aligned(sizeof header + (table.size() + 1) * sizeof table[0]);
  for (format::Section& section : table) section.offset += moved - start;
  table.push_back({{}, crc32c(content.data(), content.size()), index.size() + moved - start, content.size(), {}});
  std::memcpy(table.back().tag, tag, sizeof table.back().tag);
  header.sections = static_cast<std::uint32_t>(table.size());
  header.file_bytes = aligned(table.back().offset + content.size());
  header.crc32c = 0;
  header.crc32c = crc32c(table.data(), table.size() * sizeof table[0], crc32c(&header, sizeof header));
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
  bytes.append(reinterpret_cast<const char*>(table.data()), table.size() * sizeof table[0]);
  bytes.resize(moved);
  bytes += index.substr(start) + content;
  bytes.resize(header.file_bytes);
  return bytes;
}

inline std::shared_ptr<const Index> openGood(const std::string& path) {
  const Result<std::shared_ptr<const Index>> index = Index::open(path);
  EXPECT_TRUE(index.ok()) << index.status.sentence;
  return index.value;
}

inline std::shared_ptr<const Index> writtenIndex(Folder& folder, const IndexContent& content) {
  const std::string path = folder.file("index.vxi");
  const Status written = writeIndex(content, path);
  EXPECT_TRUE(written.ok()) << written.sentence;
  return openGood(path);
}

}  // namespace voxid::test
