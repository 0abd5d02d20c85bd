// SPDX-License-Identifier: BSD-3-Clause
#include "polar_layout.h"

#include <algorithm>

#include "normaliser.h"
#include "scales.h"
#include "vectorised.h"

namespace voxid {
namespace {

constexpr int kSide = DepthPatch::kSide;
constexpr int kParts = 16;  // a cell between two rings counts in both, in sixteenths

struct Place {
  std::int16_t x_q10, y_q10;  // unit vector from the patch's middle
  std::uint8_t direction;
  std::uint8_t ring, outward;  // a cell counts kParts - outward in `ring`, outward in the next one
};

// In half cells the coordinates are odd: no cell's middle is the patch's.
constexpr Place placeOf(int column, int row) {
  constexpr int kFirstRing = 64, kBetweenRings = 128;  // in sixteenths of a cell
  const std::int64_t x = 2 * column + 1 - kSide, y = 2 * row + 1 - kSide;
  const auto square = static_cast<std::uint64_t>(x * x + y * y);
  const auto radius = static_cast<int>(squareRoot(square * 64)), beyond = std::max(radius - kFirstRing, 0);
  const int at = std::min(beyond * kParts / kBetweenRings, (PolarLayout::kRings - 1) * kParts);
  const int ring = std::min(at / kParts, PolarLayout::kRings - 2);
  const auto length_q10 = static_cast<std::int64_t>(squareRoot(square << 20));
  const auto x_q10 = static_cast<std::int16_t>(x * (1 << 20) / length_q10);
  const auto y_q10 = static_cast<std::int16_t>(y * (1 << 20) / length_q10);
  const int part = angleOf(x_q10);
  const int direction = y > 0 ? part : PolarLayout::kDirections - 1 - part;
  return {x_q10, y_q10, static_cast<std::uint8_t>(direction), static_cast<std::uint8_t>(ring),
          static_cast<std::uint8_t>(at - ring * kParts)};
}

constexpr std::array<Place, kSide * kSide> makePlaces() {
  std::array<Place, kSide * kSide> places{};
  for (std::size_t i = 0; i < places.size(); ++i)
    places[i] = placeOf(static_cast<int>(i) % kSide, static_cast<int>(i) / kSide);
  return places;
}
constexpr auto kPlaces = makePlaces();

// 1024 cos and sin of an order's phase in each direction. What is left out, half a direction, turns all alike.
struct Waves {
  std::array<std::array<std::int32_t, PolarLayout::kDirections>, PolarLayout::kOrders> cosine{}, sine{};
};

constexpr std::int32_t cosineOfDirection(int direction) {
  const int in_turn = direction % PolarLayout::kDirections;
  return cosineOfPart(in_turn <= PolarLayout::kDirections / 2 ? in_turn : PolarLayout::kDirections - in_turn);
}

constexpr Waves makeWaves() {
  Waves waves;
  for (int order = 0; order < PolarLayout::kOrders; ++order) {
    for (int k = 0; k < PolarLayout::kDirections; ++k) {
      const auto m = static_cast<std::size_t>(order), at = static_cast<std::size_t>(k);
      waves.cosine[m][at] = cosineOfDirection(order * k);
      waves.sine[m][at] = cosineOfDirection(order * k + PolarLayout::kDirections * 3 / 4);
    }
  }
  return waves;
}
constexpr Waves kWaves = makeWaves();

VOXID_VECTORISED std::int32_t productOf(const std::int32_t* density, const std::int32_t* wave) {
  std::int32_t sum = 0;
  for (int i = 0; i < PolarLayout::kDirections; ++i) sum += density[i] * wave[i];
  return sum;
}

// 508^2 |p| with the sign of p: the half that rounding needs is a bit more. 254^2 is where a number ends.
std::int32_t squaredNumber(std::int64_t product_q30) {
  constexpr std::int64_t kMost = 254 * 254;
  return static_cast<std::int32_t>(std::min(std::max(product_q30 * (508 * 508) / (1 << 30), -kMost), kMost));
}

// Without a branch, sixteen in step.
VOXID_VECTORISED void writeRoots(const std::int32_t* squares, std::uint8_t* numbers) {
  for (int i = 0; i < PolarLayout::kNumbers; ++i) {
    const std::int32_t size = squares[i] < 0 ? -squares[i] : squares[i];
    std::int32_t root = 0;
    for (int bit = 7; bit >= 0; --bit) root += square(root + (1 << bit)) <= size ? 1 << bit : 0;
    const std::int32_t number = (root + 1) >> 1;
    numbers[i] = static_cast<std::uint8_t>(128 + (squares[i] < 0 ? -number : number));
  }
}

}  // namespace

void PolarLayout::add(const SurfaceCell& cell) {
  const Place& place = kPlaces[static_cast<std::size_t>(cell.row * kSide + cell.column)];
  const std::int32_t lean = (cell.nx * place.x_q10 + cell.ny * place.y_q10 + (1 << 15)) >> 16;
  const auto outer = static_cast<std::int32_t>(place.outward), inner = kParts - outer;
  const std::size_t ring = place.ring, direction = place.direction;
  densities_[ring][direction] += inner;
  densities_[ring + 1][direction] += outer;
  densities_[kRings + ring][direction] += inner * lean;
  densities_[kRings + ring + 1][direction] += outer * lean;
}

// Of a real series: twice the complex one's, but at order zero.
PolarLayout::Coefficient PolarLayout::coefficient(int series, int order, std::int64_t whole) const {
  constexpr std::int64_t kOne = 1 << 5;  // and 2^10 of the waves
  const auto s = static_cast<std::size_t>(series), m = static_cast<std::size_t>(order);
  const std::int64_t scale = order == 0 ? kOne : 2 * kOne, unit = series < kRings ? whole : kParts * whole;
  const std::int32_t* const density = densities_[s].data();
  return {static_cast<std::int32_t>(productOf(density, kWaves.cosine[m].data()) * scale / unit),
          static_cast<std::int32_t>(productOf(density, kWaves.sine[m].data()) * scale / unit)};
}

void PolarLayout::measure(Span<const SurfaceCell> cells, std::uint8_t* numbers) {
  for (Density& density : densities_) density.fill(0);
  for (const SurfaceCell& cell : cells) add(cell);
  const auto whole = std::max<std::int64_t>(static_cast<std::int64_t>(cells.size) * kParts, 1);
  std::array<Coefficient, kSeries> c;
  std::array<std::int32_t, kNumbers> squares;
  std::size_t next = 0;
  for (int order = 0; order < kOrders; ++order) {
    for (int series = 0; series < kSeries; ++series)
      c[static_cast<std::size_t>(series)] = coefficient(series, order, whole);
    for (std::size_t a = 0; a < c.size(); ++a) {
      for (std::size_t b = a; b < c.size(); ++b) {
        squares[next++] = squaredNumber(std::int64_t{c[a].cosine_q15} * c[b].cosine_q15 +
                                        std::int64_t{c[a].sine_q15} * c[b].sine_q15);
      }
    }
  }
  writeRoots(squares.data(), numbers);
}

}  // namespace voxid
