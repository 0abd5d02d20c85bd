// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/coarse.h"

#include <algorithm>

namespace voxid {
namespace {

// `prefix` is a whole number of synsets of the path.
bool leadsThrough(std::string_view path, std::string_view prefix) {
  return path.substr(0, prefix.size()) == prefix && (path.size() == prefix.size() || path[prefix.size()] == '/');
}

int levelsOf(std::string_view path) {
  return path.empty() ? 0 : static_cast<int>(std::count(path.begin(), path.end(), '/')) + 1;
}

int scoreOf(const Index& index, const Answer& answer, std::string_view prefix) {
  int sum = 0;
  for (int i = 0; i < answer.count; ++i) {
    const Alternative& one = answer.alternatives[static_cast<std::size_t>(i)];
    if (leadsThrough(index.hypernymsOf(one.category), prefix)) sum += one.score_permille;
  }
  return sum;
}

}  // namespace

CoarseAnswer coarseAnswer(const Index& index, const Answer& answer, int min_score_permille) {
  const int enough = std::clamp(min_score_permille, 501, 1000);
  std::string_view best;
  int best_score = 0;
  for (int i = 0; i < answer.count; ++i) {
    std::string_view path = index.hypernymsOf(answer.alternatives[static_cast<std::size_t>(i)].category);
    for (int levels = levelsOf(path); levels > std::max(levelsOf(best), kLevelsThatSayNothing); --levels) {
      const int score = scoreOf(index, answer, path);
      if (score >= enough) {
        best = path;
        best_score = score;
      }
      path = path.substr(0, path.rfind('/'));
    }
  }
  if (best.empty()) return {};
  const std::size_t slash = best.rfind('/');
  return {best.substr(slash == std::string_view::npos ? 0 : slash + 1),
          static_cast<std::uint16_t>(std::min(best_score, 1000)),
          best == index.hypernymsOf(answer.alternatives[0].category)};
}

std::string wordsOf(std::string_view synset) {
  std::string words(synset.substr(0, synset.find('.')));
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

}  // namespace voxid
