// SPDX-License-Identifier: BSD-3-Clause
// Between the library, ROS and LCM: pure functions. ROS has quaternions x, y, z, w and covariances position first;
// LCM, as the type says, w first and rotation first.
#pragma once

#include <geometry_msgs/Transform.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <voxid/Objects.h>
#include <voxid/Segments.h>

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <voxid/object_list_t.hpp>
#include <voxid/object_points_t.hpp>

#include "voxid/core/classifier.h"
#include "voxid/core/status.h"
#include "voxid/geometry/primitive.h"
#include "voxid/geometry/scene.h"

namespace voxid {

/// The message's pixels as they lie, no copy; valid while the message lives. BadUse, with the reason, for an encoding
/// that is neither 16UC1 (also written mono16) nor 32FC1, foreign byte order, data shorter than its size says, and a
/// camera_info of another size or without focal lengths.
Result<DepthView> viewOf(const sensor_msgs::Image& image, const sensor_msgs::CameraInfo& info);

geometry_msgs::Point pointOf(const Eigen::Vector3d& p);
geometry_msgs::Vector3 vectorOf(const Eigen::Vector3d& v);
Eigen::Vector3d eigenOf(const geometry_msgs::Point& p);
Eigen::Vector3d eigenOf(const geometry_msgs::Vector3& v);
Eigen::Quaterniond eigenOf(const geometry_msgs::Quaternion& q);
Eigen::Isometry3d eigenOf(const geometry_msgs::Transform& t);
/// Unit, w not negative, so that equal rotations are equal numbers.
geometry_msgs::Quaternion quaternionOf(const Eigen::Quaterniond& q);

/// Pixels, boxes and table of one frame; `width_px` and `height_px` of the depth image. Replaces everything but the
/// header and segment_ms; memory that the message has is used again.
void fillSegments(const Scene& scene, int width_px, int height_px, Segments* message);

/// Whether every pixel that the segments name lies in the image.
bool fit(const Segments& segments, const DepthView& depth);

/// What is known about an object before it is named: id, box, pose with covariance, sizes, its solid as shape. Replaces
/// everything but the alternatives, which wait for fillAnswer; memory that the message has is used again.
void fillObject(const Segment& segment, const Primitive& solid, Object* object);

OrientedBox boxOf(const Segment& segment);
/// Dimensions in the message's order: a box x, y, z; a cylinder height, radius.
void fillShape(const Primitive& primitive, shape_msgs::SolidPrimitive* shape, geometry_msgs::Pose* pose);

/// The answer of a search: label (empty unless known), score, margin, alternatives, coarse, model, view.
void fillAnswer(const Answer& answer, const Index& index, Object* object);

/// Covariance of a box pose, row-major, position first, in the axes of the frame that the pose is in: the position is
/// somewhere in the box (half extent squared / 3 along each axis), the rotation about the box's z (the table's normal)
/// is unknown (pi^2 / 3), the tilt is taken as one degree.
std::array<double, 36> covarianceOf(const Eigen::Quaterniond& box_axes, const Eigen::Vector3d& extents_m);

/// Moves the table and every object into another frame. distance_m stays: the camera's height above the table.
void transform(const Eigen::Isometry3d& target_from_camera, Objects* objects);

/// Rows and columns of the two 3 x 3 halves swapped: position first becomes rotation first, and back.
std::array<double, 36> swapHalves(const std::array<double, 36>& covariance);

/// Microseconds since the epoch.
std::int64_t microsecondsOf(const ros::Time& stamp);

/// One datagram's worth: at most 64 objects with 5 alternatives each, fewer where names are long.
object_list_t toLcm(const Objects& objects);
constexpr int kMaxLcmBytes = 65000;  ///< of an encoded list; a datagram of liblcm holds 65,499 with its header

/// The points of one object, for VOXID_POINTS; at most kMaxLcmPoints of them, which fit a datagram.
object_points_t pointsOf(const DepthView& depth, const Segments& segments, const Segment& segment,
                         std::uint32_t number);
constexpr std::size_t kMaxLcmPoints = 6000;

/// The objects' points in the depth image's frame, with the colour of their id: fields x, y, z (float32, metres), rgb.
sensor_msgs::PointCloud2 cloudOf(const DepthView& depth, const Segments& segments);

/// "OK", "NO_DEPTH", ...; a number that has no name gives "UNKNOWN".
const char* statusName(std::uint8_t status);
/// One sentence for people.
const char* statusText(std::uint8_t status);

/// The same colour for the same id in overlay, markers and cloud; red, green, blue, 0 to 255.
std::array<std::uint8_t, 3> colourOf(int id);

}  // namespace voxid
