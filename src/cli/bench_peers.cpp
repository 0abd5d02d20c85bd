// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "bench_search.h"

#ifdef VOXID_HAVE_HNSWLIB
#include <hnswlib/hnswlib.h>
#endif
#ifdef VOXID_HAVE_FLANN
#include <flann/flann.hpp>
#endif

namespace voxid::cli {
namespace {

#ifdef VOXID_HAVE_HNSWLIB

int hnswDistance(const void* a, const void* b, const void* distance) {
  const auto of = *static_cast<const CodeDistance*>(distance);
  return static_cast<int>(of(static_cast<const std::uint8_t*>(a), static_cast<const std::uint8_t*>(b)));
}

/// Codes of an index, so that hnswlib searches by the same distance as voxid.
class CodeSpace : public hnswlib::SpaceInterface<int> {
 public:
  CodeSpace(std::size_t bytes, CodeDistance distance) : bytes_(bytes), distance_(distance) {}
  std::size_t get_data_size() override { return bytes_; }
  hnswlib::DISTFUNC<int> get_dist_func() override { return hnswDistance; }
  void* get_dist_func_param() override { return &distance_; }

 private:
  std::size_t bytes_;
  CodeDistance distance_;
};

struct Hnsw {
  Hnsw(const Index& index, CodeDistance distance)
      : space(index.parameters().code_bytes, distance), graph(&space, index.viewCount(), kLinks, kBuildBreadth) {
    for (std::uint32_t view = 0; view < index.viewCount(); ++view) graph.addPoint(index.code(view), view);
  }

  double bytes() const {
    double upper = 0;
    for (const int level : graph.element_levels_) upper += static_cast<double>(graph.size_links_per_element_) * level;
    return static_cast<double>(graph.size_data_per_element_ + sizeof(void*)) *
               static_cast<double>(graph.max_elements_) +
           upper;
  }

  static constexpr std::size_t kLinks = 16, kBuildBreadth = 100;  // M and ef_construction
  CodeSpace space;
  hnswlib::HierarchicalNSW<int> graph;
};

Contender hnsw(const Index& index, CodeDistance distance) {
  const auto built = std::make_shared<Hnsw>(index, distance);
  Contender contender;
  contender.name = "query/hnswlib";
  contender.knob = "ef";
  contender.settings = {10, 16, 32, 64, 128, 256, 512};
  contender.bytes_per_view = built->bytes() / static_cast<double>(index.viewCount());
  contender.prepare = [built](int ef) { built->graph.setEf(static_cast<std::size_t>(ef)); };
  contender.find = [built](const std::uint8_t* code, std::vector<std::uint32_t>& ten) {
    auto found = built->graph.searchKnn(code, kTen);  // the farthest on top
    ten.resize(found.size());
    for (std::size_t place = found.size(); place-- > 0; found.pop()) {
      ten[place] = static_cast<std::uint32_t>(found.top().second);
    }
  };
  return contender;
}

#endif
#ifdef VOXID_HAVE_FLANN

using FlannL1 = flann::L1<unsigned char>;

/// Four randomised trees, FLANN's usual choice. The codes stay where they are.
struct Flann {
  explicit Flann(const Index& index)
      : codes(const_cast<unsigned char*>(index.code(0)), index.viewCount(), index.parameters().code_bytes),
        trees(codes, flann::KDTreeIndexParams(4)) {
    flann::seed_random(1);
    trees.buildIndex();
  }
  flann::Matrix<unsigned char> codes;
  flann::KDTreeIndex<FlannL1> trees;
};

Contender flannTrees(const Index& index) {
  const auto built = std::make_shared<Flann>(index);
  const auto params = std::make_shared<flann::SearchParams>();
  params->cores = 1;
  Contender contender;
  contender.name = "query/flann";
  contender.knob = "checks";
  contender.settings = {256, 1024, 4096, 16384};
  contender.bytes_per_view = index.parameters().code_bytes +
                             static_cast<double>(built->trees.usedMemory()) / static_cast<double>(index.viewCount());
  contender.prepare = [params](int checks) { params->checks = checks; };
  contender.find = [built, params, bytes = index.parameters().code_bytes](const std::uint8_t* code,
                                                                          std::vector<std::uint32_t>& ten) {
    std::size_t found[kTen];
    float distances[kTen];
    flann::Matrix<std::size_t> places(found, 1, kTen);
    flann::Matrix<float> lengths(distances, 1, kTen);
    const int count = built->trees.knnSearch(flann::Matrix<unsigned char>(const_cast<unsigned char*>(code), 1, bytes),
                                             places, lengths, kTen, *params);
    ten.assign(found, found + count);
  };
  return contender;
}

#endif

}  // namespace

std::vector<Contender> peersOf(const Index& index, CodeDistance distance) {
  std::vector<Contender> peers;
#ifdef VOXID_HAVE_HNSWLIB
  peers.push_back(hnsw(index, distance));
#endif
#ifdef VOXID_HAVE_FLANN
  if (distance == CodeDistance{l1}) peers.push_back(flannTrees(index));
#endif
  (void)index, (void)distance;
  return peers;
}

}  // namespace voxid::cli
