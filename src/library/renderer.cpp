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

/// Depths differ between instruction sets in the last digits (measured: avx512, avx2 and sse2 give three answers), so one
/// is chosen, which every amd64 processor has. One device a process: making one takes milliseconds.
RTCDevice device() {
  static const RTCDevice only = rtcNewDevice("threads=1,isa=sse2");
  if (only == nullptr) throw std::runtime_error("Embree gives no device");
  return only;
}

Vector3f rayThrough(const Camera& camera, float u, float v) {
  constexpr float kQ16 = 65536;
  return {(u * kQ16 - camera.cx_q16) / camera.fx_q16, (v * kQ16 - camera.cy_q16) / camera.fy_q16, 1};
}

/// A point or direction of the camera's frame in the scene's.
Vector3f directionToScene(const Placement& pose, const Vector3f& d) { return pose.rotation.transpose() * d / pose.scale; }
Vector3f pointToScene(const Placement& pose, const Vector3f& p) { return directionToScene(pose, p - pose.translation); }

RTCRay rayFrom(const Vector3f& origin, const Vector3f& direction, float nearest, float farthest) {
  RTCRay ray{};
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.tnear = nearest;
  ray.tfar = farthest;
  ray.mask = 0xffffffff;
  return ray;
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
  auto* const vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                     sizeof(Mesh::Vertex), mesh.vertices.size()));
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

Hit RayScene::cast(const Camera& camera, const Placement& pose, float u, float v) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  // The direction's z is 1 in the camera's frame, so the distance along the ray is the depth.
  const Vector3f direction = directionToScene(pose, rayThrough(camera, u, v));
  RTCRayHit ray{};
  ray.ray = rayFrom(pointToScene(pose, Vector3f::Zero()), direction, 0, std::numeric_limits<float>::infinity());
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene, &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  const Vector3f normal(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z);
  const float lengths = normal.norm() * direction.norm();
  Hit hit;
  hit.depth_mm = ray.ray.tfar;
  hit.cosine = lengths > 0 ? std::abs(normal.dot(direction)) / lengths : 0;
  hit.object = static_cast<std::uint16_t>(ray.hit.geomID + 1);
  return hit;
}

bool RayScene::blocked(const Placement& pose, const Vector3f& from_mm, const Vector3f& to_mm) const {
  // Starts and ends a little off, so that the surfaces at the ends do not block.
  constexpr float kOff = 0.002f;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  const Vector3f direction = directionToScene(pose, to_mm - from_mm);
  RTCRay ray = rayFrom(pointToScene(pose, from_mm), direction, kOff, 1 - kOff);
  rtcOccluded1(impl_->scene, &context, &ray);
  return ray.tfar < 0;
}

PixelBox RayScene::projectedBox(const Imager& imager, const Placement& pose) const {
  RTCBounds bounds;
  rtcGetSceneBounds(impl_->scene, &bounds);
  const Camera& c = imager.camera;
  float low_u = std::numeric_limits<float>::infinity(), low_v = low_u, high_u = -low_u, high_v = -low_u;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3f p = pose(Vector3f(corner & 1 ? bounds.upper_x : bounds.lower_x, corner & 2 ? bounds.upper_y : bounds.lower_y,
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
  for (int v = box.y; v < box.y + box.height; ++v) {
    for (int u = box.x; u < box.x + box.width; ++u) {
      view.hits[static_cast<std::size_t>(v) * imager.width_px + u] =
          scene.cast(imager.camera, pose, static_cast<float>(u), static_cast<float>(v));
    }
  }
  return view;
}

}  // namespace voxid
