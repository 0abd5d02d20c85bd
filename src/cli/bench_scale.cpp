// SPDX-License-Identifier: BSD-3-Clause
#include "bench_scale.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <tuple>

#include "bench_search.h"
#include "voxid/core/search.h"
#include "voxid/library/index_assembler.h"

namespace voxid::cli {
namespace {

using Codes = std::vector<std::vector<std::uint8_t>>;

constexpr int kListSettings[] = {4, 8, 16, 32, 64, 128, 256, 512};
constexpr std::size_t kExactQueries = 100, kColdQueries = 20;

/// As a clock on the wall has it: waiting for the disk counts.
template <typename Work>
double wall_ms(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Of this process, from /proc: RssAnon is its own, RssFile are pages of mapped files, which all processes share.
double resident_mb(const char* field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind(field, 0) == 0) return std::stod(line.substr(line.find(':') + 1)) / 1024;
  }
  return 0;
}

// ---- the large index ---------------------------------------------------------------------------------------------

/// One model of many.
struct Copy {
  std::string category, name;
  std::uint32_t model, number;
};

std::vector<Copy> copiesOf(const Index& index, std::uint32_t views) {
  const std::uint32_t times = (views + index.viewCount() - 1) / index.viewCount();
  std::vector<Copy> copies;
  for (std::uint32_t model = 0; model < index.models().size; ++model) {
    for (std::uint32_t i = 1; i <= times; ++i) {
      copies.push_back({std::string(index.categoryName(index.models()[model].category)),
                        std::string(index.modelName(model)) + "~" + std::to_string(i), model, i});
    }
  }
  std::sort(copies.begin(), copies.end(),
            [](const Copy& a, const Copy& b) { return std::tie(a.category, a.name) < std::tie(b.category, b.name); });
  return copies;
}

/// Noise of up to 16 a number, a twentieth of the code's length in all.
void jitter(std::vector<std::uint8_t>& code, std::mt19937_64& random) {
  constexpr std::int64_t kMost = 16;
  const CodeNumbers own = numbersOf(code.data(), code.size());
  std::array<std::int64_t, kCodeNumbers> numbers;
  for (std::size_t i = 0; i < kCodeNumbers; ++i) {
    const auto noise = static_cast<std::int64_t>(random() % (2 * kMost + 1)) - kMost;
    numbers[i] = own[i] + noise;
  }
  bringToLength(numbers.data(), code.size(), code.data());
}

Result<ModelRecord> recordOf(const Index& index, const Copy& copy) {
  Result<ModelRecord> model = readModel(index, copy.model);
  if (!model.ok()) return model;
  model.value.name = copy.name;
  std::mt19937_64 random(std::uint64_t{copy.model} << 32 | copy.number);
  for (ViewRecord& view : model.value.views) jitter(view.code, random);
  return model;
}

Status writeLarge(const Index& index, const ScaleOptions& options, const std::string& path, Json& result) {
  const double before_mb = resident_mb("RssAnon");
  double most_mb = before_mb;
  const std::vector<Copy> copies = copiesOf(index, options.views);
  IndexAssembler whole(index.profile(), {index.directions().begin(), index.directions().end()}, path);
  for (std::size_t i = 0; i < copies.size(); ++i) {
    const Result<ModelRecord> model = recordOf(index, copies[i]);
    const Status status = model.ok() ? whole.add(model.value) : model.status;
    if (!status.ok()) return status;
    if (i % 1000 == 0) most_mb = std::max(most_mb, resident_mb("RssAnon"));
  }
  const Status status = whole.write(path, index.calibration(), std::nullopt);
  result["write_mb"] = rounded(std::max(most_mb, resident_mb("RssAnon")) - before_mb, 1);
  return status;
}

// ---- its searches ------------------------------------------------------------------------------------------------

Codes codesOf(const Index& index, const std::vector<BenchView>& views) {
  const auto encoder = makeEncoder(index.profile());
  Codes codes;
  for (const BenchView& view : views) {
    std::vector<std::uint8_t> code(index.parameters().code_bytes);
    const DescribeStatus status =
        encoder->encode(view.file.view(), {view.pixels.data(), view.pixels.size()}, code.data());
    if (status == DescribeStatus::Ok) codes.push_back(std::move(code));
  }
  return codes;
}

/// Out of the page cache. The file must not be mapped.
void dropPages(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return;
  ::fsync(file);
  ::posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED);
  ::close(file);
}

Json timesOf(const std::vector<double>& ms) {
  return {{"median_ms", rounded(quantile(ms, 0.5), 3)}, {"p99_ms", rounded(quantile(ms, 0.99), 3)}};
}

Json openTimes(const std::string& path, bool cold) {
  constexpr int kTimes = 11;
  std::vector<double> ms;
  for (int i = 0; i < kTimes; ++i) {
    if (cold) dropPages(path);
    ms.push_back(wall_ms([&] { (void)Index::open(path); }));
  }
  return timesOf(ms);
}

std::vector<std::uint32_t> tenDistances(const Nearest& nearest) {
  std::vector<std::uint32_t> ten;
  for (std::size_t i = 0; i < std::min(kTen, nearest.views.size); ++i) ten.push_back(nearest.views[i].distance);
  return ten;
}

/// Each query alone: the index is opened, searched once and closed.
Json coldTimes(const std::string& path, const Codes& codes, int lists) {
  std::vector<double> ms, read_mb;
  for (std::size_t i = 0; i < std::min(kColdQueries, codes.size()); ++i) {
    dropPages(path);
    const auto index = Index::open(path);
    if (!index.ok()) break;
    const auto search = lists > 0 ? makeListSearch(index.value, lists) : makeExactSearch(index.value);
    const double before_mb = resident_mb("RssFile");
    ms.push_back(wall_ms([&] { search->find(codes[i].data()); }));
    read_mb.push_back(resident_mb("RssFile") - before_mb);
  }
  Json row = timesOf(ms);
  row["mapped_mb"] = rounded(quantile(read_mb, 0.5), 1);
  return row;
}

/// The ten nearest distances by comparing all, which recall is counted against.
std::vector<std::vector<std::uint32_t>> exactly(const std::shared_ptr<const Index>& index, const Codes& codes,
                                                Json& result) {
  const auto search = makeExactSearch(index);
  search->find(codes[0].data());
  std::vector<std::vector<std::uint32_t>> truth;
  std::vector<double> ms;
  for (const auto& code : codes) {
    ms.push_back(usOf([&] { truth.push_back(tenDistances(search->find(code.data()))); }) / 1000);
  }
  result["exact"] = timesOf(ms);
  return truth;
}

/// Warm: every query was asked once before.
Json listRow(const std::shared_ptr<const Index>& index, const Codes& codes,
             const std::vector<std::vector<std::uint32_t>>& truth, int lists) {
  const double before_mb = resident_mb("RssAnon");
  const auto search = makeListSearch(index, lists);
  std::vector<double> ms;
  double recall1 = 0, recall10 = 0, scanned = 0;
  for (const auto& code : codes) search->find(code.data());
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const Nearest* found = nullptr;
    ms.push_back(usOf([&] { found = &search->find(codes[i].data()); }) / 1000);
    const std::vector<std::uint32_t> ten = tenDistances(*found);
    const auto near = std::count_if(ten.begin(), ten.end(), [&](std::uint32_t d) { return d <= truth[i].back(); });
    recall1 += !ten.empty() && ten[0] <= truth[i][0];
    recall10 += static_cast<double>(near) / static_cast<double>(truth[i].size());
    scanned += found->scanned;
  }
  const auto count = static_cast<double>(codes.size());
  Json row{{"lists", lists}};
  row.update(timesOf(ms));
  row["recall1"] = rounded(recall1 / count, 4);
  row["recall10"] = rounded(recall10 / count, 4);
  row["compared"] = rounded(scanned / count, 0);
  row["own_mb"] = rounded(resident_mb("RssAnon") - before_mb, 1);
  return row;
}

Status measure(const std::string& path, const std::vector<BenchView>& views, Json& result) {
  result["open_cold"] = openTimes(path, true);
  result["open_warm"] = openTimes(path, false);
  auto index = Index::open(path);
  if (!index.ok()) return index.status;
  Codes codes = codesOf(*index.value, views);
  if (codes.empty()) return Status::nothingFound("no query can be described");
  codes.resize(std::min(codes.size(), kExactQueries));
  result["views"] = index.value->viewCount();
  result["models"] = index.value->models().size;
  result["bytes"] = index.value->bytes();
  result["index_lists"] = index.value->keys().size;
  result["queries"] = codes.size();
  const auto truth = exactly(index.value, codes, result);
  result["lists"] = Json::array();
  for (const int lists : kListSettings) result["lists"].push_back(listRow(index.value, codes, truth, lists));
  index.value.reset();  // what is mapped stays in the page cache
  result["lists_cold"] = coldTimes(path, codes, SearchParams().lists);
  result["exact_cold"] = coldTimes(path, codes, 0);
  return {};
}

}  // namespace

Result<Json> benchScale(const ScaleOptions& options, const std::vector<BenchView>& views) {
  const auto index = Index::open(options.index);
  if (!index.ok()) return index.status;
  if (!index.value->projection()) return Status::cannotDo("--scale is for an index of descriptor default");
  Json result;
  if (options.views <= index.value->viewCount()) {
    const Status status = measure(options.index, views, result);
    return status.ok() ? Result<Json>(result) : status;
  }
  std::error_code ignored;
  const auto temporary = std::filesystem::temp_directory_path(ignored) / ("voxid-scale-" + std::to_string(::getpid()));
  const std::string path = options.keep.empty() ? temporary.string() : options.keep;
  Status status;
  const double write_us = usOf([&] { status = writeLarge(*index.value, options, path, result); });
  result["write_s"] = rounded(write_us / 1e6, 1);
  if (status.ok()) status = measure(path, views, result);
  if (options.keep.empty()) std::remove(path.c_str());
  return status.ok() ? Result<Json>(result) : status;
}

void printScale(const Json& s) {
  const auto number = [&](const Json& row, const char* field) { return row[field].get<double>(); };
  std::printf("%.0f views of %.0f models, %.0f bytes, %.2f a view\n", number(s, "views"), number(s, "models"),
              number(s, "bytes"), number(s, "bytes") / number(s, "views"));
  if (s.contains("write_s"))
    std::printf("written in %.1f s of CPU time, in %.1f MB of memory\n", number(s, "write_s"), number(s, "write_mb"));
  std::printf(
      "%.0f queries; median and p99 in ms, warm: of CPU time, opening and with the page cache dropped: of the wall "
      "clock\n",
      number(s, "queries"));
  const auto times = [&](const char* what, const Json& row) {
    std::printf("%-34s %9.3f %9.3f", what, number(row, "median_ms"), number(row, "p99_ms"));
  };
  for (const auto& [what, field] :
       {std::pair("open, page cache dropped", "open_cold"), {"open, warm", "open_warm"}, {"exact, warm", "exact"}}) {
    times(what, s[field]);
    std::printf("\n");
  }
  for (const auto& [what, field] :
       {std::pair("exact, page cache dropped", "exact_cold"), {"32 lists, page cache dropped", "lists_cold"}}) {
    times(what, s[field]);
    std::printf("  %.1f MB mapped\n", number(s[field], "mapped_mb"));
  }
  for (const Json& row : s["lists"]) {
    times((std::to_string(row["lists"].get<int>()) + " of " + std::to_string(s["index_lists"].get<int>()) +
           " lists, warm")
              .c_str(),
          row);
    std::printf("  recall@1 %.4f  @10 %.4f  %8.0f compared  %.1f MB own\n", number(row, "recall1"),
                number(row, "recall10"), number(row, "compared"), number(row, "own_mb"));
  }
}

}  // namespace voxid::cli
