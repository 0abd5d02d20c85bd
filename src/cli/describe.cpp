// SPDX-License-Identifier: BSD-3-Clause
// voxid describe: the descriptor of an object.
#include <algorithm>
#include <cctype>
#include <cinttypes>
#include <cstdio>
#include <iostream>
#include <memory>

#include "command.h"
#include "compare_codes.h"
#include "depth_file.h"
#include "draw_descriptor.h"
#include "draw_lines.h"
#include "nearest_view.h"
#include "point_file.h"
#include "recogniser.h"
#include "voxid/core/key.h"
#include "voxid/library/mesh_reader.h"
#include "voxid/library/surface_points.h"

namespace voxid::cli {
namespace {

struct Options {
  std::string file, index, plot, plot_lines;
  CameraChoice camera;
  DescriptorParams params;
  bool json = false;
};

struct Description {
  std::vector<PointUm> points;  ///< that the file holds; NaN and no depth left out
  Described described;
  std::size_t triangles = 0;  ///< of a mesh
  MeshBox box;                ///< of a mesh, in its own unit
};

Result<Description> describePoints(const Options& options, Describer& describer) {
  const auto points = readPointFile(options.file);
  if (!points.ok()) return points.status;
  return Description{points.value, describer.describe({points.value.data(), points.value.size()}), 0, {}};
}

Result<Description> describeMesh(const Options& options, Describer& describer) {
  const auto mesh = readMeshFile(options.file);
  if (!mesh.ok()) return mesh.status;
  const std::vector<PointUm> points = surfacePoints(mesh.value);
  return Description{points, describer.describe({points.data(), points.size()}), mesh.value.triangles.size(),
                     boxOf(mesh.value)};
}

Result<Description> describeImage(const Options& options, Describer& describer) {
  const auto file = readDepthFile(options.file, options.camera);
  if (!file.ok()) return file.status;
  const std::vector<std::uint32_t> pixels = setPixels(file.value.view());
  const Span<const std::uint32_t> object{pixels.data(), pixels.size()};
  return Description{pointsOf(file.value.view(), object), describer.describe(file.value.view(), object), 0, {}};
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
  json["points"] = description.points.size();
  if (description.triangles > 0) {
    const MeshBox& box = description.box;
    json["triangles"] = description.triangles;
    json["extents"] = {box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]};
  }
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
              description.points.size(), keyText(bins).c_str());
  for (const SubHistogram& h : kSubHistograms) {
    std::printf("%s\n", h.name);
    for (int i = 0; i < h.bins; ++i) {
      std::printf("%4d%s", bins[static_cast<std::size_t>(h.first_bin + i)],
                  i % 32 == 31 || i + 1 == h.bins ? "\n" : "");
    }
  }
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
  return Status::nothingFound(options.file + ": " + std::to_string(description.points.size()) +
                              (description.points.size() == 1 ? " point" : " points in one place") +
                              "; a descriptor needs at least two that differ");
}

Status draw(const Options& options, const Description& description, const NearestView* match) {
  Status status;
  if (!options.plot.empty()) {
    const Descriptor& bins = description.described.bins;
    const DrawnMatch drawn = match ? DrawnMatch{match->bins(), captionOf(*match)} : DrawnMatch{};
    status = writeImage(options.plot, drawDescriptor(bins, match ? &drawn : nullptr));
  }
  const bool has_lines = description.described.status == DescribeStatus::Ok;
  if (status.ok() && has_lines && !options.plot_lines.empty()) {
    status = writeImage(options.plot_lines,
                        drawLines({description.points.data(), description.points.size()}, options.params));
  }
  return status;
}

void print(const Options& options, const Description& description, const NearestView* match) {
  if (options.json) {
    Json json = toJson(options, description);
    if (match) json["match"] = toJson(*match);
    std::cout << lineOf(json);
    return;
  }
  printForPeople(options, description);
  if (match) std::printf("nearest: %s\n", captionOf(*match).c_str());
}

Result<Description> describeFile(const Options& options) {
  Describer describer(options.params);
  if (isPointFile(options.file)) return describePoints(options, describer);
  if (isMeshFile(options.file)) return describeMesh(options, describer);
  return describeImage(options, describer);
}

Status run(Options options) {
  std::shared_ptr<const Index> index;
  if (!options.index.empty()) {
    const auto opened = openPaperIndex(options.index);
    if (!opened.ok()) return opened.status;
    index = opened.value;
    options.params = index->descriptorParams();
  }
  const auto description = describeFile(options);
  if (!description.ok()) return description.status;
  const bool matches = index && index->viewCount() > 0 && description.value.described.status == DescribeStatus::Ok;
  const NearestView match = matches ? nearestOf(index, description.value.described.bins) : NearestView{};
  print(options, description.value, matches ? &match : nullptr);
  const Status status = draw(options, description.value, matches ? &match : nullptr);
  return status.ok() ? statusOf(options, description.value) : status;
}

}  // namespace

Run addDescribe(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("file", options->file,
                 "A depth image whose set pixels are the object, points (.pcd, .xyz; metres), or a mesh: a whole model")
      ->type_name("FILE")
      ->required();
  options->camera.addTo(app);
  CLI::Option* const pairs = app.add_option("--pairs", options->params.pairs, "Lines drawn")
                                 ->capture_default_str()
                                 ->check(CLI::Range(1u, 1000000u));
  CLI::Option* const seed =
      app.add_option("--seed", options->params.seed, "Of the generator that draws them")->capture_default_str();
  app.add_option("--index", options->index, "Also find the nearest view of this index; --plot draws it too")
      ->type_name("FILE")
      ->excludes(pairs, seed);
  app.add_flag("--json", options->json, "One JSON object");
  app.add_option("--plot", options->plot, "Draw the six histograms")->type_name("PATH.png");
  app.add_option("--plot-lines", options->plot_lines, "Draw the voxel grid and the lines ON, OFF and MIXED")
      ->type_name("PATH.png");
  return [options] { return run(*options); };
}

}  // namespace voxid::cli
