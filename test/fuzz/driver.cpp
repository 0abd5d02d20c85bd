// SPDX-License-Identifier: BSD-3-Clause
// Stands in for libFuzzer where the compiler has none: the same mutations of the same seeds every time.
//   NAME RUNS FILE...     with RUNS 0 the files themselves only
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;

class Mutator {
 public:
  Bytes mutated(Bytes bytes) {
    for (std::uint64_t changes = 1 + below(6); changes > 0; --changes) change(bytes);
    return bytes;
  }

 private:
  std::uint64_t next() {  // SplitMix64
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
    z = (z ^ z >> 27) * 0x94d049bb133111eb;
    return z ^ z >> 31;
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(next() % n); }

  void change(Bytes& bytes) {
    if (bytes.empty()) return;
    const std::size_t at = below(bytes.size());
    const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const std::size_t run = 1 + below(std::min<std::size_t>(bytes.size() - at, 64));
    switch (below(6)) {
      case 0:
        bytes[at] ^= static_cast<std::uint8_t>(1u << below(8));
        break;
      case 1:
        bytes[at] = static_cast<std::uint8_t>(next());
        break;
      case 2:
        overwrite(bytes, at);
        break;
      case 3:
        bytes.erase(place, place + static_cast<std::ptrdiff_t>(run));
        break;
      case 4: {
        const Bytes copy(place, place + static_cast<std::ptrdiff_t>(run));
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(below(bytes.size())), copy.begin(), copy.end());
        break;
      }
      default:
        if (below(8) == 0) bytes.resize(at);
    }
  }

  void overwrite(Bytes& bytes, std::size_t at) {
    static constexpr std::uint64_t kEdges[] = {0, 1, 0x7f, 0xff, 0x7fffffff, 0x80000000, 0xffffffff, ~std::uint64_t{0}};
    const std::uint64_t value = kEdges[below(8)];
    const std::size_t width = std::min(std::size_t{1} << below(4), bytes.size() - at);
    for (std::size_t i = 0; i < width; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> 8 * i);
  }

  std::uint64_t state_ = 1;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  std::vector<Bytes> seeds;
  for (int i = 2; i < argc; ++i) {
    std::ifstream file(argv[i], std::ios::binary);
    if (!file) return std::fprintf(stderr, "%s cannot be read\n", argv[i]), 2;
    seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    LLVMFuzzerTestOneInput(seeds.back().data(), seeds.back().size());
  }
  Mutator mutator;
  const long runs = std::strtol(argv[1], nullptr, 10);
  for (long run = 0; run < runs && !seeds.empty(); ++run) {
    const Bytes bytes = mutator.mutated(seeds[static_cast<std::size_t>(run) % seeds.size()]);
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  std::printf("%ld runs\n", runs);
}
