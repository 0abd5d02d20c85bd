// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstring>
#include <random>

#include "bench.h"
#include "bench_search.h"
#include "compare_codes.h"
#include "evaluation.h"
#include "voxid/core/search.h"
#include "voxid/core/sketch.h"

namespace voxid::cli {
namespace {

constexpr double kSufficientRecall = 0.98;
constexpr std::size_t kWarmUp = 5;
constexpr char kScan[] = "query/paper", kExact[] = "query/exact";

struct BenchQuery {
  std::vector<std::uint8_t> code;  ///< as the index stores them
  Descriptor bins{};               ///< the paper's
  std::string category;
  std::vector<Neighbour> exact;  ///< the ten nearest of all views
};

/// Rows of 416 bytes that no search can shorten.
std::vector<std::uint8_t> randomRows(std::size_t rows) {
  std::vector<std::uint8_t> bytes(rows * kDescriptorBytes);
  std::mt19937_64 random(1);
  for (std::size_t i = 0; i + sizeof(std::uint64_t) <= bytes.size(); i += sizeof(std::uint64_t)) {
    const std::uint64_t number = random();
    std::memcpy(&bytes[i], &number, sizeof number);
  }
  return bytes;
}

/// The ten nearest rows; every row is compared in full.
void scan(const std::vector<std::uint8_t>& rows, const std::uint8_t* bins, std::vector<Neighbour>& ten) {
  ten.clear();
  const std::size_t count = rows.size() / kDescriptorBytes;
  for (std::size_t row = 0; row < count; ++row) {
    const Neighbour candidate{static_cast<std::uint32_t>(row), l1(bins, &rows[row * kDescriptorBytes])};
    if (ten.size() == kTen && !(candidate < ten.back())) continue;
    if (ten.size() == kTen) ten.pop_back();
    ten.insert(std::upper_bound(ten.begin(), ten.end(), candidate), candidate);
  }
}

/// Of a row that reads so many bytes a query.
void putSpeed(std::size_t bytes, Json& row) {
  row["gb_per_s"] = rounded(static_cast<double>(bytes) / row["median_us"].get<double>() * 1e-3, 2);
}

Json scanRow(std::size_t count, const std::vector<BenchQuery>& queries) {
  const std::vector<std::uint8_t> rows = randomRows(count);
  std::vector<Neighbour> ten;
  std::vector<double> us;
  scan(rows, queries[0].bins.data(), ten);
  for (const BenchQuery& query : queries) us.push_back(usOf([&] { scan(rows, query.bins.data(), ten); }));
  Json row = benchRow(kScan, us);
  putSpeed(rows.size(), row);
  row["recall1"] = 1.0;
  row["recall10"] = 1.0;
  row["bytes_per_view"] = kDescriptorBytes;
  return row;
}

std::vector<BenchQuery> queriesOf(const Index& index, const std::vector<BenchView>& views) {
  Describer describer(paperParamsOf(index));
  const auto encoder = makeEncoder(index.profile());
  std::vector<BenchQuery> queries;
  for (const BenchView& view : views) {
    const Described described = describer.describe(view.file.view(), {view.pixels.data(), view.pixels.size()});
    if (described.status != DescribeStatus::Ok) continue;
    BenchQuery query;
    query.code.resize(index.parameters().code_bytes);
    encoder->encode(view.file.view(), {view.pixels.data(), view.pixels.size()}, query.code.data());
    query.bins = described.bins;
    query.category = view.category;
    queries.push_back(std::move(query));
  }
  return queries;
}

/// A search that nothing can be set of.
Contender plainSearch(const char* name, double bytes_per_view, std::shared_ptr<Search> search) {
  Contender contender;
  contender.name = name;
  contender.settings = {0};
  contender.bytes_per_view = bytes_per_view;
  contender.prepare = [](int) {};
  contender.find = [search = std::move(search)](const std::uint8_t* code, std::vector<std::uint32_t>& ten) {
    ten.clear();
    const Nearest& nearest = search->find(code);
    for (std::size_t i = 0; i < std::min(kTen, nearest.views.size); ++i) ten.push_back(nearest.views[i].view);
  };
  return contender;
}

/// Every view is compared: the truth that recall is counted against.
Contender exactSearch(const std::shared_ptr<const Index>& index) {
  return plainSearch(kExact, index->parameters().code_bytes, makeExactSearch(index));
}

/// Exact, too.
Contender sketchSearch(const std::shared_ptr<const Index>& index) {
  return plainSearch("query/paper_sketch", static_cast<double>(kDescriptorBytes + kSketchBytes),
                     makeSketchSearch(index));
}

/// The index's hash: the paper's key, or lists.
Contender hashSearch(const std::shared_ptr<const Index>& index) {
  Contender contender;
  const bool lists = index->projection() != nullptr;
  contender.name = lists ? "query/default" : "query/paper_key";
  contender.knob = lists ? "lists" : "radius_bits";
  contender.settings = lists ? std::vector<int>{4, 8, 16, 24, 32, 48, 64, 128} : std::vector<int>{0, 2, 4, 6, 8};
  contender.main_setting = lists ? SearchParams().lists : kPaperRadiusBits;
  contender.bytes_per_view = bytesPerView(*index);
  const auto search = std::make_shared<std::unique_ptr<Search>>();
  contender.prepare = [search, index, lists](int setting) {
    *search = lists ? makeListSearch(index, setting) : makeLshSearch(index, setting);
  };
  contender.find = [search](const std::uint8_t* code, std::vector<std::uint32_t>& ten) {
    ten.clear();
    const Nearest& nearest = (*search)->find(code);
    for (std::size_t i = 0; i < std::min(kTen, nearest.views.size); ++i) ten.push_back(nearest.views[i].view);
  };
  return contender;
}

void findExact(const std::shared_ptr<const Index>& index, std::vector<BenchQuery>& queries) {
  const auto search = makeExactSearch(index);
  for (BenchQuery& query : queries) {
    const Span<const Neighbour> views = search->find(query.code.data()).views;
    query.exact.assign(views.begin(), views.begin() + std::min(kTen, views.size));
  }
}

CodeDistance distanceOf(const Index& index) {
  if (!index.projection()) return l1;
  if (index.parameters().code_bytes == kSmallCodeBytes)
    return [](const std::uint8_t* a, const std::uint8_t* b) { return squaredDistance(a, b, kSmallCodeBytes); };
  return [](const std::uint8_t* a, const std::uint8_t* b) { return squaredDistance(a, b, kCodeBytes); };
}

struct Measured {
  std::vector<double> us;
  double recall1 = 0, recall10 = 0, right = 0;  ///< sums over the queries
};

/// Counted by distance, so that another view as near as the right one is right too.
void judge(const Index& index, CodeDistance distance, const BenchQuery& query, const std::vector<std::uint32_t>& ten,
           Measured& measured) {
  if (ten.empty()) return;
  std::size_t near = 0;
  for (const std::uint32_t view : ten) {
    near += distance(query.code.data(), index.code(view)) <= query.exact.back().distance;
  }
  measured.recall10 += static_cast<double>(near) / static_cast<double>(query.exact.size());
  measured.recall1 += distance(query.code.data(), index.code(ten[0])) <= query.exact[0].distance;
  const std::uint32_t model = index.modelOf(ten[0]);
  measured.right += index.categoryName(index.models()[model].category) == query.category;
}

Measured measure(const Index& index, CodeDistance distance, const Contender& contender,
                 const std::vector<BenchQuery>& queries) {
  Measured measured;
  std::vector<std::uint32_t> ten;
  for (std::size_t i = 0; i < std::min(kWarmUp, queries.size()); ++i) contender.find(queries[i].code.data(), ten);
  for (const BenchQuery& query : queries) {
    measured.us.push_back(usOf([&] { contender.find(query.code.data(), ten); }));
    judge(index, distance, query, ten, measured);
  }
  return measured;
}

Json rowOf(const Contender& contender, const Measured& measured) {
  const auto queries = static_cast<double>(measured.us.size());
  Json row = benchRow(contender.name, measured.us);
  row["recall1"] = rounded(measured.recall1 / queries, 4);
  row["recall10"] = rounded(measured.recall10 / queries, 4);
  row["top1"] = rounded(100 * measured.right / queries, 2);
  row["bytes_per_view"] = rounded(contender.bytes_per_view, 1);
  return row;
}

/// The row of the main setting, and what all settings gave as its `curve`.
Json contenderRow(const Index& index, CodeDistance distance, const Contender& contender,
                  const std::vector<BenchQuery>& queries) {
  Json shown, curve = Json::array();
  bool settled = false;
  for (const int setting : contender.settings) {
    contender.prepare(setting);
    Json row = rowOf(contender, measure(index, distance, contender, queries));
    curve.push_back({{contender.knob, setting},
                     {"median_us", row["median_us"]},
                     {"recall1", row["recall1"]},
                     {"recall10", row["recall10"]},
                     {"top1", row["top1"]}});
    if (settled) continue;
    const bool sufficient = row["recall1"].get<double>() >= kSufficientRecall;
    settled = contender.main_setting < 0 ? sufficient : setting == contender.main_setting;
    shown = std::move(row);
    if (!contender.knob.empty()) shown[contender.knob] = setting;
  }
  if (contender.settings.size() > 1) shown["curve"] = std::move(curve);
  return shown;
}

}  // namespace

std::vector<Json> benchQueries(const std::shared_ptr<const Index>& index, const std::vector<BenchView>& views) {
  std::vector<BenchQuery> queries = queriesOf(*index, views);
  if (queries.empty()) return {};
  findExact(index, queries);
  const CodeDistance distance = distanceOf(*index);
  std::vector<Json> rows{scanRow(index->viewCount(), queries)};
  std::vector<Contender> contenders{exactSearch(index), hashSearch(index)};
  if (!sketchesOf(*index).empty()) contenders.push_back(sketchSearch(index));
  for (Contender& peer : peersOf(*index, distance)) contenders.push_back(std::move(peer));
  const double scan_us = rows[0]["median_us"].get<double>();
  for (const Contender& contender : contenders) {
    rows.push_back(contenderRow(*index, distance, contender, queries));
    comparePeer(rows.back(), kScan, scan_us);
    if (contender.name == kExact) putSpeed(index->viewCount() * index->parameters().code_bytes, rows.back());
  }
  return rows;
}

}  // namespace voxid::cli
