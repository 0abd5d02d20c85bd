// SPDX-License-Identifier: BSD-3-Clause
#include "split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <numeric>

#include "../core/vectorised.h"
#include "angle.h"
#include "box.h"
#include "flags.h"
#include "split_parts.h"

namespace voxid {
namespace {

constexpr int kArm = 3;     // cells to either side that a slope is taken over
constexpr int kAcross = 2;  // cells to either side of a crease at which normals are compared

/// What a row of pixels adds to whole cells of two by two pixels.
VOXID_VECTORISED void addPairs(const std::int32_t* values, int cells, std::int32_t* inverse, std::uint8_t* pixels) {
  for (int i = 0; i < cells; ++i) {
    inverse[i] += (values[2 * i] >> 2) + (values[2 * i + 1] >> 2);
    pixels[i] = static_cast<std::uint8_t>(pixels[i] + 2);
  }
}

/// Makes the sum of a cell's pixels as many times their mean as there are in a full cell. Sums are below 2^22: exact in
/// single precision.
VOXID_VECTORISED void fillCells(const std::uint8_t* pixels, std::ptrdiff_t count, int all, std::int32_t* inverse) {
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const bool full = (pixels[i] == 0) | (pixels[i] == all);
    const auto mean =
        static_cast<std::int32_t>(static_cast<float>(inverse[i]) / static_cast<float>(full ? all : pixels[i]));
    inverse[i] = full ? inverse[i] : mean * all;
  }
}

/// 1 where the depth does not step from the cell `back` cells before.
VOXID_VECTORISED void markLinks(const std::int32_t* inverse, std::ptrdiff_t back, std::ptrdiff_t count, DepthStep step,
                                std::uint8_t* linked) {
  const DepthStep limit = step;
  for (std::ptrdiff_t i = 0; i < count; ++i) linked[i] = limit.within(inverse[i - back], inverse[i]);
}

/// Normals and creases are sought in blocks of known length. The last of a row or part reaches beyond its end.
constexpr int kBlock = kFlagsAtOnce;

/// Links in a row that lead away from a cell, kArm at most in each direction.
struct Arms {
  int left, right, up, down;
};

static_assert(kArm == 3);  // two bits hold an arm

/// Arms of a block.
struct AnyArms {
  explicit AnyArms(const std::uint8_t* block) {
    for (int i = 0; i < kBlock; ++i) packed[i] = block[i];
  }
  Arms operator[](int i) const {
    const int arms = packed[i];
    return {arms & 3, (arms >> 2) & 3, (arms >> 4) & 3, arms >> 6};
  }
  std::int32_t packed[kBlock];
};

/// Of cells in the midst of a surface: as long as they are looked at.
template <int kLength>
struct FullArms {
  Arms operator[](int) const { return {kLength, kLength, kLength, kLength}; }
};

VOXID_VECTORISED void measureArms(const std::uint8_t* linked_left, const std::uint8_t* linked_up,
                                  std::ptrdiff_t columns, std::ptrdiff_t count, std::uint8_t* arms) {
#pragma GCC ivdep
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const auto lead = [](const std::uint8_t* linked, std::ptrdiff_t stride) {
      return linked[0] + (linked[0] & linked[stride]) + (linked[0] & linked[stride] & linked[2 * stride]);
    };
    const int across = lead(linked_left + i, -1) | lead(linked_left + i + 1, 1) << 2;
    const int along = lead(linked_up + i, -columns) | lead(linked_up + i + columns, columns) << 2;
    arms[i] = static_cast<std::uint8_t>(across | along << 4);
  }
}

/// Chooses by masks, as the compiler makes branches of anything else and does not vectorise those.
inline std::int32_t choose(bool first, std::int32_t a, std::int32_t b) {
  const std::int32_t mask = -static_cast<std::int32_t>(first);
  return (a & mask) | (b & ~mask);
}

inline float choose(bool first, float a, float b) {
  std::int32_t bits_a, bits_b;
  std::memcpy(&bits_a, &a, sizeof a);
  std::memcpy(&bits_b, &b, sizeof b);
  const std::int32_t bits = choose(first, bits_a, bits_b);
  float chosen;
  std::memcpy(&chosen, &bits, sizeof bits);
  return chosen;
}

/// The k-th value in direction of the stride, k from 0 to 3.
inline std::int32_t pick(const std::int32_t* at, int k, std::ptrdiff_t stride) {
  return choose(k < 2, choose(k == 0, at[0], at[stride]), choose(k == 2, at[2 * stride], at[3 * stride]));
}

/// The same up to the second; a larger k is taken for 2.
inline float pickNear(const float* at, int k, std::ptrdiff_t stride) {
  return choose(k == 0, at[0], choose(k == 1, at[stride], at[2 * stride]));
}

/// 0: no depth, or a crease; else 1, and kLinked if it hangs together with the cell to its left.
VOXID_VECTORISED void markOpen(const std::int32_t* inverse, const std::uint8_t* crease, const std::uint8_t* linked_left,
                               std::ptrdiff_t count, std::uint8_t* open) {
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const bool here = (inverse[i] != 0) & !crease[i], before = (inverse[i - 1] != 0) & !crease[i - 1];
    open[i] = static_cast<std::uint8_t>(here + (here & before & linked_left[i]));
  }
}

/// 1 for cells of a piece beside some of none.
VOXID_VECTORISED void markFronts(const std::int32_t* inverse, const std::uint8_t* piece, std::ptrdiff_t columns,
                                 std::ptrdiff_t count, std::uint8_t* front) {
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const bool left = (inverse[i - 1] != 0) & (piece[i - 1] == 0), right = (inverse[i + 1] != 0) & (piece[i + 1] == 0);
    const bool up = (inverse[i - columns] != 0) & (piece[i - columns] == 0),
               down = (inverse[i + columns] != 0) & (piece[i + columns] == 0);
    front[i] = static_cast<std::uint8_t>((piece[i] != 0) & (left | right | up | down));
  }
}

/// 1 for cells of a piece above or to the left of one of another piece.
VOXID_VECTORISED void markBorders(const std::uint8_t* piece, std::ptrdiff_t columns, std::ptrdiff_t count,
                                  std::uint8_t* border) {
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const bool right = (piece[i + 1] != 0) & (piece[i + 1] != piece[i]);
    const bool down = (piece[i + columns] != 0) & (piece[i + columns] != piece[i]);
    border[i] = static_cast<std::uint8_t>((piece[i] != 0) & (right | down));
  }
}

/// The piece of each cell that is beside no cell of another, else 0.
VOXID_VECTORISED void markInner(const std::uint8_t* piece, std::ptrdiff_t columns, std::ptrdiff_t count,
                                std::uint8_t* inner) {
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::uint8_t here = piece[i], left = piece[i - 1], right = piece[i + 1], up = piece[i - columns],
                       down = piece[i + columns];
    const bool alone = ((left == here) | (left == 0)) & ((right == here) | (right == 0)) & ((up == here) | (up == 0)) &
                       ((down == here) | (down == 0));
    inner[i] = static_cast<std::uint8_t>(here & -static_cast<int>(alone));
  }
}

/// Camera of the cells.
struct CellCamera {
  float fx, fy, cx, cy;
};

/// In inverse depth a plane is affine in the pixel, and its two slopes and its value give its normal. A block of a row.
template <typename ArmsOfCells>
inline __attribute__((always_inline)) void orientBlock(const std::int32_t* inverse, std::ptrdiff_t columns,
                                                       const CellCamera& camera, int first_u, int v,
                                                       const Splitter::Normals& normals, const ArmsOfCells& arms_of) {
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  const Splitter::Normals n = normals;
  const CellCamera c = camera;
  const float y = static_cast<float>(v) - c.cy;
#pragma GCC ivdep
  for (int i = 0; i < kBlock; ++i) {
    const std::int32_t* const cell = inverse + i;
    const Arms arms = arms_of[i];
    const int across = arms.left + arms.right, along = arms.up + arms.down;
    const float slope_u =
        static_cast<float>(pick(cell, arms.right, 1) - pick(cell, arms.left, -1)) / static_cast<float>(across);
    const float slope_v =
        static_cast<float>(pick(cell, arms.down, columns) - pick(cell, arms.up, -columns)) / static_cast<float>(along);
    const float normal_x = slope_u * c.fx, normal_y = slope_v * c.fy;
    const float normal_z = static_cast<float>(*cell) - slope_u * (static_cast<float>(first_u + i) - c.cx) - slope_v * y;
    const float square = normal_x * normal_x + normal_y * normal_y + normal_z * normal_z;
    n.x[i] = normal_x;
    n.y[i] = normal_y;
    n.z[i] = normal_z;
    n.square[i] = choose((across < 2) | (along < 2), kUnknown, square);
  }
}

VOXID_VECTORISED void orientRow(const std::int32_t* inverse, const std::uint8_t* arms, std::ptrdiff_t columns,
                                const CellCamera& camera, int first_u, int v, const Splitter::Normals& normals) {
  for (int first = 0; first < columns; first += kBlock) {
    const std::uint8_t* const block = arms + first;
    if (eightAt(block) == 0) continue;
    if (allHave(0xff, eightAt(block)))
      orientBlock(inverse + first, columns, camera, first_u + first, v, normals.from(first), FullArms<kArm>{});
    else
      orientBlock(inverse + first, columns, camera, first_u + first, v, normals.from(first), AnyArms{block});
  }
}

/// Whether the surface turns towards the viewer by more than the angle, from `back` cells before one to `on` cells
/// after it, at most kAcross. `slopes` ascend with those of the inverse depth in that direction.
inline __attribute__((always_inline)) bool turns(const Splitter::Normals& n, const float* slopes, int back, int on,
                                                 std::ptrdiff_t stride, float square_cosine) {
  const float square_p = pickNear(n.square, back, -stride), square_q = pickNear(n.square, on, stride);
  const float dot = pickNear(n.x, back, -stride) * pickNear(n.x, on, stride) +
                    pickNear(n.y, back, -stride) * pickNear(n.y, on, stride) +
                    pickNear(n.z, back, -stride) * pickNear(n.z, on, stride);
  const bool towards = pickNear(slopes, on, stride) > pickNear(slopes, back, -stride);
  const bool enough = std::min(back, kAcross) + std::min(on, kAcross) >= kAcross;
  return enough & towards & (dot * std::abs(dot) < square_cosine * square_p * square_q);  // false if one is unknown
}

template <typename ArmsOfCells>
inline __attribute__((always_inline)) void markBendsInBlock(const Splitter::Normals& normals, std::ptrdiff_t columns,
                                                            float square_cosine, const ArmsOfCells& arms_of,
                                                            std::uint8_t* crease) {
  static_assert(kAcross == 2);
  const Splitter::Normals n = normals;
  std::int32_t bends[kBlock];
  for (int i = 0; i < kBlock; ++i) {
    const Arms arms = arms_of[i];
    const Splitter::Normals here = n.from(i);
    bends[i] = turns(here, here.x, arms.left, arms.right, 1, square_cosine) |
               turns(here, here.y, arms.up, arms.down, columns, square_cosine);
  }
  for (int i = 0; i < kBlock; ++i) crease[i] = static_cast<std::uint8_t>(bends[i]);
}

/// 1 where the surface turns towards the viewer by more than the angle along the row or the column.
VOXID_VECTORISED void markBends(const Splitter::Normals& normals, const std::uint8_t* arms, std::ptrdiff_t columns,
                                std::ptrdiff_t count, float square_cosine, std::uint8_t* crease) {
  for (std::ptrdiff_t first = 0; first < count; first += kBlock) {
    const std::uint8_t* const block = arms + first;
    if (eightAt(block) == 0) continue;
    if (allHave(0xaa, eightAt(block)))  // kAcross or more in each direction
      markBendsInBlock(normals.from(first), columns, square_cosine, FullArms<kAcross>{}, crease + first);
    else
      markBendsInBlock(normals.from(first), columns, square_cosine, AnyArms{block}, crease + first);
  }
}

}  // namespace

Splitter::Splitter() : borders_((kMostPieces + 1) * (kMostPieces + 1)), joined_(kMostPieces + 1) {}

void Splitter::reserve(int width_px, int height_px) {
  for (shift_ = 0; width_px >> (shift_ + 1) >= 320; ++shift_) {
  }
  const auto most = static_cast<std::size_t>((width_px >> shift_) + 3) *
                    static_cast<std::size_t>((height_px >> shift_) + 2 + 2 * kMargin);
  inverse_.reserve(most + kBlock);
  for (auto* bytes : {&pixels_, &linked_left_, &linked_up_, &arms_, &crease_, &piece_, &flags_}) {
    bytes->reserve(most + kBlock);
  }
  for (auto* values : {&x_, &y_, &z_, &square_}) values->resize(most + kBlock);
  for (auto* list : {&queue_, &parents_, &pixels_of_run_}) list->reserve(most);
  runs_.reserve(most);
  cuts_.reserve(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
}

void Splitter::takeCells(const InverseDepth& inverse, Span<const Run> runs) {
  const PixelBox box = pixelBoxOf(runs, inverse.width_px);
  first_column_ = (box.x >> shift_) - 1;
  first_row_ = (box.y >> shift_) - kMargin;
  columns_ = static_cast<std::size_t>(((box.x + box.width - 1) >> shift_) - first_column_ + 2);
  const auto rows = static_cast<std::size_t>(((box.y + box.height - 1) >> shift_) - first_row_ + 1 + kMargin);
  first_ = kMargin * columns_;
  end_ = columns_ * (rows - kMargin);
  inverse_.assign(columns_ * rows + kBlock, 0);
  pixels_.assign(inverse_.size(), 0);
  for (const Run& run : runs) addRun(inverse, run);
  fillCells(pixels_.data() + first_, cells(), 1 << (2 * shift_), inverse_.data() + first_);
}

void Splitter::addRun(const InverseDepth& inverse, Run run) {
  const auto width = static_cast<std::uint32_t>(inverse.width_px);
  const std::size_t row = rowOf(run.begin / width);
  const int column = static_cast<int>(run.begin % width), length = static_cast<int>(run.end - run.begin);
  const std::int32_t* const values = inverse.values.data() + run.begin;
  const auto cellOf = [&](int i) { return row + static_cast<std::size_t>(((column + i) >> shift_) - first_column_); };
  const auto addPixel = [&](int i) {
    inverse_[cellOf(i)] += values[i] >> (2 * shift_);
    ++pixels_[cellOf(i)];
  };
  int i = 0;
  if (shift_ == 1) {
    if (column % 2 == 1) addPixel(i++);
    const int pairs = (length - i) / 2;
    addPairs(values + i, pairs, inverse_.data() + cellOf(i), pixels_.data() + cellOf(i));
    i += 2 * pairs;
  }
  for (; i < length; ++i) addPixel(i);
}

void Splitter::linkCells() {
  for (auto* links : {&linked_left_, &linked_up_, &arms_}) links->assign(inverse_.size(), 0);
  markLinks(inverse_.data() + first_, 1, cells(), step_, linked_left_.data() + first_);
  markLinks(inverse_.data() + first_, stride(), cells(), step_, linked_up_.data() + first_);
  measureArms(linked_left_.data() + first_, linked_up_.data() + first_, stride(), cells(), arms_.data() + first_);
}

void Splitter::orientCells(const Camera& camera) {
  const float pixel = 1.0f / static_cast<float>(65536 << shift_);
  const float half = 0.5f - 0.5f / static_cast<float>(1 << shift_);  // a cell's middle, in cells
  const CellCamera cell_camera{static_cast<float>(camera.fx_q16) * pixel, static_cast<float>(camera.fy_q16) * pixel,
                               static_cast<float>(camera.cx_q16) * pixel - half,
                               static_cast<float>(camera.cy_q16) * pixel - half};
  int v = first_row_ + kMargin;
  for (std::size_t row = first_; row < end_; row += columns_, ++v)
    orientRow(inverse_.data() + row, arms_.data() + row, stride(), cell_camera, first_column_, v, normalsFrom(row));
}

Splitter::Normals Splitter::normalsFrom(std::size_t cell) {
  return {x_.data() + cell, y_.data() + cell, z_.data() + cell, square_.data() + cell};
}

void Splitter::markCreases(int angle_deg) {
  const auto cosine = static_cast<float>(cosineOf(angle_deg));
  crease_.assign(inverse_.size(), 0);
  markBends(normalsFrom(first_), arms_.data() + first_, stride(), cells(), cosine * cosine, crease_.data() + first_);
}

std::uint32_t Splitter::rootOf(std::uint32_t run) {
  while (parents_[run] != run) run = parents_[run] = parents_[parents_[run]];
  return run;
}

/// The earlier root stays.
void Splitter::unite(std::uint32_t a, std::uint32_t b) {
  a = rootOf(a);
  b = rootOf(b);
  parents_[std::max(a, b)] = std::min(a, b);
}

/// Cells side by side without a step or a crease, each linked to those above it.
void Splitter::findRuns() {
  flags_.assign(inverse_.size(), 0);
  markOpen(inverse_.data() + first_, crease_.data() + first_, linked_left_.data() + first_, cells(),
           flags_.data() + first_);
  runs_.clear();
  parents_.clear();
  std::size_t above = 0;
  visitLinked(flags_.data(), first_, end_, [&](std::size_t begin, std::size_t end) {
    addRun({static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)}, above);
  });
}

/// `above`: the first run that may lie above this or a later one.
void Splitter::addRun(Run run, std::size_t& above) {
  const auto number = static_cast<std::uint32_t>(runs_.size()), columns = static_cast<std::uint32_t>(columns_);
  runs_.push_back(run);
  parents_.push_back(number);
  while (runs_[above].end + columns <= run.begin) ++above;
  for (std::size_t upper = above; runs_[upper].begin + columns < run.end; ++upper) {
    const auto first = linked_up_.begin() + std::max(run.begin, runs_[upper].begin + columns),
               last = linked_up_.begin() + std::min(run.end, runs_[upper].end + columns);
    if (std::find(first, last, 1) != last) unite(number, static_cast<std::uint32_t>(upper));
  }
}

/// What hangs together and is large enough is a piece. They are numbered by their first cells.
std::uint8_t Splitter::findPieces(std::size_t fewest) {
  findRuns();
  piece_.assign(inverse_.size(), 0);
  pixels_of_run_.assign(runs_.size(), 0);
  const auto plus = [](std::uint32_t sum, std::uint8_t pixels) {  // 0 stands for 256: a full cell from 5,120 columns on
    return sum + static_cast<std::uint8_t>(pixels - 1) + 1;
  };
  for (std::uint32_t i = 0; i < runs_.size(); ++i) {
    pixels_of_run_[rootOf(i)] +=
        std::accumulate(pixels_.begin() + runs_[i].begin, pixels_.begin() + runs_[i].end, std::uint32_t{0}, plus);
  }
  std::uint8_t count = 0;
  for (std::uint32_t i = 0; i < runs_.size(); ++i) {
    const std::uint32_t root = rootOf(i);
    if (root == i && pixels_of_run_[i] >= fewest && count < kMostPieces) {
      piece_[runs_[i].begin] = ++count;
    }
    std::memset(piece_.data() + runs_[i].begin, piece_[runs_[root].begin], runs_[i].end - runs_[i].begin);
  }
  return count;
}

/// Creases and small pieces go to the pieces around them, cell by cell from all of those at once.
void Splitter::growPieces() {
  markFronts(inverse_.data() + first_, piece_.data() + first_, stride(), cells(), flags_.data() + first_);
  queue_.clear();
  visitSet(flags_.data(), first_, end_, [&](std::size_t i) { queue_.push_back(static_cast<std::uint32_t>(i)); });
  for (std::size_t k = 0; k < queue_.size(); ++k) {
    const std::size_t i = queue_[k];
    for (const std::size_t next : {i - 1, i + 1, i - columns_, i + columns_}) {
      if (piece_[next] != 0 || inverse_[next] == 0) continue;
      piece_[next] = piece_[i];
      queue_.push_back(static_cast<std::uint32_t>(next));
    }
  }
}

void Splitter::measureBorders(std::uint8_t count) {
  std::fill(borders_.begin(), borders_.begin() + (count + 1) * (kMostPieces + 1), Border{});
  const auto compare = [&](std::size_t a, std::size_t b, bool linked) {
    if (piece_[a] == piece_[b] || piece_[b] == 0) return;
    Border& border = borders_[std::min(piece_[a], piece_[b]) * (kMostPieces + 1u) + std::max(piece_[a], piece_[b])];
    ++border.cells;
    border.creased += !linked || crease_[a] || crease_[b];
  };
  markBorders(piece_.data() + first_, stride(), cells(), flags_.data() + first_);
  visitSet(flags_.data(), first_, end_, [&](std::size_t i) {
    compare(i, i + 1, linked_left_[i + 1]);
    compare(i, i + columns_, linked_up_[i + columns_]);
  });
}

/// Pieces whose border is hardly a crease are one; how many there are then.
int Splitter::rejoin(std::uint8_t count, int share_percent) {
  measureBorders(count);
  for (int i = 0; i <= count; ++i) joined_[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(i);
  int left = count;
  for (std::size_t a = 1; a <= count; ++a) {
    for (std::size_t b = a + 1; b <= count; ++b) {
      const Border& border = borders_[a * (kMostPieces + 1) + b];
      const std::uint8_t low = std::min(joined_[a], joined_[b]), high = std::max(joined_[a], joined_[b]);
      if (low == high || border.creased * 100 >= border.cells * static_cast<std::uint32_t>(share_percent)) continue;
      std::replace(joined_.begin() + 1, joined_.begin() + count + 1, high, low);
      --left;
    }
  }
  return left;
}

/// Of a cell and its neighbours the one whose depth is next to the pixel's: a cell at a step holds pixels of both
/// sides.
std::size_t Splitter::nearestCell(std::size_t cell, std::int32_t inverse) const {
  std::size_t nearest = cell;
  for (const std::size_t next : {cell - 1, cell + 1, cell - columns_, cell + columns_}) {
    const bool nearer = std::abs(inverse_[next] - inverse) < std::abs(inverse_[nearest] - inverse);
    if (piece_[next] != 0 && nearer) nearest = next;
  }
  return nearest;
}

/// Cuts the runs where the piece changes; the number of pieces. What no piece has grown to goes with the pixel before.
std::size_t Splitter::cutRuns(const InverseDepth& inverse, Span<const Run> runs) {
  markInner(piece_.data() + first_, stride(), cells(), flags_.data() + first_);
  cuts_.clear();
  numbers_.fill(0);
  last_ = 1;
  pieces_cut_ = 0;
  for (const Run& run : runs) cutRun(inverse, run);
  return pieces_cut_;
}

void Splitter::cutRun(const InverseDepth& inverse, Run run) {
  const auto width = static_cast<std::uint32_t>(inverse.width_px);
  const std::uint32_t row_begin = run.begin - run.begin % width;
  const std::size_t row = rowOf(run.begin / width);
  for (std::uint32_t pixel = run.begin, end; pixel < run.end; pixel = end) {
    const std::uint32_t column = (pixel - row_begin) >> shift_;
    std::size_t cell = row + static_cast<std::size_t>(static_cast<int>(column) - first_column_);
    end = pixel + 1;
    if (flags_[cell]) {  // whichever of its neighbours is nearest, the piece is the same
      const auto columns = static_cast<std::uint32_t>(endOf(piece_[cell], flags_.data(), cell) - cell);
      end = std::min(run.end, row_begin + ((column + columns) << shift_));
    } else if (!step_.within(inverse.values[pixel], inverse_[cell])) {
      cell = nearestCell(cell, inverse.values[pixel]);
    }
    addCut({pixel, end}, piece_[cell], pixel == run.begin);
  }
}

/// Pieces are numbered anew, from 1, in the order of their first pixels.
void Splitter::addCut(Run run, std::uint8_t piece, bool begins) {
  if (piece != 0) last_ = joined_[piece];
  if (numbers_[last_] == 0) numbers_[last_] = ++pieces_cut_;
  const auto number = static_cast<std::uint8_t>(numbers_[last_] - 1);
  if (!begins && cuts_.back().piece == number)
    cuts_.back().run.end = run.end;
  else
    cuts_.push_back({run, number});
}

void Splitter::split(const Surface& surface, const Camera& camera, std::size_t fewest, const SegmentParams& params,
                     Components& components) {
  splitParts(*this, surface, camera, fewest, params, components);
}

}  // namespace voxid
