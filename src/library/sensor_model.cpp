// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/sensor_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "random.h"

namespace voxid {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;

/// Noise that neighbours share: normal values on a coarse grid, between them linear.
class CorrelatedNoise {
 public:
  CorrelatedNoise(const PixelBox& box, int cell_px, float deviation, Random& random)
      : box_(box), cell_px_(cell_px), columns_(box.width / cell_px + 2) {
    const int rows = box.height / cell_px + 2;
    knots_.resize(static_cast<std::size_t>(columns_) * rows);
    // Linear interpolation leaves two thirds of the deviation on average (4/9 of the variance).
    for (float& knot : knots_) knot = 1.5f * deviation * random.normal();
  }

  float at(int u, int v) const {
    const int x = (u - box_.x) / cell_px_, y = (v - box_.y) / cell_px_;
    const float fx = static_cast<float>((u - box_.x) % cell_px_) / cell_px_,
                fy = static_cast<float>((v - box_.y) % cell_px_) / cell_px_;
    const float* const k = &knots_[static_cast<std::size_t>(y) * columns_ + x];
    const float top = k[0] + fx * (k[1] - k[0]), bottom = k[columns_] + fx * (k[columns_ + 1] - k[columns_]);
    return top + fy * (bottom - top);
  }

 private:
  PixelBox box_;
  int cell_px_, columns_;
  std::vector<float> knots_;
};

/// One observation in the making.
class Sensor {
 public:
  Sensor(const RayScene& scene, const Imager& imager, const Placement& pose, const SensorParams& params,
         std::uint64_t seed)
      : scene_(scene),
        imager_(imager),
        pose_(pose),
        params_(params),
        random_(seed),
        box_(scene.projectedBox(imager, pose)),
        noise_(box_, params.correlation_px, params.correlated_px, random_) {
    const std::size_t pixels = static_cast<std::size_t>(imager.width_px) * imager.height_px;
    image_.imager = imager;
    image_.depth_mm.assign(pixels, 0);
    image_.objects.assign(pixels, 0);
    row_ = Row(static_cast<std::size_t>(box_.width));
  }

  DepthImage observe() {
    for (int v = box_.y; v < box_.y + box_.height; ++v) measureRow(v);
    loseOutline();
    punchHoles();
    if (random_.chance(params_.cut_share)) cutBottom();
    return std::move(image_);
  }

 private:
  std::size_t at(int u, int v) const { return static_cast<std::size_t>(v) * imager_.width_px + u; }
  void erase(std::size_t i) { image_.depth_mm[i] = image_.objects[i] = 0; }

  void measureRow(int v) {
    // Drawn whether needed or not, so that a pixel's noise does not hang on its neighbours' depth.
    for (int i = 0; i < box_.width; ++i) {
      const float du = random_.between(-params_.jitter_px, params_.jitter_px),
                  dv = random_.between(-params_.jitter_px, params_.jitter_px);
      row_.looks_at_px[i] = Eigen::Vector2f(static_cast<float>(box_.x + i) + du, static_cast<float>(v) + dv);
      row_.noise_px[i] = params_.white_px * random_.normal() + noise_.at(box_.x + i, v);
    }
    scene_.cast(imager_.camera, pose_, {row_.looks_at_px.data(), row_.looks_at_px.size()},
                {row_.hits.data(), row_.hits.size()});
    keepSeenFrontally();
    const std::size_t seen = row_.seen.size();
    scene_.findBlocked(pose_, {row_.points_mm.data(), seen}, Vector3f(params_.baseline_mm, 0, 0),
                       {row_.shadowed.data(), seen});
    for (std::size_t k = 0; k < seen; ++k) {
      if (row_.shadowed[k] == 0)
        set(at(box_.x + row_.seen[k], v), row_.hits[row_.seen[k]], row_.noise_px[row_.seen[k]]);
    }
  }

  void keepSeenFrontally() {
    row_.seen.clear();
    row_.points_mm.clear();
    const Camera& c = imager_.camera;
    for (int i = 0; i < box_.width; ++i) {
      const Hit& hit = row_.hits[i];
      if (hit.object == 0 || hit.cosine < params_.least_cosine) continue;
      const Eigen::Vector2f& p = row_.looks_at_px[i];
      row_.seen.push_back(i);
      row_.points_mm.emplace_back((p.x() * 65536 - c.cx_q16) / c.fx_q16 * hit.depth_mm,
                                  (p.y() * 65536 - c.cy_q16) / c.fy_q16 * hit.depth_mm, hit.depth_mm);
    }
  }

  void set(std::size_t pixel, const Hit& hit, float noise_px) {
    const std::uint16_t depth_mm = quantised(hit.depth_mm, noise_px);
    image_.depth_mm[pixel] = depth_mm;
    image_.objects[pixel] = depth_mm == 0 ? 0 : hit.object;
  }

  std::uint16_t quantised(float depth_mm, float noise_px) const {
    const float focal_baseline = imager_.camera.fx_q16 / 65536.0f * params_.baseline_mm;
    const float steps = std::round((focal_baseline / depth_mm + noise_px) * params_.steps_per_px);
    const float measured_mm = steps > 0 ? std::round(focal_baseline * params_.steps_per_px / steps) : 0;
    return measured_mm <= 65535 ? static_cast<std::uint16_t>(measured_mm) : 0;
  }

  /// As DepthImage::setPixels(), faster.
  std::vector<std::uint32_t> pixelsInBox() const {
    std::vector<std::uint32_t> pixels;
    for (int v = box_.y; v < box_.y + box_.height; ++v) {
      for (std::size_t i = at(box_.x, v); i < at(box_.x + box_.width, v); ++i) {
        if (image_.depth_mm[i] != 0) pixels.push_back(static_cast<std::uint32_t>(i));
      }
    }
    return pixels;
  }

  bool onOutline(int u, int v) const {
    const std::uint16_t object = image_.objects[at(u, v)];
    const auto other = [&](int x, int y) {
      return x >= 0 && y >= 0 && x < imager_.width_px && y < imager_.height_px && image_.objects[at(x, y)] != object;
    };
    return object != 0 && (other(u - 1, v) || other(u + 1, v) || other(u, v - 1) || other(u, v + 1));
  }

  void loseOutline() {
    std::vector<std::size_t> lost;
    for (int v = box_.y; v < box_.y + box_.height; ++v) {
      for (int u = box_.x; u < box_.x + box_.width; ++u) {
        if (onOutline(u, v) && random_.chance(params_.outline_loss)) lost.push_back(at(u, v));
      }
    }
    for (const std::size_t i : lost) erase(i);
  }

  void punchHoles() {
    const std::vector<std::uint32_t> pixels = pixelsInBox();
    const int holes = random_.below(params_.most_holes + 1);
    for (int i = 0; i < holes && !pixels.empty(); ++i) {
      const std::uint32_t centre = pixels[random_.below(static_cast<int>(pixels.size()))];
      punch(static_cast<int>(centre % imager_.width_px), static_cast<int>(centre / imager_.width_px),
            random_.between(1, params_.hole_radius_px));
    }
  }

  void punch(int u0, int v0, float radius_px) {
    const int reach = static_cast<int>(radius_px);
    for (int v = std::max(0, v0 - reach); v <= std::min(imager_.height_px - 1, v0 + reach); ++v) {
      for (int u = std::max(0, u0 - reach); u <= std::min(imager_.width_px - 1, u0 + reach); ++u) {
        if ((u - u0) * (u - u0) + (v - v0) * (v - v0) <= radius_px * radius_px) erase(at(u, v));
      }
    }
  }

  void cutBottom() {
    const std::vector<std::uint32_t> pixels = pixelsInBox();
    if (pixels.empty()) return;
    const int first = static_cast<int>(pixels.front() / imager_.width_px),
              last = static_cast<int>(pixels.back() / imager_.width_px);
    const int rows =
        static_cast<int>(std::lround(random_.between(params_.cut_least, params_.cut_most) * (last - first + 1)));
    for (std::size_t i = at(0, last + 1 - rows); i < at(0, last + 1); ++i) erase(i);
  }

  /// A row of the box in the making; the last three only hold what was seen.
  struct Row {
    explicit Row(std::size_t width = 0) : looks_at_px(width), noise_px(width), hits(width), shadowed(width) {}
    std::vector<Eigen::Vector2f> looks_at_px;
    std::vector<float> noise_px;
    std::vector<Hit> hits;
    std::vector<int> seen;
    std::vector<Vector3f> points_mm;
    std::vector<std::uint8_t> shadowed;
  };

  const RayScene& scene_;
  const Imager& imager_;
  const Placement& pose_;
  const SensorParams& params_;
  Random random_;
  PixelBox box_;
  CorrelatedNoise noise_;
  Row row_;
  DepthImage image_;
};

Vector3f unitVector(const std::int16_t (&v)[3]) { return Vector3f(v[0], v[1], v[2]).normalized(); }

/// A random rotation about z, by a point in the unit disc: no sine, so every machine rounds alike.
Matrix3f drawRoll(Random& random) {
  float x = 1, y = 0, squared = 1;
  for (int tries = 0; tries < 64; ++tries) {
    const float a = random.between(-1, 1), b = random.between(-1, 1);
    if (a * a + b * b > 1 || a * a + b * b < 0.01f) continue;
    x = a;
    y = b;
    squared = a * a + b * b;
    break;
  }
  const float cosine = x / std::sqrt(squared), sine = y / std::sqrt(squared);
  Matrix3f roll;
  roll << cosine, -sine, 0, sine, cosine, 0, 0, 0, 1;
  return roll;
}

/// The smallest rotation that takes the optical axis to a unit vector in front of the camera (Rodrigues).
Matrix3f rotationFromAxisTo(const Vector3f& to) {
  const Vector3f cross = Vector3f::UnitZ().cross(to);
  Matrix3f skew;
  skew << 0, -cross.z(), cross.y(), cross.z(), 0, -cross.x(), -cross.y(), cross.x(), 0;
  return Matrix3f::Identity() + skew + skew * skew / (1 + to.z());
}

/// Rows: right, down, forward of a camera that looks along -to_camera.
Matrix3f lookFrom(const format::Direction& direction) {
  const Vector3f forward = -unitVector(direction.to_camera);
  const Vector3f right = forward.cross(unitVector(direction.up)).normalized();
  Matrix3f rotation;
  rotation << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  return rotation;
}

float drawShift(Random& random, float most_px, float half_size_px, float radius_px) {
  const float room_px = std::clamp(half_size_px - radius_px, 0.0f, most_px);
  return random.between(-room_px, room_px);
}

}  // namespace

DepthView DepthImage::view() const {
  DepthView view;
  view.data = depth_mm.data();
  view.width_px = imager.width_px;
  view.height_px = imager.height_px;
  view.row_bytes = static_cast<std::size_t>(imager.width_px) * sizeof(std::uint16_t);
  view.camera = imager.camera;
  return view;
}

std::vector<std::uint32_t> DepthImage::setPixels() const {
  std::vector<std::uint32_t> pixels;
  for (std::size_t i = 0; i < depth_mm.size(); ++i) {
    if (depth_mm[i] != 0) pixels.push_back(static_cast<std::uint32_t>(i));
  }
  return pixels;
}

DepthImage observe(const RayScene& scene, const Imager& imager, const Placement& pose, const SensorParams& params,
                   std::uint64_t seed) {
  return Sensor(scene, imager, pose, params, seed).observe();
}

DepthImage observeClean(const RayScene& scene, const Imager& imager, const Placement& pose) {
  const RenderedView ideal = render(scene, imager, pose);
  DepthImage image{imager, std::vector<std::uint16_t>(ideal.hits.size()),
                   std::vector<std::uint16_t>(ideal.hits.size())};
  for (std::size_t i = 0; i < ideal.hits.size(); ++i) {
    const float depth_mm = std::round(ideal.hits[i].depth_mm);
    if (depth_mm < 1 || depth_mm > 65535) continue;
    image.depth_mm[i] = static_cast<std::uint16_t>(depth_mm);
    image.objects[i] = ideal.hits[i].object;
  }
  return image;
}

Placement drawPose(const format::Direction& direction, const Imager& imager, const ViewRange& range,
                   std::uint64_t seed) {
  Random random(seed);
  const float diagonal_mm = random.between(range.least_diagonal_mm, range.most_diagonal_mm);
  const float distance_mm = random.between(range.least_distance_mm, range.most_distance_mm);
  const Matrix3f roll = drawRoll(random);
  const float fx_px = imager.camera.fx_q16 / 65536.0f;
  const float radius_px = fx_px * diagonal_mm / 2 / (distance_mm - diagonal_mm / 2);
  const float shift_u = drawShift(random, range.most_shift_px, imager.width_px / 2.0f, radius_px);
  const float shift_v = drawShift(random, range.most_shift_px, imager.height_px / 2.0f, radius_px);
  const float centre_u = (imager.width_px - 1) / 2.0f + shift_u, centre_v = (imager.height_px - 1) / 2.0f + shift_v;
  const Vector3f ray((centre_u * 65536 - imager.camera.cx_q16) / imager.camera.fx_q16,
                     (centre_v * 65536 - imager.camera.cy_q16) / imager.camera.fy_q16, 1);
  Placement pose;
  pose.rotation = rotationFromAxisTo(ray.normalized()) * roll * lookFrom(direction);
  pose.translation = ray.normalized() * distance_mm;
  pose.scale = diagonal_mm;
  return pose;
}

}  // namespace voxid
