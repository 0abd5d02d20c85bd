// SPDX-License-Identifier: BSD-3-Clause
#include "recogniser.h"

#include "voxid/core/coarse.h"

namespace voxid::cli {
namespace {

double shareOf(int permille) { return permille / 1000.0; }

std::uint32_t synsetOf(const Index& index, std::uint32_t category) {
  return category < index.categories().size ? index.categories()[category].synset : 0;
}

Json jsonOf(const Index& index, const Alternative& alternative) {
  Json json;
  json["label"] = std::string(index.categoryName(alternative.category));
  json["synset"] = synsetOf(index, alternative.category);
  json["sense"] = std::string(index.senseOf(alternative.category));
  json["score"] = shareOf(alternative.score_permille);
  json["distance"] = alternative.distance;
  return json;
}

}  // namespace

void SearchChoice::addTo(CLI::App& app) {
  CLI::Option* const all = app.add_flag("--exact", params.exact, "Compare with every view (default)");
  const auto addQuick = [&](const char* name, int SearchParams::*number, int least, int most, const char* about) {
    const auto choose = [this, number](int chosen) {
      params.exact = false;
      params.*number = chosen;
    };
    return app.add_option_function<int>(name, choose, about)
        ->type_name("N")
        ->check(CLI::Range(least, most))
        ->excludes(all);
  };
  CLI::Option* const radius = addQuick("--radius", &SearchParams::radius_bits, 0, kKeyBits,
                                       "Compare with the buckets within N bits only (descriptor paper)");
  addQuick("--lists", &SearchParams::lists, 1, 65536, "Compare with the N nearest lists only (descriptor default)")
      ->excludes(radius);
  quick_ = {app.get_option("--radius"), app.get_option("--lists")};
}

Status SearchChoice::check(const Index& index) const {
  const CLI::Option* const foreign = index.projection() ? quick_[0] : quick_[1];
  if (foreign == nullptr || foreign->count() == 0) return {};
  return Status::badUse(foreign->get_name() + " is for an index of descriptor " +
                        (index.projection() ? "paper" : "default") + "; " + index.path() + " is of the other; use " +
                        (index.projection() ? quick_[1] : quick_[0])->get_name());
}

Recogniser::Recogniser(std::shared_ptr<const Index> index, const SearchChoice& choice)
    : index_(std::move(index)),
      encoder_(makeEncoder(index_->profile())),
      code_(index_->parameters().code_bytes),
      search_(makeSearch(index_, choice.params)) {}

const Nearest* Recogniser::nearest(const DepthView& depth, Span<const std::uint32_t> pixels,
                                   const AllowedCategories& allowed) {
  if (encoder_->encode(depth, pixels, code_.data()) != DescribeStatus::Ok) return nullptr;
  return &search_->find(code_.data(), {{allowed.data(), allowed.size()}});
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
  const CoarseAnswer coarse = coarseAnswer(index, answer);
  object["coarse"] = std::string(coarse.synset);
  object["coarse_score"] = shareOf(coarse.score_permille);
  object["model"] = "";
  object["view"] = nullptr;
  if (answer.count == 0) return;
  const format::View view = index.view(answer.alternatives[0].view);
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
