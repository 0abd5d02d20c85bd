// SPDX-License-Identifier: BSD-3-Clause
// The layout's numbers beside their definition in floating point, and what must not change them.
#include "../../src/core/polar_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <random>
#include <vector>

namespace voxid {
namespace {

constexpr int kSide = DepthPatch::kSide, kRings = PolarLayout::kRings, kSeries = PolarLayout::kSeries;
using Numbers = std::array<std::uint8_t, PolarLayout::kNumbers>;
using Cells = std::vector<SurfaceCell>;

SurfaceCell cellAt(int column, int row, int nx = 0, int ny = 0) {
  SurfaceCell cell{};
  cell.column = static_cast<std::int16_t>(column);
  cell.row = static_cast<std::int16_t>(row);
  cell.nx = static_cast<std::int16_t>(nx);
  cell.ny = static_cast<std::int16_t>(ny);
  return cell;
}

/// Cells of the patch whose middles, in cells from its own, `inside` takes.
Cells cellsWhere(const std::function<bool(double, double)>& inside) {
  Cells cells;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      if (inside(column + 0.5 - kSide / 2, row + 0.5 - kSide / 2)) cells.push_back(cellAt(column, row));
    }
  }
  return cells;
}

Cells randomCells(unsigned seed) {
  std::mt19937 random(seed);
  Cells cells = cellsWhere([](double x, double y) { return std::abs(x + 4) < 25 && std::abs(y - x / 2) < 12; });
  for (SurfaceCell& cell : cells) {
    cell.nx = static_cast<std::int16_t>(static_cast<int>(random() % 1401) - 700);
    cell.ny = static_cast<std::int16_t>(static_cast<int>(random() % 1401) - 700);
  }
  return cells;
}

Numbers measured(const Cells& cells) {
  Numbers numbers;
  PolarLayout layout;
  layout.measure({cells.data(), cells.size()}, numbers.data());
  return numbers;
}

std::size_t numberOf(int order, int a, int b) {
  std::size_t at = static_cast<std::size_t>(order * kSeries * (kSeries + 1) / 2);
  for (int row = 0; row < a; ++row) at += static_cast<std::size_t>(kSeries - row);
  return at + static_cast<std::size_t>(b - a);
}

double defined(const Cells& cells, int order, int a, int b) {
  const auto coefficient = [&](int series) {
    std::complex<double> sum;
    for (const SurfaceCell& cell : cells) {
      const double x = cell.column + 0.5 - kSide / 2, y = cell.row + 0.5 - kSide / 2, radius = std::hypot(x, y);
      const double at = std::min(std::max((radius - 4) / 8, 0.0), kRings - 1.0);
      const double share = std::max(1 - std::abs(at - series % kRings), 0.0);
      const double lean = (cell.nx * x + cell.ny * y) / radius / 1024;
      sum += share * (series < kRings ? 1 : lean) * std::polar(1.0, order * std::atan2(y, x));
    }
    return sum * (order == 0 ? 1.0 : 2.0) / static_cast<double>(cells.size());
  };
  const double product = std::real(coefficient(a) * std::conj(coefficient(b)));
  const double number = 254 * std::sqrt(std::abs(product));
  return 128 + (product < 0 ? -1 : 1) * std::min(number, 127.0);
}

TEST(PolarLayout, IsAsDefined) {
  const Cells cells = randomCells(3);
  const Numbers numbers = measured(cells);
  int apart = 0;
  for (int order = 0; order < PolarLayout::kOrders; ++order) {
    for (int a = 0; a < kSeries; ++a) {
      for (int b = a; b < kSeries; ++b) {
        const double number = numbers[numberOf(order, a, b)], exact = defined(cells, order, a, b);
        // Directions are in steps of 3 degrees and leans in sixteenths; a root near zero is steep.
        ASSERT_NEAR(number, exact, 6) << order << ' ' << a << ' ' << b;
        apart += std::abs(number - exact) > 2;
      }
    }
  }
  EXPECT_LT(apart, PolarLayout::kNumbers / 20);
}

TEST(PolarLayout, ADiscHasNoPeriodsABarHasTwo) {
  const Numbers disc = measured(cellsWhere([](double x, double y) { return std::hypot(x, y) < 30; }));
  const Numbers bar = measured(cellsWhere([](double x, double y) { return std::abs(x) < 30 && std::abs(y) < 4; }));
  const std::size_t ring = 2;
  EXPECT_NEAR(disc[numberOf(0, ring, ring)], 128 + 254 * 2 * 20 * 8 / (30.0 * 30.0), 4)
      << "share of the ring at 20 cells";
  EXPECT_NEAR(disc[numberOf(2, ring, ring)], 128, 3);
  EXPECT_NEAR(bar[numberOf(1, ring, ring)], 128, 2);
  EXPECT_GT(bar[numberOf(2, ring, ring)], 150);
  EXPECT_GT(bar[numberOf(2, ring, ring + 1)], 150) << "along the same axis";
}

TEST(PolarLayout, ACrossingIsNegative) {
  const Numbers numbers = measured(cellsWhere([](double x, double y) {
    const double radius = std::hypot(x, y);
    return radius < 16 ? std::abs(y) < 3 : radius < 40 && std::abs(x) < 3;
  }));
  EXPECT_LT(numbers[numberOf(2, 1, 3)], 110) << "the inner bar lies across the outer one";
}

TEST(PolarLayout, AHillLeansOutwardAHollowInward) {
  Cells hill = cellsWhere([](double x, double y) { return std::hypot(x, y) < 30; }), hollow = hill;
  for (std::size_t i = 0; i < hill.size(); ++i) {
    const double x = hill[i].column + 0.5 - kSide / 2, y = hill[i].row + 0.5 - kSide / 2, radius = std::hypot(x, y);
    hill[i].nx = static_cast<std::int16_t>(700 * x / radius);
    hill[i].ny = static_cast<std::int16_t>(700 * y / radius);
    hollow[i].nx = static_cast<std::int16_t>(-hill[i].nx);
    hollow[i].ny = static_cast<std::int16_t>(-hill[i].ny);
  }
  const std::size_t surface_and_lean = numberOf(0, 2, kRings + 2);
  EXPECT_GT(measured(hill)[surface_and_lean], 180);
  EXPECT_LT(measured(hollow)[surface_and_lean], 76);
}

TEST(PolarLayout, TurnsAndMirrorsDoNotChangeIt) {
  const Cells cells = randomCells(4);
  Cells turned = cells, mirrored = cells;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const SurfaceCell& cell = cells[i];
    turned[i] = cellAt(kSide - 1 - cell.row, cell.column, -cell.ny, cell.nx);
    mirrored[i] = cellAt(kSide - 1 - cell.column, cell.row, -cell.nx, cell.ny);
  }
  const Numbers numbers = measured(cells), of_turned = measured(turned), of_mirrored = measured(mirrored);
  int apart = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    EXPECT_NEAR(numbers[i], of_turned[i], 10) << i << ": a root near zero is steep";
    EXPECT_NEAR(numbers[i], of_mirrored[i], 10) << i;
    apart += std::abs(numbers[i] - of_turned[i]) > 3 || std::abs(numbers[i] - of_mirrored[i]) > 3;
  }
  EXPECT_LT(apart, PolarLayout::kNumbers / 20);
}

TEST(PolarLayout, ExtremesStayInRange) {
  Cells full = cellsWhere([](double, double) { return true; });
  for (SurfaceCell& cell : full) cell.nx = cell.ny = 1024;
  const Cells one_direction = {cellAt(79, 79, 724, 724), cellAt(79, 79, 724, 724)};
  const Numbers of_one = measured(one_direction);
  EXPECT_EQ(of_one[numberOf(0, 5, 5)], 255);
  EXPECT_EQ(of_one[numberOf(3, 5, kRings + 5)], 255);
  for (const std::uint8_t number : measured(full)) EXPECT_GE(number, 1);
  const Numbers none = measured({});
  EXPECT_EQ(std::count(none.begin(), none.end(), 128), PolarLayout::kNumbers);
}

}  // namespace
}  // namespace voxid
