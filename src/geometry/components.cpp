// SPDX-License-Identifier: BSD-3-Clause
#include "components.h"

#include <algorithm>
#include <array>
#include <utility>

#include "flags.h"

namespace voxid {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;

}  // namespace

void Components::reserve(std::size_t pixels, int width_px) {
  const auto width = static_cast<std::size_t>(width_px);
  above_.reserve(width_px, static_cast<int>(pixels / width));
  states_.reserve(width + kFlagsAtOnce);
  last_in_column_.reserve(width);
  last_run_in_column_.reserve(width);
  runs_.reserve(pixels);
  parents_.reserve(pixels);
  part_of_run_.reserve(pixels);
  parts_.reserve(pixels);
  sorted_.reserve(3 * pixels);  // what is added to is written a second time, and what is cut once more
}

std::uint32_t Components::rootOf(std::uint32_t run) {
  while (parents_[run] != run) {
    parents_[run] = parents_[parents_[run]];
    run = parents_[run];
  }
  return run;
}

/// The earlier root stays: a part's root is its first run.
void Components::unite(std::uint32_t a, std::uint32_t b) {
  a = rootOf(a);
  b = rootOf(b);
  parents_[std::max(a, b)] = std::min(a, b);
}

bool Components::nearInSpace(const Surface& surface, std::uint32_t a, std::uint32_t b) const {
  const PointUm p = surface.point(a), q = surface.point(b);
  const std::int64_t dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z;
  return dx * dx + dy * dy + dz * dz < square_gap_um2_;
}

/// Whether a pixel of `lower` is one of the eight neighbours of a pixel of `upper`, in the row before, at its depth.
bool Components::touch(const Surface& surface, Run lower, Run upper) const {
  const auto width = static_cast<std::uint32_t>(surface.inverse.width_px);
  const std::int32_t* values = surface.inverse.values.data();
  const std::uint32_t begin = std::max(lower.begin, upper.begin + width - 1),
                      end = std::min(lower.end, upper.end + width + 1);
  for (std::uint32_t pixel = begin; pixel < end; ++pixel) {
    const std::uint32_t above = pixel - width;
    for (std::uint32_t other = std::max(above, upper.begin + 1) - 1; other < std::min(above + 2, upper.end); ++other) {
      if (gap_.within(values[pixel], values[other])) return true;
    }
  }
  return false;
}

/// Links a run to the one before it in its row, over a hole of at most bridge_px.
void Components::linkAlongRow(const Surface& surface, std::uint32_t run) {
  if (run == row_) return;
  const std::uint32_t here = runs_[run].begin, before = runs_[run - 1].end - 1;
  const std::uint32_t steps = here - before;
  if (steps > 1 && steps <= farthest_link_ && nearInSpace(surface, here, before)) unite(run, run - 1);
}

/// The same along those of its columns that had no run one row before.
void Components::linkAlongColumns(const Surface& surface, std::uint32_t run, int v, std::uint32_t above) {
  const auto width = static_cast<std::uint32_t>(surface.inverse.width_px), row = static_cast<std::uint32_t>(v);
  const Run* other = runs_.data() + above;
  visitUncovered(runs_[run], width, other, runs_.data() + row_, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t pixel = begin; pixel < end; ++pixel) {
      const std::uint32_t u = pixel - row * width, steps = row - last_in_column_[u];
      if (steps <= farthest_link_ && last_run_in_column_[u] != kNone &&
          nearInSpace(surface, pixel, pixel - steps * width)) {
        unite(run, last_run_in_column_[u]);
      }
    }
  });
}

/// Notes the columns in which runs of the row before v end.
void Components::endColumns(std::uint32_t width, int v) {
  const std::uint32_t row_above = static_cast<std::uint32_t>(v) - 1;
  const Run *other = runs_.data() + row_, *const others_end = runs_.data() + runs_.size();
  for (std::uint32_t run = row_above_; run < row_; ++run) {
    visitUncovered(runs_[run], -static_cast<std::int64_t>(width), other, others_end,
                   [&](std::uint32_t begin, std::uint32_t end) {
                     const std::uint32_t u = begin - row_above * width, count = end - begin;
                     std::fill_n(last_in_column_.begin() + u, count, row_above);
                     std::fill_n(last_run_in_column_.begin() + u, count, run);
                   });
  }
}

/// `above`: first run of the row before that may touch this run or a later one.
void Components::addRun(const Surface& surface, Run run, int v, std::uint32_t& above) {
  const auto width = static_cast<std::uint32_t>(surface.inverse.width_px);
  const auto number = static_cast<std::uint32_t>(runs_.size());
  runs_.push_back(run);
  parents_.push_back(number);
  while (above < row_ && runs_[above].end + width < run.begin) ++above;
  for (std::uint32_t upper = above; upper < row_ && runs_[upper].begin + width <= run.end; ++upper) {
    if (rootOf(upper) != rootOf(number) && touch(surface, run, runs_[upper])) unite(number, upper);
  }
  linkAlongRow(surface, number);
  linkAlongColumns(surface, number, v, above);
}

void Components::addRow(const Surface& surface, int v) {
  const int width = surface.inverse.width_px;
  above_.mark(surface.inverse.row(v), v, width, gap_, states_.data());
  const std::uint32_t row_begin = static_cast<std::uint32_t>(v) * static_cast<std::uint32_t>(width);
  std::uint32_t above = row_above_;
  visitLinked(states_.data(), 0, static_cast<std::size_t>(width), [&](std::size_t begin, std::size_t end) {
    addRun(surface, {row_begin + static_cast<std::uint32_t>(begin), row_begin + static_cast<std::uint32_t>(end)}, v,
           above);
  });
  endColumns(static_cast<std::uint32_t>(width), v);
}

void Components::find(const Surface& surface, const SegmentParams& params) {
  const InverseDepth& inverse = surface.inverse;
  const auto width = static_cast<std::size_t>(inverse.width_px);
  above_.set(surface.table, surface.distance_m, params.min_height_mm, params.max_height_mm, params.min_margin_per_km);
  gap_ = DepthStep(params.cluster_gap_mm);
  square_gap_um2_ = static_cast<std::int64_t>(params.cluster_gap_mm * 1000) * (params.cluster_gap_mm * 1000);
  farthest_link_ = static_cast<std::uint32_t>(params.bridge_px + 1);
  states_.assign(width + kFlagsAtOnce, 0);
  last_in_column_.assign(width, 0);
  last_run_in_column_.assign(width, kNone);
  runs_.clear();
  parents_.clear();
  row_above_ = row_ = 0;
  for (int v = 0; v < inverse.height_px; ++v) {
    addRow(surface, v);
    row_above_ = row_;
    row_ = static_cast<std::uint32_t>(runs_.size());
  }
  sortRuns();
}

void Components::addPart(std::uint32_t first, std::uint32_t runs, std::uint32_t pixels) {
  const auto number = static_cast<std::uint32_t>(parts_.size());
  parts_.push_back({first, runs, pixels, number, number, pixels});
}

/// Parts are numbered by their first pixels. Roots come before their runs, so one pass numbers and counts.
void Components::sortRuns() {
  const std::size_t runs = runs_.size();
  part_of_run_.resize(runs);
  parts_.clear();
  for (std::uint32_t i = 0; i < runs; ++i) {
    const std::uint32_t root = rootOf(i);
    part_of_run_[i] = root == i ? static_cast<std::uint32_t>(parts_.size()) : part_of_run_[root];
    if (root == i) addPart(0, 0, 0);
    Part& part = parts_[part_of_run_[i]];
    ++part.runs;
    part.pixels += runs_[i].end - runs_[i].begin;
    part.group_pixels = part.pixels;
  }
  std::uint32_t first = 0;
  for (Part& part : parts_) {
    part.first = first;
    first += part.runs;
    part.runs = 0;
  }
  sorted_.resize(runs);
  for (std::size_t i = 0; i < runs; ++i) {
    Part& part = parts_[part_of_run_[i]];
    sorted_[part.first + part.runs++] = runs_[i];
  }
}

/// Writes the part's runs once more, those that meet as one.
void Components::add(std::size_t part, Span<const Run> runs) {
  const Span<const Run> own = runsOf(part);
  const auto first = static_cast<std::uint32_t>(sorted_.size());
  const Run *mine = own.begin(), *more = runs.begin();
  bool last_is_mine = false;
  while (mine != own.end() || more != runs.end()) {
    const bool is_mine = more == runs.end() || (mine != own.end() && mine->begin < more->begin);
    const Run run = is_mine ? *mine++ : *more++;
    if (is_mine != last_is_mine && sorted_.size() > first && sorted_.back().end == run.begin)
      sorted_.back().end = run.end;
    else
      sorted_.push_back(run);
    if (!is_mine) parts_[part].pixels += run.size();
    last_is_mine = is_mine;
  }
  parts_[part].first = first;
  parts_[part].runs = static_cast<std::uint32_t>(sorted_.size()) - first;
  parts_[part].group_pixels = parts_[part].pixels;
}

void Components::cut(std::size_t part, Span<const Cut> cuts, std::size_t pieces) {
  std::array<Part, 256> made{};
  for (const Cut& cut : cuts) {
    ++made[cut.piece].runs;
    made[cut.piece].pixels += cut.run.end - cut.run.begin;
  }
  auto first = static_cast<std::uint32_t>(sorted_.size());
  sorted_.resize(sorted_.size() + cuts.size);
  for (std::size_t i = 0; i < pieces; ++i) {
    made[i].first = first;
    first += made[i].runs;
    if (i > 0) addPart(made[i].first, made[i].runs, made[i].pixels);
  }
  Part& changed = parts_[part];
  changed.first = made[0].first;
  changed.runs = made[0].runs;
  changed.pixels = changed.group_pixels = made[0].pixels;
  for (const Cut& cut : cuts) sorted_[made[cut.piece].first++] = cut.run;
}

/// Swapping the successors of two circles makes one.
void Components::join(std::size_t a, std::size_t b) {
  const std::uint32_t first = std::min(parts_[a].group, parts_[b].group),
                      other = std::max(parts_[a].group, parts_[b].group);
  if (first == other) return;
  parts_[first].group_pixels += parts_[other].group_pixels;
  std::uint32_t part = other;
  do {
    parts_[part].group = first;
    part = parts_[part].next;
  } while (part != other);
  std::swap(parts_[first].next, parts_[other].next);
}

void Components::collect(std::size_t first, std::vector<Run>& runs) const {
  const auto begin = static_cast<std::ptrdiff_t>(runs.size());
  auto part = static_cast<std::uint32_t>(first);
  do {
    const Span<const Run> more = runsOf(part);
    runs.insert(runs.end(), more.begin(), more.end());
    part = parts_[part].next;
  } while (part != first);
  if (parts_[first].next == first) return;
  std::sort(runs.begin() + begin, runs.end(), [](Run a, Run b) { return a.begin < b.begin; });
}

}  // namespace voxid
