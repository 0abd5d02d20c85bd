// SPDX-License-Identifier: BSD-3-Clause
#include "model_views.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "deform.h"
#include "random.h"
#include "voxid/library/model_surface.h"
#include "voxid/library/model_view.h"
#include "voxid/library/renderer.h"
#include "voxid/library/sensor_model.h"
#include "voxid/library/views.h"

namespace voxid {
namespace {

// Thin things seen from their end show few pixels. Below kEnoughPoints a view is drawn again, larger and nearer; below
// kLeastPoints it says nothing and is left out.
constexpr std::size_t kEnoughPoints = 50, kLeastPoints = 20;
constexpr int kTries = 4;
constexpr std::uint64_t kCalibrationView = 1000;

const ViewRange& rangeOf(int tried) {
  static const ViewRange usual;
  static const ViewRange near = [] {
    ViewRange range;
    range.least_diagonal_mm = range.most_diagonal_mm;
    range.most_distance_mm = range.least_distance_mm;
    return range;
  }();
  return tried == 0 ? usual : near;
}

ModelView look(const RayScene& scene, const format::Direction& direction, const std::string& name, std::uint64_t view,
               int tried) {
  const Imager imager;
  const std::uint64_t number = view * kTries + static_cast<std::uint64_t>(tried);
  const Placement pose = drawPose(direction, imager, rangeOf(tried), seedOf(name, 2 * number));
  ModelView seen;
  seen.image = observe(scene, imager, pose, SensorParams(), seedOf(name, 2 * number + 1));
  seen.pixels = seen.image.setPixels();
  seen.diagonal_mm = pose.scale;
  return seen;
}

ModelView lookUntilEnough(const RayScene& scene, const format::Direction& direction, const std::string& name,
                          std::uint64_t view) {
  ModelView best;
  for (int tried = 0; tried < kTries && best.pixels.size() < kEnoughPoints; ++tried) {
    ModelView seen = look(scene, direction, name, view, tried);
    if (seen.pixels.size() >= best.pixels.size()) best = std::move(seen);
  }
  return best;
}

/// The code of what was seen; empty if that is too little.
std::vector<std::uint8_t> codeOf(const ModelView& seen, const EncodeView& encode) {
  if (seen.pixels.size() < kLeastPoints) return {};
  return encode(seen.image.view(), {seen.pixels.data(), seen.pixels.size()});
}

std::int16_t component(Random& random) { return static_cast<std::int16_t>(random.below(2 * 32767 + 1) - 32767); }

void show(RayScene& scene, const Mesh& mesh) {
  scene.add(mesh, unitPlacement(mesh));
  scene.commit();
}

constexpr std::uint64_t kDeformation = 2000;

ModelView drawDeformedView(const Mesh& mesh, const std::string& name, int direction) {
  Random random(seedOf(name, kDeformation + static_cast<std::uint64_t>(direction)));
  RayScene scene;
  show(scene, deformed(mesh, random));
  return drawModelView(scene, name, direction);
}

/// Evenly distributed: a point of the ball, whose length does not matter.
format::Direction drawDirection(Random& random) {
  format::Direction direction{};
  auto& d = direction.to_camera;
  d[2] = 32767;
  for (int tries = 0; tries < 64; ++tries) {
    const std::int16_t x = component(random), y = component(random), z = component(random);
    const double squared = (1.0 * x * x + 1.0 * y * y + 1.0 * z * z) / (32767.0 * 32767);
    if (squared > 1 || squared < 0.1) continue;
    d[0] = x;
    d[1] = y;
    d[2] = z;
    break;
  }
  // Any direction that is not along to_camera serves: the roll is drawn anyway.
  direction.up[std::abs(d[1]) < std::abs(d[0]) ? 1 : 0] = 32767;
  return direction;
}

}  // namespace

EncodeView encodeWith(const Profile& profile) {
  const std::shared_ptr<Encoder> encoder = makeEncoder(profile);
  return [encoder, bytes = profile.codeBytes()](const DepthView& depth, Span<const std::uint32_t> pixels) {
    std::vector<std::uint8_t> code(bytes);
    if (encoder->encode(depth, pixels, code.data()) != DescribeStatus::Ok) code.clear();
    return code;
  };
}

std::array<std::uint16_t, 3> extentsOf(const ModelView& seen) {
  const DepthView view = seen.image.view();
  std::array<std::int32_t, 3> low{INT32_MAX, INT32_MAX, INT32_MAX}, high{INT32_MIN, INT32_MIN, INT32_MIN};
  for (const std::uint32_t pixel : seen.pixels) {
    const int u = static_cast<int>(pixel % view.width_px), v = static_cast<int>(pixel / view.width_px);
    const PointUm p = backProject(view.camera, u, v, view.depthUm(u, v));
    const std::int32_t axes[3] = {p.x, p.y, p.z};
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], axes[i]);
      high[i] = std::max(high[i], axes[i]);
    }
  }
  std::array<std::uint16_t, 3> extents{};
  for (int i = 0; i < 3; ++i) {
    const double share = (static_cast<double>(high[i]) - low[i]) / (seen.diagonal_mm * 1000.0);
    extents[i] = static_cast<std::uint16_t>(std::min(65535.0, std::round(share * 65535)));
  }
  return extents;
}

ModelView drawModelView(const RayScene& scene, const std::string& name, int direction) {
  const format::Direction& from = viewDirections()[static_cast<std::size_t>(direction)];
  return lookUntilEnough(scene, from, name, static_cast<std::uint64_t>(direction));
}

ModelViews makeViews(const Mesh& mesh, const std::string& name, const ViewChoice& choice, const EncodeView& encode) {
  RayScene scene;
  show(scene, mesh);

  ModelViews made;
  int number = 0;
  for (int i = 0; i < kDirections; i += choice.views_every) {
    const bool deform = choice.deform_second && number++ % 2 == 1;
    const ModelView seen = deform ? drawDeformedView(mesh, name, i) : drawModelView(scene, name, i);
    ViewRecord view;
    view.code = codeOf(seen, encode);
    if (view.code.empty()) continue;
    view.direction = static_cast<std::uint8_t>(i);
    view.points = static_cast<std::uint32_t>(seen.pixels.size());
    view.extents = extentsOf(seen);
    made.views.push_back(std::move(view));
  }
  if (made.views.empty()) made.refusal = "shows next to nothing from every direction";
  if (choice.keep_surface) made.surface = surfaceToKeep(mesh);
  Random random(seedOf(name, 2 * kCalibrationView * kTries - 1));
  made.calibration = codeOf(lookUntilEnough(scene, drawDirection(random), name, kCalibrationView), encode);
  return made;
}

}  // namespace voxid
