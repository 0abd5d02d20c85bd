// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/library/renderer.h"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace voxid {
namespace {

using Eigen::Vector3f;

/// Depths differ between instruction sets in the last digits (measured: avx512, avx2 and sse2 give three answers), so
/// one is chosen, which every amd64 processor has. One device a process: making one takes milliseconds.
RTCDevice device() {
  static const RTCDevice only = rtcNewDevice("threads=1,isa=sse2");
  if (only == nullptr) throw std::runtime_error("Embree gives no device");
  return only;
}

/// Takes points and directions of the camera's frame to the scene's.
class ToScene {
 public:
  explicit ToScene(const Placement& pose)
      : turn_(pose.rotation.transpose() / pose.scale), camera_(turn_ * -pose.translation) {}
  Vector3f direction(const Vector3f& d) const { return turn_ * d; }
  Vector3f point(const Vector3f& p) const { return turn_ * p + camera_; }
  const Vector3f& camera() const { return camera_; }

 private:
  Eigen::Matrix3f turn_;
  Vector3f camera_;
};

Vector3f rayThrough(const Camera& camera, const Eigen::Vector2f& point_px) {
  constexpr float kQ16 = 65536;
  return {(point_px.x() * kQ16 - camera.cx_q16) / camera.fx_q16, (point_px.y() * kQ16 - camera.cy_q16) / camera.fy_q16,
          1};
}

constexpr std::size_t kPacket = 4;  ///< as wide as SSE2

void setRay(RTCRay4& rays, std::size_t i, const Vector3f& origin, const Vector3f& direction, float nearest,
            float farthest) {
  rays.org_x[i] = origin.x();
  rays.org_y[i] = origin.y();
  rays.org_z[i] = origin.z();
  rays.dir_x[i] = direction.x();
  rays.dir_y[i] = direction.y();
  rays.dir_z[i] = direction.z();
  rays.tnear[i] = nearest;
  rays.tfar[i] = farthest;
  rays.mask[i] = 0xffffffff;
}

RTCIntersectContext coherentContext() {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return context;
}

Hit hitOf(const RTCRayHit4& rays, std::size_t i) {
  if (rays.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) return {};
  const Vector3f normal(rays.hit.Ng_x[i], rays.hit.Ng_y[i], rays.hit.Ng_z[i]);
  const Vector3f direction(rays.ray.dir_x[i], rays.ray.dir_y[i], rays.ray.dir_z[i]);
  const float lengths = normal.norm() * direction.norm();
  Hit hit;
  hit.depth_mm = rays.ray.tfar[i];
  hit.cosine = lengths > 0 ? std::abs(normal.dot(direction)) / lengths : 0;
  hit.object = static_cast<std::uint16_t>(rays.hit.geomID[i] + 1);
  return hit;
}

}  // namespace

Placement unitPlacement(const Mesh& mesh) {
  const MeshBox box = boxOf(mesh);
  Placement placement;
  const double scale = 1 / box.diagonal();
  const auto centre = box.centre();
  for (int i = 0; i < 3; ++i) placement.translation[i] = static_cast<float>(-centre[i] * scale);
  placement.scale = static_cast<float>(scale);
  return placement;
}

struct RayScene::Impl {
  RTCScene scene = rtcNewScene(device());
  int meshes = 0;
  Impl() { rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST); }
  ~Impl() { rtcReleaseScene(scene); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
};

RayScene::RayScene() : impl_(std::make_unique<Impl>()) {}
RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

int RayScene::add(const Mesh& mesh, const Placement& placement) {
  const RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* const vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Mesh::Vertex), mesh.vertices.size()));
  auto* const triangles = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Mesh::Triangle), mesh.triangles.size()));
  if (vertices == nullptr || triangles == nullptr) throw std::bad_alloc();
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto& v = mesh.vertices[i];
    Vector3f::Map(vertices + 3 * i) = placement(Vector3f(v[0], v[1], v[2]));
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) std::copy_n(mesh.triangles[i].data(), 3, triangles + 3 * i);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(impl_->scene, geometry, static_cast<unsigned>(impl_->meshes));
  rtcReleaseGeometry(geometry);
  return impl_->meshes++;
}

void RayScene::commit() { rtcCommitScene(impl_->scene); }

void RayScene::cast(const Camera& camera, const Placement& pose, Span<const Eigen::Vector2f> points_px,
                    Span<Hit> hits) const {
  const ToScene to_scene(pose);
  RTCIntersectContext context = coherentContext();
  for (std::size_t first = 0; first < points_px.size; first += kPacket) {
    const std::size_t count = std::min(kPacket, points_px.size - first);
    alignas(16) RTCRayHit4 rays{};
    alignas(16) int valid[kPacket] = {};
    for (std::size_t i = 0; i < count; ++i) {
      // The direction's z is 1 in the camera's frame, so the distance along the ray is the depth.
      const Vector3f direction = to_scene.direction(rayThrough(camera, points_px[first + i]));
      setRay(rays.ray, i, to_scene.camera(), direction, 0, std::numeric_limits<float>::infinity());
      rays.hit.geomID[i] = rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
      valid[i] = -1;
    }
    rtcIntersect4(valid, impl_->scene, &context, &rays);
    for (std::size_t i = 0; i < count; ++i) hits[first + i] = hitOf(rays, i);
  }
}

void RayScene::findBlocked(const Placement& pose, Span<const Vector3f> from_mm, const Vector3f& to_mm,
                           Span<std::uint8_t> blocked) const {
  constexpr float kOff = 0.002f;  // of the way, so that the surfaces at its ends do not block
  const ToScene to_scene(pose);
  RTCIntersectContext context = coherentContext();
  for (std::size_t first = 0; first < from_mm.size; first += kPacket) {
    const std::size_t count = std::min(kPacket, from_mm.size - first);
    alignas(16) RTCRay4 rays{};
    alignas(16) int valid[kPacket] = {};
    for (std::size_t i = 0; i < count; ++i) {
      const Vector3f& from = from_mm[first + i];
      setRay(rays, i, to_scene.point(from), to_scene.direction(to_mm - from), kOff, 1 - kOff);
      valid[i] = -1;
    }
    rtcOccluded4(valid, impl_->scene, &context, &rays);
    for (std::size_t i = 0; i < count; ++i) blocked[first + i] = rays.tfar[i] < 0;
  }
}

PixelBox RayScene::projectedBox(const Imager& imager, const Placement& pose) const {
  RTCBounds bounds;
  rtcGetSceneBounds(impl_->scene, &bounds);
  const Camera& c = imager.camera;
  float low_u = std::numeric_limits<float>::infinity(), low_v = low_u, high_u = -low_u, high_v = -low_u;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3f p =
        pose(Vector3f(corner & 1 ? bounds.upper_x : bounds.lower_x, corner & 2 ? bounds.upper_y : bounds.lower_y,
                      corner & 4 ? bounds.upper_z : bounds.lower_z));
    if (p.z() <= 0) return {0, 0, imager.width_px, imager.height_px};
    const float u = (p.x() / p.z() * c.fx_q16 + c.cx_q16) / 65536, v = (p.y() / p.z() * c.fy_q16 + c.cy_q16) / 65536;
    low_u = std::min(low_u, u);
    high_u = std::max(high_u, u);
    low_v = std::min(low_v, v);
    high_v = std::max(high_v, v);
  }
  const auto pixel = [](float x, int size) { return static_cast<int>(std::clamp(x, 0.0f, static_cast<float>(size))); };
  // One pixel more on every side: sensors do not look through pixel centres.
  const int x0 = pixel(std::floor(low_u) - 1, imager.width_px), x1 = pixel(std::ceil(high_u) + 2, imager.width_px);
  const int y0 = pixel(std::floor(low_v) - 1, imager.height_px), y1 = pixel(std::ceil(high_v) + 2, imager.height_px);
  return {x0, y0, x1 - x0, y1 - y0};
}

RenderedView render(const RayScene& scene, const Imager& imager, const Placement& pose) {
  RenderedView view{imager.width_px, imager.height_px, {}};
  view.hits.resize(static_cast<std::size_t>(imager.width_px) * imager.height_px);
  const PixelBox box = scene.projectedBox(imager, pose);
  std::vector<Eigen::Vector2f> row(static_cast<std::size_t>(box.width));
  for (int v = box.y; v < box.y + box.height; ++v) {
    for (int i = 0; i < box.width; ++i)
      row[static_cast<std::size_t>(i)] = Eigen::Vector2f(static_cast<float>(box.x + i), static_cast<float>(v));
    Hit* const first = view.hits.data() + static_cast<std::size_t>(v) * imager.width_px + box.x;
    scene.cast(imager.camera, pose, {row.data(), row.size()}, {first, row.size()});
  }
  return view;
}

}  // namespace voxid
