// SPDX-License-Identifier: BSD-3-Clause
#include "bucket.h"

#include <algorithm>
#include <cctype>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <opencv2/imgproc.hpp>

#include "command.h"
#include "voxid/core/descriptor.h"
#include "voxid/library/mesh_reader.h"
#include "voxid/library/model_shelf.h"
#include "voxid/library/model_view.h"

namespace voxid::cli {
namespace {

const std::string kView = "view:";

std::string keyText(Key key) {
  char text[24];
  std::snprintf(text, sizeof text, "0x%013" PRIx64, key);
  return text;
}

/// <category>/<model> of a view.
std::string nameOf(const Index& index, std::uint32_t view) {
  const std::uint32_t model = index.modelOf(view);
  if (model >= index.models().size) return {};  // a damaged file; `verify` says where
  return fullNameOf(index, model);
}

bool parse(const std::string& digits, int base, std::uint64_t& number) {
  char* end = nullptr;
  number = std::strtoull(digits.c_str(), &end, base);
  return !digits.empty() && std::isxdigit(static_cast<unsigned char>(digits[0])) && *end == '\0';
}

Result<Key> wantedKey(const Index& index, const std::string& wanted) {
  std::uint64_t number = 0;
  if (wanted.compare(0, 2, "0x") == 0 && parse(wanted.substr(2), 16, number)) return Key{number};
  if (wanted.compare(0, kView.size(), kView) != 0 || !parse(wanted.substr(kView.size()), 10, number)) {
    return Status::badUse("--bucket " + wanted + ": expected a key such as 0x0020001008020 or view:N");
  }
  const std::size_t views = index.viewCount();
  if (number >= views) {
    return Status::badUse("--bucket " + wanted + ": " + index.path() + " has " + std::to_string(views) +
                          " views, numbered from 0");
  }
  return bucketKeyOf(index.profile(), index.code(static_cast<std::uint32_t>(number)));
}

// ---- the picture -----------------------------------------------------------------------------------------------

constexpr int kThumbnail = 150, kCaption = 22, kCellHeight = kThumbnail + kCaption;
constexpr int kFewestColumns = 2, kMostColumns = 8;  // the title takes two
constexpr std::size_t kMostDrawn = 48;

/// The object alone, cut out square; near pixels bright, far ones dark.
cv::Mat thumbnailOf(const ModelView& seen) {
  const cv::Mat depth(seen.image.view().height_px, seen.image.view().width_px, CV_16UC1,
                      const_cast<void*>(seen.image.view().data));
  const cv::Mat mask = depth > 0;
  double near = 0, far = 0;
  cv::minMaxLoc(depth, &near, &far, nullptr, nullptr, mask);
  cv::Mat grey;
  const double contrast = -170 / std::max(far - near, 1.0);
  depth.convertTo(grey, CV_8U, contrast, 230 - contrast * near);
  cv::Mat picture(depth.size(), CV_8UC1, cv::Scalar(255));
  grey.copyTo(picture, mask);

  const cv::Rect box = cv::boundingRect(mask);
  const int side = std::max({box.width, box.height, 1}) + 8;
  cv::Mat square(side, side, CV_8UC1, cv::Scalar(255));
  picture(box).copyTo(square({(side - box.width) / 2, (side - box.height) / 2, box.width, box.height}));
  cv::Mat thumbnail;
  cv::resize(square, thumbnail, {kThumbnail, kThumbnail}, 0, 0, cv::INTER_AREA);
  cv::cvtColor(thumbnail, thumbnail, cv::COLOR_GRAY2BGR);
  return thumbnail;
}

/// Renders views of models; keeps the last model's scene, as views of a model follow one another.
class Studio {
 public:
  explicit Studio(const std::string& folder) : folder_(folder) {}

  Result<ModelView> look(const std::string& model, int direction) {
    if (model != model_) {
      const Status status = load(model);
      if (!status.ok()) return status;
    }
    return drawModelView(scene_, model, direction);
  }

 private:
  Status load(const std::string& model) {
    const auto path = meshOf(folder_, model);
    if (!path.ok()) return path.status;
    const auto mesh = readMeshFile(path.value);
    if (!mesh.ok()) return mesh.status;
    scene_ = RayScene();
    scene_.add(mesh.value, unitPlacement(mesh.value));
    scene_.commit();
    model_ = model;
    return {};
  }

  std::string folder_, model_;
  RayScene scene_;
};

void write(const std::string& text, cv::Point at, cv::Mat picture) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.4, {60, 60, 60}, 1, cv::LINE_AA);
}

/// With its category below.
void drawThumbnail(const ModelView& seen, const std::string& name, cv::Mat cell) {
  constexpr std::size_t kMostLetters = 18;
  thumbnailOf(seen).copyTo(cell({0, 0, kThumbnail, kThumbnail}));
  write(name.substr(0, std::min(name.find('/'), kMostLetters)), {6, kThumbnail + 12}, cell);
}

std::vector<std::uint32_t> evenlyChosen(const std::vector<std::uint32_t>& views) {
  const std::size_t kept = std::min(views.size(), kMostDrawn);
  std::vector<std::uint32_t> chosen;
  for (std::size_t i = 0; i < kept; ++i) chosen.push_back(views[i * views.size() / kept]);
  return chosen;
}

std::string titleOf(const Bucket& bucket, std::size_t drawn) {
  std::string title = "key " + keyText(bucket.key) + ": " + counted(bucket.views.size(), "view");
  if (drawn < bucket.views.size()) title += ", " + std::to_string(drawn) + " of them drawn";
  return title;
}

}  // namespace

Result<Bucket> findBucket(const Index& index, const std::string& wanted) {
  const auto key = wantedKey(index, wanted);
  if (!key.ok()) return key.status;
  const Span<const Key> keys = index.keys();
  const Key* const found = std::lower_bound(keys.begin(), keys.end(), key.value);
  Bucket bucket{key.value, {}};
  if (found != keys.end() && *found == key.value) {
    for (const std::uint32_t view : index.bucket(static_cast<std::uint32_t>(found - keys.begin()))) {
      if (view < index.viewCount()) bucket.views.push_back(view);
    }
  }
  if (bucket.views.empty()) return Status::nothingFound(index.path() + ": no view has the key " + keyText(key.value));
  return bucket;
}

Json toJson(const Index& index, const Bucket& bucket) {
  Json json;
  json["key"] = keyText(bucket.key);
  json["views"] = Json::array();
  for (const std::uint32_t view : bucket.views) {
    json["views"].push_back(
        {{"view", view}, {"model", nameOf(index, view)}, {"direction", index.view(view).direction}});
  }
  return json;
}

void printBucket(const Index& index, const Bucket& bucket) {
  std::printf("%s\n", titleOf(bucket, bucket.views.size()).c_str());
  for (const std::uint32_t view : bucket.views) {
    std::printf("%9u  direction %2d  %s\n", view, index.view(view).direction, nameOf(index, view).c_str());
  }
}

Result<cv::Mat> drawBucket(const Index& index, const Bucket& bucket, const std::string& models) {
  Studio studio(models);
  const std::vector<std::uint32_t> views = evenlyChosen(bucket.views);
  const int columns = std::clamp(static_cast<int>(views.size()), kFewestColumns, kMostColumns);
  const int rows = (static_cast<int>(views.size()) + columns - 1) / columns;
  cv::Mat picture(kCaption + rows * kCellHeight, columns * kThumbnail, CV_8UC3, cv::Scalar(255, 255, 255));
  write(titleOf(bucket, views.size()), {6, 15}, picture);
  for (int i = 0; i < static_cast<int>(views.size()); ++i) {
    const std::uint32_t view = views[static_cast<std::size_t>(i)];
    const std::string name = nameOf(index, view);
    const auto seen = studio.look(name, index.view(view).direction);
    if (!seen.ok()) return seen.status;
    const int x = i % columns * kThumbnail, y = kCaption + i / columns * kCellHeight;
    drawThumbnail(seen.value, name, picture({x, y, kThumbnail, kCellHeight}));
  }
  return picture;
}

}  // namespace voxid::cli
