// SPDX-License-Identifier: BSD-3-Clause
#include "draw_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "../core/pair_sampler.h"
#include "float_shapes.h"

namespace voxid::cli {
namespace {

using Eigen::Vector3d;

constexpr int kPanel = 480, kMargin = 40;
constexpr double kMiddle = VoxelGrid::kSide / 2.0;

/// Where the viewer of the picture stands, the object's frame being x right, y down, z away from the camera.
Vector3d turned(const Vector3d& p) {
  const double right = 0.61, above = 0.44;  // radians
  const double x = std::cos(right) * p.x() + std::sin(right) * p.z();
  const double z = -std::sin(right) * p.x() + std::cos(right) * p.z();
  return {x, std::cos(above) * p.y() - std::sin(above) * z, std::sin(above) * p.y() + std::cos(above) * z};
}

Vector3d centreOf(Cell cell) { return Vector3d(cell.x, cell.y, cell.z).array() + (0.5 - kMiddle); }

std::vector<Cell> cellsOf(const VoxelGrid& grid) {
  std::vector<Cell> cells;
  for (int i = 0; i < VoxelGrid::kSide * VoxelGrid::kSide * VoxelGrid::kSide; ++i) {
    const auto part = [i](int shift) { return static_cast<std::uint8_t>(i >> shift & 63); };
    const Cell cell{part(0), part(6), part(12)};
    if (grid.test(cell)) cells.push_back(cell);
  }
  return cells;
}

/// From the grid, a cell as unit, to a panel that shows all of its cells.
class Projection {
 public:
  explicit Projection(const std::vector<Cell>& cells) {
    Vector3d least = Vector3d::Constant(kMiddle), most = -least;
    for (const Cell cell : cells) {
      least = least.cwiseMin(turned(centreOf(cell)));
      most = most.cwiseMax(turned(centreOf(cell)));
    }
    const double width = std::max((most - least).head<2>().maxCoeff(), 1.0) + 2;
    scale_ = (kPanel - 2 * kMargin) / width;
    middle_ = (least + most) / 2;
  }

  /// In 1/16 pixel, as OpenCV takes it with a shift of 4.
  cv::Point operator()(const Vector3d& p) const {
    const Vector3d at = (turned(p) - middle_) * scale_ + Vector3d::Constant(kPanel / 2.0);
    return {static_cast<int>(std::lround(16 * at.x())), static_cast<int>(std::lround(16 * at.y()))};
  }

 private:
  double scale_;
  Vector3d middle_;
};
constexpr int kShift = 4;

/// The three faces of a cell that the viewer sees: its normal and two edges, and how bright it is.
struct Face {
  Vector3d normal, u, v;
  double light;
};
const std::array<Face, 3>& seenFaces() {
  static const std::array<Face, 3> faces{{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}, 1.0},
                                          {{0, 0, -1}, {1, 0, 0}, {0, 1, 0}, 0.86},
                                          {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 0.72}}};
  return faces;
}

void drawFace(const Projection& project, const Vector3d& centre, const Face& face, const cv::Scalar& colour,
              cv::Mat panel) {
  const Vector3d middle = centre + face.normal / 2;
  std::array<cv::Point, 4> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double u = i == 0 || i == 3 ? -0.5 : 0.5, v = i < 2 ? -0.5 : 0.5;
    corners[i] = project(middle + u * face.u + v * face.v);
  }
  cv::fillConvexPoly(panel, corners.data(), 4, colour * face.light, cv::LINE_8, kShift);
}

/// Far cells first, so that near ones cover them.
void drawCells(std::vector<Cell> cells, const Projection& project, const cv::Scalar& colour, cv::Mat panel) {
  const auto depth = [](Cell cell) { return turned(centreOf(cell)).z(); };
  std::sort(cells.begin(), cells.end(), [&](Cell a, Cell b) { return depth(a) > depth(b); });
  for (const Cell cell : cells) {
    for (const Face& face : seenFaces()) drawFace(project, centreOf(cell), face, colour, panel);
  }
}

struct Line {
  Vector3d from, to;  // as FloatSample has them
};

/// Lines of one kind: how many there are, and the first of them.
struct Lines {
  static constexpr std::size_t kDrawn = 150;
  std::uint32_t count = 0;
  std::vector<Line> first;

  void add(const Line& line) {
    ++count;
    if (first.size() < kDrawn) first.push_back(line);
  }
};
using LinesByKind = std::array<Lines, 3>;

LinesByKind linesOf(const std::vector<FloatSample>& samples, const VoxelGrid& surface, const DescriptorParams& params) {
  PairSampler pairs(params.seed, static_cast<std::uint32_t>(samples.size()));
  LinesByKind lines;
  for (std::uint32_t i = 0; i < params.pairs; ++i) {
    const auto [first, second] = pairs.next();
    const FloatSample &a = samples[first], &b = samples[second];
    const LineKind kind = kindOf(walk(surface, a.cell, b.cell));
    lines[static_cast<std::size_t>(kind)].add({a.p, b.p});
  }
  return lines;
}

void write(const std::string& text, cv::Mat panel) {
  cv::putText(panel, text, {kMargin / 2, kMargin / 2 + 6}, cv::FONT_HERSHEY_SIMPLEX, 0.5, {60, 60, 60}, 1, cv::LINE_AA);
}

void drawLinesOf(const Lines& lines, const Projection& project, const cv::Scalar& colour, cv::Mat panel) {
  for (const Line& line : lines.first) {
    const cv::Point from = project(line.from * VoxelGrid::kSide), to = project(line.to * VoxelGrid::kSide);
    cv::line(panel, from, to, colour, 1, cv::LINE_AA, kShift);
  }
}

struct KindStyle {
  const char* name;
  cv::Scalar colour;
};

std::string titleOf(const char* name, const Lines& lines, std::uint32_t pairs) {
  char text[96];
  std::snprintf(text, sizeof text, "%s: %.1f %% of %u lines", name, 100.0 * lines.count / pairs, pairs);
  return text;
}

}  // namespace

cv::Mat drawLines(Span<const PointUm> points, const DescriptorParams& params) {
  const std::array<KindStyle, 3> styles{{{"ON", {60, 150, 30}}, {"OFF", {40, 30, 210}}, {"MIXED", {200, 90, 30}}}};
  const cv::Scalar solid{210, 170, 120}, faint{238, 234, 230};
  const std::vector<FloatSample> samples = samplesOf(points);
  const VoxelGrid surface = surfaceOf(samples);
  const std::vector<Cell> cells = cellsOf(surface);
  const LinesByKind lines = linesOf(samples, surface, params);
  const Projection project(cells);

  cv::Mat picture(2 * kPanel, 2 * kPanel, CV_8UC3, cv::Scalar(255, 255, 255));
  const auto panelOf = [&](int i) { return picture({i % 2 * kPanel, i / 2 * kPanel, kPanel, kPanel}); };
  drawCells(cells, project, solid, panelOf(0));
  write("grid 64 x 64 x 64: " + std::to_string(cells.size()) + " cells set", panelOf(0));
  for (int kind = 0; kind < 3; ++kind) {
    const KindStyle& style = styles[static_cast<std::size_t>(kind)];
    const Lines& these = lines[static_cast<std::size_t>(kind)];
    drawCells(cells, project, faint, panelOf(kind + 1));
    drawLinesOf(these, project, style.colour, panelOf(kind + 1));
    write(titleOf(style.name, these, params.pairs), panelOf(kind + 1));
  }
  return picture;
}

}  // namespace voxid::cli
