// SPDX-License-Identifier: BSD-3-Clause
#include "depth_patch.h"

#include <algorithm>

#include "vectorised.h"

namespace voxid {
namespace {

constexpr std::int64_t kMaxDepthUnits = 8191;                        // 2 D before or behind the centroid
constexpr std::int64_t kMaxFootprint = 16 * DepthPatch::kCellUnits;  // an object less than four pixels wide

std::int64_t clamped(std::int64_t value, std::int64_t most) { return std::min(std::max(value, -most), most); }

// Along one axis of the image: from pixels to units on the plane through the centroid.
class Axis {
 public:
  Axis(std::int32_t f_q16, std::int32_t c_q16, std::int64_t centroid_um, std::int64_t z0_um, std::int64_t d_um) {
    const std::int64_t pitch_um_q16 = std::min((z0_um << 32) / f_q16, std::int64_t{1} << 50);
    step_q16_ = std::min(pitch_um_q16 * DepthPatch::kUnits / d_um, std::int64_t{1} << 30);
    centre_q16_ = c_q16 + clamped(centroid_um * f_q16 / z0_um, std::int64_t{1} << 40);
    footprint_ = std::min(step_q16_ >> 16, kMaxFootprint);
  }

  // First and last cell whose middle lies under the pixel, or the cell under the pixel's middle.
  struct Range {
    int first, last;
  };
  Range cellsUnder(std::int32_t pixel) const {
    constexpr int kHalf = DepthPatch::kSide * DepthPatch::kCellUnits / 2;
    const std::int64_t middle =
        (clamped((std::int64_t{pixel} << 16) - centre_q16_, std::int64_t{1} << 31) * step_q16_ >> 32) + kHalf;
    const std::int64_t low = middle - footprint_ / 2;
    const std::int64_t first = cellOf(low + DepthPatch::kCellUnits / 2 - 1),
                       last = cellOf(low + footprint_ - DepthPatch::kCellUnits / 2 - 1);
    if (first <= last) return {atLeastZero(first), belowSide(last)};
    const std::int64_t cell = cellOf(middle);
    return {atLeastZero(cell), belowSide(cell)};
  }

 private:
  static std::int64_t cellOf(std::int64_t units) { return units >> 6; }
  static_assert(DepthPatch::kCellUnits == 1 << 6, "cellOf shifts");
  static int atLeastZero(std::int64_t cell) {
    return static_cast<int>(clamped(std::max<std::int64_t>(cell, 0), DepthPatch::kSide));
  }
  static int belowSide(std::int64_t cell) {
    return static_cast<int>(clamped(std::min<std::int64_t>(cell, DepthPatch::kSide - 1), DepthPatch::kSide));
  }

  std::int64_t step_q16_, centre_q16_, footprint_;
};

// w = z0 (1 - z0 / z), in units.
class ProjectiveDepth {
 public:
  ProjectiveDepth(std::int64_t z0_um, std::int32_t scale) : z0_um_(z0_um), scale_(scale) {}
  std::int32_t of(std::int64_t z_um) const {
    constexpr std::int64_t kOne = std::int64_t{1} << 30;
    const std::int64_t ratio_q30 = clamped((z_um - z0_um_) * kOne / z_um, kOne);
    return static_cast<std::int32_t>(clamped((ratio_q30 * scale_ + kOne / 2) >> 30, kMaxDepthUnits));
  }

 private:
  std::int64_t z0_um_, scale_;
};

// 3 % of D, or what the sensor cannot tell apart: 1.2 disparity steps of 1/8 pixel, 0.00345 / m in 1 / z.
std::int16_t toleranceOf(std::int64_t z0_um, std::int64_t d_um) {
  constexpr std::int64_t kLeast = DepthPatch::kUnits * 3 / 100;
  const std::int64_t step_um = z0_um * z0_um * 345 / 100000000000;
  return static_cast<std::int16_t>(std::min(std::max(step_um * DepthPatch::kUnits / d_um, kLeast), kMaxDepthUnits));
}

}  // namespace

void DepthPatch::draw(const Camera& camera, Span<const Pixel> pixels, Vector centroid_um, std::int64_t d_um) {
  const std::int64_t z0_um = std::max<std::int64_t>(centroid_um.z, 1);
  scale_ = static_cast<std::int32_t>(std::min(std::max<std::int64_t>(z0_um * kUnits / d_um, 1), std::int64_t{1} << 24));
  tolerance_ = toleranceOf(z0_um, d_um);
  splat(camera, pixels, centroid_um, d_um);
  for (int i = 0; i < kCells; ++i) w_[i] = hits_[i] == 0 ? kHole : sum_[i] / hits_[i];
  sumRows();
  collect();
}

// 65,536 pixels of |w| < 2^13 sum to less than 2^30.
void DepthPatch::splat(const Camera& camera, Span<const Pixel> pixels, Vector centroid_um, std::int64_t d_um) {
  sum_.fill(0);
  hits_.fill(0);
  const std::int64_t z0_um = std::max<std::int64_t>(centroid_um.z, 1);
  const Axis columns(camera.fx_q16, camera.cx_q16, centroid_um.x, z0_um, d_um);
  const Axis rows(camera.fy_q16, camera.cy_q16, centroid_um.y, z0_um, d_um);
  const ProjectiveDepth depth(z0_um, scale_);
  const Pixel* before = nullptr;
  Axis::Range down{};
  for (const Pixel& pixel : pixels) {
    const std::int32_t w = depth.of(pixel.z_um);
    const Axis::Range across = columns.cellsUnder(pixel.u);
    if (before == nullptr || pixel.v != before->v) down = rows.cellsUnder(pixel.v);  // neighbours mostly share a row
    before = &pixel;
    for (int row = down.first; row <= down.last; ++row) {
      for (int column = across.first; column <= across.last; ++column) {
        sum_[row * kSide + column] += w;
        ++hits_[row * kSide + column];
      }
    }
  }
}

// One row's sums over windows of 2 kReach + 1 columns; `seen` (0 or 1) and `depth` (0 where not seen) have kReach empty
// columns at both ends.
template <int kReach>
VOXID_VECTORISED void sumRow(const std::int32_t* seen, const std::int32_t* depth, std::int32_t* __restrict m,
                             std::int32_t* __restrict jm, std::int32_t* __restrict jjm, std::int32_t* __restrict w,
                             std::int32_t* __restrict jw) {
  for (int column = 0; column < DepthPatch::kSide; ++column) {
    std::int32_t sums[5] = {};
    for (int j = -kReach; j <= kReach; ++j) {
      const std::int32_t s = seen[column + kReach + j], d = depth[column + kReach + j];
      sums[0] += s;
      sums[1] += j * s;
      sums[2] += j * j * s;
      sums[3] += d;
      sums[4] += j * d;
    }
    m[column] = sums[0];
    jm[column] = sums[1];
    jjm[column] = sums[2];
    w[column] = sums[3];
    jw[column] = sums[4];
  }
}

// Along each row; sumDown sums these down the columns. Rows kReach above and below the patch stay empty.
void DepthPatch::sumRows() {
  for (int row = 0; row < kSide; ++row) {
    std::array<std::int32_t, kPaddedSide> seen{}, depth{};
    for (int column = 0; column < kSide; ++column) {
      const std::int32_t w = w_[row * kSide + column];
      seen[column + kReach] = w != kHole;
      depth[column + kReach] = w != kHole ? w : 0;
    }
    const int at = (row + kReach) * kSide;
    sumRow<kReach>(seen.data(), depth.data(), &rows_.m[at], &rows_.jm[at], &rows_.jjm[at], &rows_.w[at], &rows_.jw[at]);
  }
}

VOXID_VECTORISED void DepthPatch::sumDown(int row) {
  for (int column = 0; column < kSide; ++column) {
    std::int32_t n = 0, j = 0, i = 0, jj = 0, ij = 0, ii = 0, w = 0, jw = 0, iw = 0;
    for (int d = -kReach; d <= kReach; ++d) {
      const int at = (row + kReach + d) * kSide + column;
      n += rows_.m[at];
      j += rows_.jm[at];
      i += d * rows_.m[at];
      jj += rows_.jjm[at];
      ij += d * rows_.jm[at];
      ii += d * d * rows_.m[at];
      w += rows_.w[at];
      jw += rows_.jw[at];
      iw += d * rows_.w[at];
    }
    windows_.n[column] = n;
    windows_.j[column] = j;
    windows_.i[column] = i;
    windows_.jj[column] = jj;
    windows_.ij[column] = ij;
    windows_.ii[column] = ii;
    windows_.w[column] = w;
    windows_.jw[column] = jw;
    windows_.iw[column] = iw;
  }
}

// Least squares over the window: normal equations about its mean, solved by Cramer's rule. At most 49 cells of
// |w| < 2^13 and |i|, |j| <= 3: every sum times 49 stays below 2^27, the determinant below 2^27.
DepthPatch::Slope DepthPatch::slopeAt(int column) const {
  const std::int32_t n = windows_.n[column], j = windows_.j[column], i = windows_.i[column], w = windows_.w[column];
  const std::int64_t a = n * windows_.jj[column] - j * j, b = n * windows_.ij[column] - i * j,
                     c = n * windows_.ii[column] - i * i;
  const std::int64_t right_j = n * windows_.jw[column] - j * w, right_i = n * windows_.iw[column] - i * w;
  const std::int64_t determinant = a * c - b * b;
  if (determinant == 0) return {};
  constexpr std::int64_t kQ10 = 1024 / kCellUnits;
  const auto slope = [&](std::int64_t numerator) {
    return static_cast<std::int32_t>(clamped(numerator * kQ10 / determinant, 32767));
  };
  return {slope(right_j * c - right_i * b), slope(right_i * a - right_j * b)};
}

void DepthPatch::collect() {
  count_ = 0;
  for (int row = 0; row < kSide; ++row) {
    sumDown(row);
    for (int column = 0; column < kSide; ++column) {
      if (w(column, row) != kHole) cells_[count_++] = cellAt(column, row);
    }
  }
}

// After sumDown of the row. A point (x, y, w) lies at k (x, y, w), k = z0 / (z0 - w), from the centroid. The plane w =
// a + p x + q y has the normal (p, q, -(1 - a / z0)).
SurfaceCell DepthPatch::cellAt(int column, int row) const {
  const Slope slope = slopeAt(column);
  const std::int32_t x = (2 * column + 1 - kSide) * kCellUnits / 2, y = (2 * row + 1 - kSide) * kCellUnits / 2;
  const std::int32_t depth = w(column, row);
  const std::int64_t a = depth - ((std::int64_t{slope.column_q10} * x + std::int64_t{slope.row_q10} * y) >> 10);
  const std::int32_t m_q10 = static_cast<std::int32_t>(clamped(1024 - a * 1024 / scale_, 32767));
  Direction1024 normal = normalised(slope.column_q10, slope.row_q10, -m_q10);
  if (normal.z > 0) normal = {-normal.x, -normal.y, -normal.z};
  const std::int64_t k_q12 =
      std::min<std::int64_t>((std::int64_t{scale_} << 12) / std::max(scale_ - depth, 1), 1 << 14);
  const auto metric = [&](std::int32_t units) {
    return static_cast<std::int16_t>(clamped(units * k_q12 >> 12, kMaxDepthUnits));
  };
  const auto narrow = [](std::int32_t value) { return static_cast<std::int16_t>(value); };
  return {narrow(column), narrow(row),      narrow(depth),    metric(x),       metric(y),
          metric(depth),  narrow(normal.x), narrow(normal.y), narrow(normal.z)};
}

}  // namespace voxid
