// SPDX-License-Identifier: BSD-3-Clause
#include "recogniser.h"

namespace voxid::cli {
namespace {

double shareOf(int permille) { return permille / 1000.0; }

Json jsonOf(const Index& index, const Alternative& alternative) {
  Json json;
  json["label"] = std::string(index.categoryName(alternative.category));
  json["score"] = shareOf(alternative.score_permille);
  json["distance"] = alternative.distance;
  return json;
}

}  // namespace

void SearchChoice::addTo(CLI::App& app) {
  CLI::Option* const all = app.add_flag("--exact", exact, "Compare with every view (default)");
  app.add_option_function<int>(
         "--radius",
         [this](int bits) {
           exact = false;
           radius_bits = bits;
         },
         "Compare with the views of the hash table's buckets within N bits only")
      ->type_name("N")
      ->check(CLI::Range(0, kKeyBits))
      ->excludes(all);
}

std::unique_ptr<Search> SearchChoice::make(std::shared_ptr<const Index> index) const {
  return exact ? makeExactSearch(std::move(index)) : makeLshSearch(std::move(index), radius_bits);
}

Recogniser::Recogniser(std::shared_ptr<const Index> index, const SearchChoice& choice)
    : index_(std::move(index)), describer_(index_->descriptorParams()), search_(choice.make(index_)) {}

const Nearest* Recogniser::nearest(const DepthView& depth, Span<const std::uint32_t> pixels) {
  const Described described = describer_.describe(depth, pixels);
  if (described.status != DescribeStatus::Ok) return nullptr;
  return &search_->find(described.bins.data());
}

Answer Recogniser::recognise(const DepthView& depth, Span<const std::uint32_t> pixels, ClassifyMethod method,
                             int min_score_permille) {
  const Nearest* const found = nearest(depth, pixels);
  return found ? classify(*index_, *found, method, min_score_permille) : Answer{};
}

std::vector<std::uint32_t> setPixels(const DepthView& depth) {
  std::vector<std::uint32_t> pixels;
  for (int v = 0; v < depth.height_px; ++v) {
    for (int u = 0; u < depth.width_px; ++u) {
      if (depth.depthUm(u, v) > 0) pixels.push_back(static_cast<std::uint32_t>(v * depth.width_px + u));
    }
  }
  return pixels;
}

void addAnswer(const Index& index, const Answer& answer, Json& object) {
  object["label"] = answer.known ? std::string(index.categoryName(answer.alternatives[0].category)) : std::string();
  object["score"] = shareOf(answer.score_permille);
  object["alternatives"] = Json::array();
  for (int i = 0; i < answer.count; ++i) {
    object["alternatives"].push_back(jsonOf(index, answer.alternatives[static_cast<std::size_t>(i)]));
  }
  object["model"] = "";
  object["view"] = nullptr;
  if (answer.count == 0) return;
  const format::View& view = index.views()[answer.alternatives[0].view];
  if (view.model >= index.models().size) return;  // a damaged file; `verify` says where
  object["model"] = std::string(index.modelName(view.model));
  object["view"] = view.direction;
}

std::string captionOf(const Index& index, const Answer& answer) {
  if (answer.count == 0) return "?";
  const std::string text = std::string(index.categoryName(answer.alternatives[0].category)) + " " +
                           std::to_string((answer.score_permille + 5) / 10) + " %";
  return answer.known ? text : "? (" + text + ")";
}

std::string lineOf(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"; }

}  // namespace voxid::cli
