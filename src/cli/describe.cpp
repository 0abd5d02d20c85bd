// SPDX-License-Identifier: BSD-3-Clause
// voxid describe: the descriptor of an object.
#include <algorithm>
#include <cctype>
#include <cinttypes>
#include <cstdio>
#include <iostream>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "command.h"
#include "depth_file.h"
#include "point_file.h"
#include "recogniser.h"
#include "voxid/core/key.h"

namespace voxid::cli {
namespace {

struct Options {
  std::string file, plot;
  CameraChoice camera;
  DescriptorParams params;
  bool json = false;
};

struct Description {
  std::size_t points = 0;  ///< that the file holds; NaN and no depth not counted
  Described described;
};

Result<Description> describePoints(const Options& options, Describer& describer) {
  const auto points = readPointFile(options.file);
  if (!points.ok()) return points.status;
  return Description{points.value.size(), describer.describe({points.value.data(), points.value.size()})};
}

Result<Description> describeImage(const Options& options, Describer& describer) {
  const auto file = readDepthFile(options.file, options.camera);
  if (!file.ok()) return file.status;
  const std::vector<std::uint32_t> pixels = setPixels(file.value.view());
  return Description{pixels.size(), describer.describe(file.value.view(), {pixels.data(), pixels.size()})};
}

std::string statusText(DescribeStatus status) {
  std::string text = nameOf(status);
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string keyText(const Descriptor& bins) {
  char text[24];
  std::snprintf(text, sizeof text, "0x%013" PRIx64, keyOf(bins));
  return text;
}

Json toJson(const Options& options, const Description& description) {
  const Descriptor& bins = description.described.bins;
  Json json;
  json["file"] = options.file;
  json["status"] = statusText(description.described.status);
  json["points"] = description.points;
  json["descriptor"] = "paper";
  json["pairs"] = options.params.pairs;
  json["seed"] = options.params.seed;
  json["key"] = keyText(bins);
  json["bins"] = bins;
  json["histograms"] = Json::object();
  for (const SubHistogram& h : kSubHistograms) {
    json["histograms"][h.name] = std::vector<int>(bins.begin() + h.first_bin, bins.begin() + h.first_bin + h.bins);
  }
  return json;
}

void printForPeople(const Options& options, const Description& description) {
  const Descriptor& bins = description.described.bins;
  std::printf("%s: %s, %zu points, key %s\n", options.file.c_str(), statusText(description.described.status).c_str(),
              description.points, keyText(bins).c_str());
  for (const SubHistogram& h : kSubHistograms) {
    std::printf("%s\n", h.name);
    for (int i = 0; i < h.bins; ++i) {
      std::printf("%4d%s", bins[static_cast<std::size_t>(h.first_bin + i)],
                  i % 32 == 31 || i + 1 == h.bins ? "\n" : "");
    }
  }
}

/// One panel: bars over the bins, the highest bin's value at the top left.
void drawHistogram(const SubHistogram& h, const Descriptor& bins, cv::Mat panel) {
  constexpr int kMargin = 24;
  const cv::Scalar ink{60, 60, 60}, bar{170, 100, 40};
  const int width = panel.cols - 2 * kMargin, height = panel.rows - 2 * kMargin, base = panel.rows - kMargin;
  const auto first = bins.begin() + h.first_bin;
  const int highest = *std::max_element(first, first + h.bins);
  for (int i = 0; i < h.bins; ++i) {
    const int left = kMargin + width * i / h.bins, right = kMargin + width * (i + 1) / h.bins - 1;
    const int top = base - height * first[i] / std::max(highest, 1);
    if (first[i] > 0) cv::rectangle(panel, {left, top}, {std::max(left, right), base}, bar, cv::FILLED);
  }
  cv::line(panel, {kMargin, base}, {panel.cols - kMargin, base}, ink, 1);
  const std::string title =
      std::string(h.name) + ", " + std::to_string(h.bins) + " bins, highest " + std::to_string(highest);
  cv::putText(panel, title, {kMargin, kMargin - 8}, cv::FONT_HERSHEY_SIMPLEX, 0.42, ink, 1, cv::LINE_AA);
}

/// The six sub-histograms side by side, as in the paper's Fig. 7.
cv::Mat drawDescriptor(const Descriptor& bins) {
  constexpr int kWidth = 360, kHeight = 220, kColumns = 3;
  cv::Mat picture(2 * kHeight, kColumns * kWidth, CV_8UC3, cv::Scalar(255, 255, 255));
  int i = 0;
  for (const SubHistogram& h : kSubHistograms) {
    drawHistogram(h, bins, picture({i % kColumns * kWidth, i / kColumns * kHeight, kWidth, kHeight}));
    ++i;
  }
  return picture;
}

Status statusOf(const Options& options, const Description& description) {
  switch (description.described.status) {
    case DescribeStatus::Ok:
      return {};
    case DescribeStatus::Empty:
      return Status::nothingFound(options.file + ": no point in it; a descriptor needs at least two");
    case DescribeStatus::Degenerate:
      break;
  }
  return Status::nothingFound(options.file + ": " + std::to_string(description.points) +
                              (description.points == 1 ? " point" : " points in one place") +
                              "; a descriptor needs at least two that differ");
}

Status run(const Options& options) {
  Describer describer(options.params);
  const auto description =
      isPointFile(options.file) ? describePoints(options, describer) : describeImage(options, describer);
  if (!description.ok()) return description.status;
  if (options.json) {
    std::cout << lineOf(toJson(options, description.value));
  } else {
    printForPeople(options, description.value);
  }
  if (!options.plot.empty()) {
    const Status status = writeImage(options.plot, drawDescriptor(description.value.described.bins));
    if (!status.ok()) return status;
  }
  return statusOf(options, description.value);
}

}  // namespace

Run addDescribe(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("file", options->file, "A depth image whose set pixels are the object, or points (.pcd, .xyz; metres)")
      ->type_name("FILE")
      ->required();
  options->camera.addTo(app);
  app.add_option("--pairs", options->params.pairs, "Lines drawn")
      ->capture_default_str()
      ->check(CLI::Range(1u, 1000000u));
  app.add_option("--seed", options->params.seed, "Of the generator that draws them")->capture_default_str();
  app.add_flag("--json", options->json, "One JSON object");
  app.add_option("--plot", options->plot, "Draw the six histograms")->type_name("PATH.png");
  return [options] { return run(*options); };
}

}  // namespace voxid::cli
