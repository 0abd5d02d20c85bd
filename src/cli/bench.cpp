// SPDX-License-Identifier: BSD-3-Clause
// voxid bench: how fast descriptors are made and views are found, beside other libraries, in one run.
#include "bench.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "bench_scale.h"
#include "command.h"
#include "draw_curves.h"
#include "queries.h"
#include "recogniser.h"

namespace voxid::cli {
namespace {

struct Options {
  std::string index, queries, scenes, frames, plot;
  std::vector<std::string> only{"descriptor", "query"};
  int most = 400, seconds = 30;
  std::uint32_t scale = 0;
  std::string scale_out;
  ChainAlignment alignment;
  bool json = false, chain = false;
};

/// At most `most` queries, evenly chosen.
Result<std::vector<BenchView>> readViews(const Options& options) {
  const auto queries = readQueries(options.queries, 1);
  if (!queries.ok()) return queries.status;
  const CameraChoice camera = cameraOfFolder(options.queries);
  const std::size_t all = queries.value.size(), taken = std::min<std::size_t>(all, options.most);
  std::vector<BenchView> views;
  for (std::size_t i = 0; i < taken; ++i) {
    const Query& query = queries.value[i * all / taken];
    const auto file = readDepthFile(query.path, camera);
    if (!file.ok()) return file.status;
    BenchView view{file.value, setPixels(file.value.view()), query.category};
    if (!view.pixels.empty()) views.push_back(std::move(view));
  }
  if (views.empty()) return Status::nothingFound(options.queries + ": no query shows a pixel with depth");
  return views;
}

std::string textOf(const Json& row, const char* field, const char* format) {
  if (!row.contains(field) || row[field].is_null()) return "";
  char text[32];
  std::snprintf(text, sizeof text, format, row[field].get<double>());
  return text;
}

void printQueryRows(const Json& result) {
  std::printf("%s; CPU time of one thread\n", counted(result["queries"].get<std::size_t>(), "view").c_str());
  std::printf("%-24s %10s %10s %7s  %-20s %7s %9s %7s %7s %7s\n", "", "median us", "p99 us", "ratio", "of peer", "GB/s",
              "recall@1", "@10", "top-1", "B/view");
  for (const Json& row : result["rows"]) {
    if (row.contains("worst_us") || row.contains("p50_ms")) continue;
    std::printf("%-24s %10s %10s %7s  %-20s %7s %9s %7s %7s %7s\n", row["name"].get<std::string>().c_str(),
                textOf(row, "median_us", "%.1f").c_str(), textOf(row, "p99_us", "%.1f").c_str(),
                textOf(row, "ratio", "%.1f").c_str(),
                row["peer"].is_null() ? "" : row["peer"].get<std::string>().c_str(),
                textOf(row, "gb_per_s", "%.1f").c_str(), textOf(row, "recall1", "%.4f").c_str(),
                textOf(row, "recall10", "%.4f").c_str(), textOf(row, "top1", "%.2f").c_str(),
                textOf(row, "bytes_per_view", "%.0f").c_str());
  }
}

void printSceneRows(const Json& result) {
  std::printf("CPU time of one thread; PCL: SACSegmentation and EuclideanClusterExtraction\n");
  std::printf("%-24s %10s %10s %8s %8s %8s %6s %6s\n", "", "median us", "worst us", "x PCL", "5 mm", "right", "PCL",
              "5 mm");
  for (const Json& row : result["rows"]) {
    if (!row.contains("worst_us")) continue;
    std::printf("%-24s %10s %10s %8s %8s %4s/%-3s %6s %6s\n", row["name"].get<std::string>().c_str(),
                textOf(row, "median_us", "%.0f").c_str(), textOf(row, "worst_us", "%.0f").c_str(),
                textOf(row, "ratio", "%.0f").c_str(), textOf(row, "ratio_voxels", "%.1f").c_str(),
                textOf(row, "right", "%.0f").c_str(), textOf(row, "objects", "%.0f").c_str(),
                textOf(row, "peer_right", "%.0f").c_str(), textOf(row, "peer_right_voxels", "%.0f").c_str());
  }
}

void printChainRow(const Json& row) {
  std::printf("The chain on a replay at 30 frames a second; CPU time a frame by stage:");
  for (const auto& [stage, ms] : row["cpu_ms_per_frame"].items())
    std::printf(" %s %.2f", stage.c_str(), ms.get<double>());
  std::printf(" ms\n%-24s %8s %8s %8s %10s %8s %8s %14s\n", "", "p50 ms", "p99 ms", "worst", "core share", "frames",
              "lost", "objects/frame");
  std::printf("%-24s %8s %8s %8s %10s %8s %8s %14s\n", row["name"].get<std::string>().c_str(),
              textOf(row, "p50_ms", "%.2f").c_str(), textOf(row, "p99_ms", "%.2f").c_str(),
              textOf(row, "worst_latency_ms", "%.1f").c_str(), textOf(row, "core_share", "%.3f").c_str(),
              textOf(row, "frames", "%.0f").c_str(), textOf(row, "lost", "%.0f").c_str(),
              textOf(row, "objects_per_frame", "%.1f").c_str());
}

Status addQueryRows(const Options& options, Json& result) {
  const auto index = Index::open(options.index);
  if (!index.ok()) return index.status;
  const auto views = readViews(options);
  if (!views.ok()) return views.status;
  const auto wanted = [&](const char* group) {
    return std::find(options.only.begin(), options.only.end(), group) != options.only.end();
  };
  result["queries"] = views.value.size();
  result["views"] = index.value->viewCount();
  if (wanted("descriptor")) {
    for (Json& row : benchDescriptors(index.value->profile(), views.value)) result["rows"].push_back(std::move(row));
  }
  if (wanted("query")) {
    for (Json& row : benchQueries(index.value, views.value)) result["rows"].push_back(std::move(row));
  }
  if (!options.plot.empty()) return writeImage(options.plot, drawCurves(result["rows"]));
  return {};
}

Status addScale(const Options& options, Json& result) {
  const auto views = readViews(options);
  if (!views.ok()) return views.status;
  auto scale = benchScale({options.index, options.scale, options.scale_out}, views.value);
  if (scale.ok()) result["scale"] = std::move(scale.value);
  return scale.status;
}

Status addSceneRows(const Options& options, Json& result) {
  auto rows = benchSegmentation(options.scenes, options.most);
  if (!rows.ok()) return rows.status;
  for (Json& row : rows.value) result["rows"].push_back(std::move(row));
  return {};
}

Status addChainRow(const Options& options, Json& result) {
  const auto index = Index::open(options.index);  // what is wrong with it is better said here
  if (!index.ok()) return index.status;
  auto row = benchChain(options.frames.empty() ? options.scenes : options.frames, options.index, options.seconds,
                        options.alignment);
  if (row.ok()) result["rows"].push_back(std::move(row.value));
  return row.status;
}

Status checked(const Options& options) {
  if (options.chain && (options.index.empty() || (options.scenes.empty() && options.frames.empty())))
    return Status::badUse("--chain needs --index FILE, and the frames to show: --scenes DIR or --frames DIR");
  if ((options.alignment.mode != "off") != !options.alignment.models.empty())
    return Status::badUse("--align selected or all needs --models DIR, which is of no use without");
  if (!options.chain && !options.frames.empty()) return Status::badUse("--frames are what --chain shows: add --chain");
  if (options.scale > 0 && options.queries.empty())
    return Status::badUse("--scale needs --index FILE, whose views are copied, and --queries DIR");
  if (options.scale == 0 && !options.scale_out.empty())
    return Status::badUse("--scale-out is where --scale N writes: add --scale N");
  if (!options.plot.empty() && (options.queries.empty() || options.only == std::vector<std::string>{"descriptor"}))
    return Status::badUse("--plot draws searches: it needs --queries DIR");
  if (options.queries.empty() && options.scenes.empty() && !options.chain)
    return Status::badUse("bench needs something to measure on: --queries DIR with --index FILE, or --scenes DIR");
  if (!options.queries.empty() && options.index.empty())
    return Status::badUse("--queries needs --index FILE, whose searches are measured");
  return {};
}

Status run(const Options& options) {
  Status status = checked(options);
  if (!status.ok()) return status;
  Json result;
  result["rows"] = Json::array();
  if (options.scale > 0)
    status = addScale(options, result);
  else if (!options.queries.empty())
    status = addQueryRows(options, result);
  if (status.ok() && !options.scenes.empty()) status = addSceneRows(options, result);
  if (status.ok() && options.chain) status = addChainRow(options, result);
  if (!status.ok()) return status;
  if (options.json) {
    std::cout << lineOf(result);
    return {};
  }
  if (options.scale > 0)
    printScale(result["scale"]);
  else if (!options.queries.empty())
    printQueryRows(result);
  if (!options.scenes.empty()) printSceneRows(result);
  if (options.chain) printChainRow(result["rows"].back());
  return {};
}

}  // namespace

double rounded(double x, int decimals) {
  const double scale = std::pow(10, decimals);
  return std::round(x * scale) / scale;
}

double quantile(std::vector<double> samples, double share) {
  if (samples.empty()) return 0;
  std::sort(samples.begin(), samples.end());
  const auto at = static_cast<std::size_t>(share * static_cast<double>(samples.size()));
  return samples[std::min(at, samples.size() - 1)];
}

Json benchRow(const std::string& name, const std::vector<double>& us) {
  Json row;
  row["name"] = name;
  row["median_us"] = rounded(quantile(us, 0.5), 2);
  row["p99_us"] = rounded(quantile(us, 0.99), 2);
  row["peer"] = nullptr;
  row["peer_median_us"] = nullptr;
  row["ratio"] = nullptr;
  return row;
}

void comparePeer(Json& row, const std::string& peer, double peer_median_us) {
  row["peer"] = peer;
  row["peer_median_us"] = rounded(peer_median_us, 2);
  row["ratio"] = rounded(peer_median_us / row["median_us"].get<double>(), 2);
}

Run addBench(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("--index", options->index, "The index (.vxi) to search")->type_name("FILE");
  app.add_option("--queries", options->queries, "Depth images of one object each, with queries.csv")->type_name("DIR");
  app.add_option("--scenes", options->scenes, "Labelled frames (objects.json), for the segmentation")->type_name("DIR");
  app.add_option("--only", options->only, "Of the queries measure these only: descriptor, query")
      ->delimiter(',')
      ->check(CLI::IsMember({"descriptor", "query"}));
  app.add_option("--plot", options->plot, "Draw recall over time of the searches")->type_name("PATH.png");
  app.add_option("--most", options->most, "Take at most N of the queries or scenes, evenly")
      ->type_name("N")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  app.add_flag("--chain", options->chain, "The live chain: nodelets, ROS and LCM on the frames replayed at real rate");
  app.add_option("--align", options->alignment.mode, "Of the chain: poses of models, as ~align")
      ->check(CLI::IsMember({"off", "selected", "all"}))
      ->capture_default_str();
  app.add_option("--models", options->alignment.models, "With --align: the folder that the index was made from")
      ->type_name("DIR");
  app.add_option("--frames", options->frames, "Depth images for the chain instead of the scenes")->type_name("DIR");
  app.add_option("--seconds", options->seconds, "How long the chain is measured")
      ->type_name("S")
      ->capture_default_str()
      ->check(CLI::Range(3, 86400));
  app.add_option("--scale", options->scale, "Instead: an index of N views, copied with noise, on disk; warm and cold")
      ->type_name("N")
      ->check(CLI::Range(1, 2000000000));
  app.add_option("--scale-out", options->scale_out, "Where it stays (else in TMPDIR, and removed)")->type_name("FILE");
  app.add_flag("--json", options->json, "One JSON object");
  return [options] { return run(*options); };
}

}  // namespace voxid::cli
