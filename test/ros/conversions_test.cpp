// SPDX-License-Identifier: BSD-3-Clause
#include "conversions.h"

#include <gtest/gtest.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include <cstring>
#include <set>
#include <vector>

#include "core/index_fixture.h"
#include "drawing.h"
#include "from_lcm.h"
#include "model_pose.h"
#include "numbered_messages.h"
#include "params.h"
#include "table_scene.h"

namespace voxid {
namespace {

using test::imageOf;
using test::infoOf;
using test::numberedModelPose;
using test::numberedObject;
using test::numberedObjects;
using test::TableScene;
using test::WallScene;

TEST(ToLcm, EveryFieldArrivesInLcmOrder) {
  const object_list_t list = toLcm(numberedObjects());
  EXPECT_EQ(list.utime, 1700000000123456);
  EXPECT_EQ(list.frame_name, "base");
  EXPECT_EQ(list.status, object_list_t::NO_INDEX + 0);
  EXPECT_EQ(list.status_text, "why");
  EXPECT_EQ(list.table_normal[2], 1);
  EXPECT_FLOAT_EQ(list.table_distance_m, 0.7f);
  ASSERT_EQ(list.num_outline, 3);
  EXPECT_EQ(list.outline_m[2], (std::vector<double>{1, 2, 0}));
  ASSERT_EQ(list.num_objects, 1);

  const object_t& o = list.objects[0];
  EXPECT_EQ(o.id, 3);
  EXPECT_EQ(o.number, 70000);
  EXPECT_EQ(o.label, "mug");
  EXPECT_EQ(o.synset, 3797390);
  EXPECT_FLOAT_EQ(o.score, 0.87f);
  EXPECT_FLOAT_EQ(o.distance, 4321);
  EXPECT_FLOAT_EQ(o.margin, 0.25f);
  ASSERT_EQ(o.num_alternatives, 5);
  EXPECT_EQ(o.alternatives[4].label, "c4");
  EXPECT_FLOAT_EQ(o.alternatives[4].score, 0.4f);
  EXPECT_FLOAT_EQ(o.alternatives[4].distance, 400);
  EXPECT_EQ(o.coarse, "container.n.01");
  EXPECT_FLOAT_EQ(o.coarse_score, 0.96f);
  EXPECT_EQ(o.model, "mug-12");
  EXPECT_EQ(o.view, 42);
  EXPECT_EQ(std::vector<double>(o.position_m, o.position_m + 3), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(std::vector<double>(o.quat_wxyz, o.quat_wxyz + 4), (std::vector<double>{0.5, -0.5, 0.5, 0.5}));
  EXPECT_EQ(o.covariance[0], 21);  // rotation x, rotation x: ROS's row 3, column 3
  EXPECT_EQ(o.covariance[1], 22);
  EXPECT_EQ(o.covariance[3], 18);   // rotation x, position x
  EXPECT_EQ(o.covariance[18], 3);   // position x, rotation x
  EXPECT_EQ(o.covariance[21], 0);   // position x, position x
  EXPECT_EQ(o.covariance[35], 14);  // position z, position z
  EXPECT_EQ(std::vector<double>(o.extents_m, o.extents_m + 3), (std::vector<double>{0.1, 0.2, 0.3}));
  EXPECT_EQ(std::vector<double>(o.centroid_m, o.centroid_m + 3), (std::vector<double>{4, 5, 6}));
  EXPECT_EQ(std::vector<int>(o.box_px, o.box_px + 4), (std::vector<int>{10, 20, 30, 40}));
  EXPECT_EQ(o.num_points, 777);
  EXPECT_EQ(o.truncated, 1);
}

TEST(ToLcm, OfAModelsPoseInLcmOrder) {
  const model_pose_t m = toLcm(numberedObjects()).objects[0].model_pose;
  EXPECT_EQ(m.status, model_pose_t::ALIGNED + 0);
  EXPECT_EQ(m.utime, 1699999999987654);
  EXPECT_NEAR(m.quat_wxyz[0], 0.8, 1e-3);
  EXPECT_NEAR(m.quat_wxyz[2], -0.5, 1e-3);
  EXPECT_EQ(m.covariance[0], 121);   // rotation x, rotation x: ROS's row 3, column 3
  EXPECT_EQ(m.covariance[3], 118);   // rotation x, position x
  EXPECT_EQ(m.covariance[35], 114);  // position z, position z
}

TEST(ToLcm, ASolidHasItsSizeAlongItsAxes) {
  const object_list_t list = toLcm(numberedObjects());
  const solid_t& can = list.objects[0].shape;
  EXPECT_EQ(can.type, solid_t::CYLINDER + 0);
  EXPECT_EQ(std::vector<double>(can.size_m, can.size_m + 3), (std::vector<double>{0.125, 0.125, 0.25}));
  EXPECT_EQ(list.table_shape.type, solid_t::BOX + 0);
  EXPECT_EQ(list.table_shape.size_m[1], 0.8);
}

/// Every field that the message has now or later: what a serialised message holds, came back.
template <typename Message>
std::vector<std::uint8_t> serialised(const Message& message) {
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

/// Over the bytes of a datagram, too.
object_list_t sent(const object_list_t& list) {
  std::vector<std::uint8_t> datagram(static_cast<std::size_t>(list.getEncodedSize()));
  list.encode(datagram.data(), 0, static_cast<int>(datagram.size()));
  object_list_t received;
  EXPECT_GT(received.decode(datagram.data(), 0, static_cast<int>(datagram.size())), 0);
  return received;
}

TEST(RoundTrip, EveryFieldComesBackFromLcm) {
  Objects objects = numberedObjects();
  objects.header.stamp = ros::Time(1700000000, 123456000);  // LCM has microseconds
  objects.objects[0].alternatives.resize(5);                // and as many alternatives
  const Objects back = test::objectsOf(sent(toLcm(objects)));
  EXPECT_EQ(back, objects);
  EXPECT_EQ(serialised(back), serialised(objects));
}

TEST(RoundTrip, EmptyFieldsToo) {
  for (Objects objects : {Objects(), numberedObjects()}) {
    objects.header.stamp = ros::Time(5);
    if (!objects.objects.empty()) objects.objects = {Object()};
    EXPECT_EQ(serialised(test::objectsOf(sent(toLcm(objects)))), serialised(objects));
  }
}

TEST(ToLcm, AlwaysFitsOneDatagram) {
  Objects objects = numberedObjects();
  objects.table.outline.assign(2000, pointOf({1, 2, 3}));
  objects.objects.assign(200, numberedObject());
  EXPECT_EQ(toLcm(objects).num_objects, 64);
  EXPECT_EQ(toLcm(objects).objects[63].num_alternatives, 5);
  EXPECT_LE(toLcm(objects).getEncodedSize(), kMaxLcmBytes);

  for (Object& object : objects.objects)
    for (Candidate& candidate : object.alternatives) candidate.label = std::string(200, 'x');
  EXPECT_EQ(toLcm(objects).num_objects, 64);  // alternatives go before objects go
  EXPECT_LT(toLcm(objects).objects[0].num_alternatives, 5);
  EXPECT_LE(toLcm(objects).getEncodedSize(), kMaxLcmBytes);

  for (Object& object : objects.objects) object.model = std::string(3000, 'm');
  EXPECT_GT(toLcm(objects).num_objects, 10);
  EXPECT_LE(toLcm(objects).getEncodedSize(), kMaxLcmBytes);
}

TEST(Points, AreInMillimetresAndFitOneDatagram) {
  WallScene wall(1050, 2, {120 * 320 + 160, 120 * 320 + 265});
  Segment& segment = wall.segments.segments[0];
  const object_points_t two = pointsOf(wall.depth, wall.segments, segment, 70000);
  EXPECT_EQ(two.utime, 5000000);
  EXPECT_EQ(two.frame_name, "camera");
  EXPECT_EQ(two.id, 2);
  EXPECT_EQ(two.number, 70000);
  ASSERT_EQ(two.num_points, 2);
  EXPECT_EQ(two.xyz_mm[1], (std::vector<std::int16_t>{422, 2, 1050}));

  segment.pixels.clear();
  for (std::uint32_t pixel = 0; pixel < 320 * 240; ++pixel) segment.pixels.push_back(pixel);
  const object_points_t many = pointsOf(wall.depth, wall.segments, segment, 0);
  EXPECT_EQ(many.num_points, 6000);
  EXPECT_LT(many.xyz_mm.front()[1], -400);
  EXPECT_GT(many.xyz_mm.back()[1], 400);
  EXPECT_LE(many.getEncodedSize(), kMaxLcmBytes);
}

TEST(FillAnswer, WhereLabelsDisagreeTheirParentIsTold) {
  const std::string top = "entity.n.01/physical_entity.n.01/object.n.01/whole.n.02/artifact.n.01/instrumentality.n.03/";
  IndexContent content = test::randomContent(2, 1, 1, 3);
  content.models[0].hypernyms = top + "container.n.01/mug.n.04";
  content.models[1].hypernyms = top + "container.n.01/box.n.01";
  test::Folder folder;
  const auto index = test::writtenIndex(folder, content);
  Answer answer;
  answer.count = 2;
  answer.known = true;
  answer.score_permille = 500;
  for (const std::uint32_t i : {0, 1}) answer.alternatives[i] = {i, i, 100, static_cast<std::uint16_t>(500 - 40 * i)};
  Object object;
  fillAnswer(answer, *index, &object);
  EXPECT_EQ(object.coarse, "container.n.01");
  EXPECT_FLOAT_EQ(object.coarse_score, 0.96f);
  EXPECT_EQ(captionOf(object), object.label + " 50 % (container?)");
}

TEST(SwapHalves, IsItsOwnInverse) {
  std::array<double, 36> m;
  for (int i = 0; i < 36; ++i) m[i] = i;
  EXPECT_NE(swapHalves(m), m);
  EXPECT_EQ(swapHalves(swapHalves(m)), m);
}

TEST(Covariance, FollowsTheBox) {
  // The box's x, 0.6 m long, lies along the frame's y.
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()));
  const auto c = covarianceOf(turned, {0.6, 0.2, 0.1});
  EXPECT_NEAR(c[0], 0.01 / 3, 1e-12);     // x: half extent 0.1
  EXPECT_NEAR(c[7], 0.09 / 3, 1e-12);     // y: half extent 0.3
  EXPECT_NEAR(c[14], 0.0025 / 3, 1e-12);  // z: half extent 0.05
  EXPECT_NEAR(c[35], M_PI * M_PI / 3, 1e-12);
  EXPECT_NEAR(c[21], std::pow(M_PI / 180, 2), 1e-12);
  EXPECT_NEAR(c[1], 0, 1e-12);
  EXPECT_EQ(c[3], 0);
}

TEST(Quaternion, XyzwWithPositiveW) {
  const geometry_msgs::Quaternion q = quaternionOf(Eigen::Quaterniond(-0.5, 0.5, -0.5, 0.5));
  EXPECT_EQ(q.w, 0.5);
  EXPECT_EQ(q.x, -0.5);
  EXPECT_EQ(q.y, 0.5);
  EXPECT_EQ(q.z, -0.5);
}

TEST(Transform, MovesTableAndObjects) {
  Objects objects = numberedObjects();
  objects.objects[0].pose.pose.orientation = quaternionOf(Eigen::Quaterniond::Identity());
  const Eigen::Isometry3d move = Eigen::Translation3d(10, 0, 0) * Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX());
  transform(move, &objects);
  EXPECT_NEAR(objects.table.normal.y, -1, 1e-12);
  EXPECT_FLOAT_EQ(objects.table.distance_m, 0.7f);
  EXPECT_NEAR(objects.table.outline[2].z, 2, 1e-12);
  const geometry_msgs::Pose& pose = objects.objects[0].pose.pose;
  EXPECT_NEAR(pose.position.x, 11, 1e-12);
  EXPECT_NEAR(pose.position.y, -3, 1e-12);
  EXPECT_NEAR(pose.position.z, 2, 1e-12);
  EXPECT_NEAR(pose.orientation.x, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(pose.orientation.w, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(objects.objects[0].centroid.y, -6, 1e-12);
  EXPECT_NEAR(objects.objects[0].shape_pose.position.y, -3.1, 1e-12);
  EXPECT_NEAR(objects.table.shape_pose.position.z, 8, 1e-12);
  EXPECT_NEAR(objects.objects[0].pose.covariance[7], 0.15 * 0.15 / 3, 1e-12);   // the box's z lies along y now
  EXPECT_NEAR(objects.objects[0].pose.covariance[28], M_PI * M_PI / 3, 1e-12);  // and so does the unknown turn
}

ModelPose foundPose() {
  Alignment alignment;
  alignment.found = true;
  alignment.pose.rotation = Eigen::AngleAxisf(float(M_PI / 2), Eigen::Vector3f::UnitZ()).toRotationMatrix();
  alignment.pose.translation = {100, 200, 900};
  alignment.pose.scale = 150;
  alignment.covariance.diagonal() << 1, 4, 9, 0.01f, 0.02f, 0.03f, 0.0004f;
  alignment.fit_mm = 1.5f;
  alignment.explained = 0.75f;
  alignment.rotation_known = false;
  alignment.free_axis = {0, 1, 0};
  const ModelSurface surface{{{-0.4f, -0.2f, -0.1f}, {0.4f, 0.2f, 0.1f}}, {}};
  Symmetry symmetry;
  symmetry.folds = {2, 0, 2};
  return modelPoseOf(alignment, surface, symmetry);
}

TEST(ModelPose, IsInMetresWithItsCovariance) {
  const ModelPose pose = foundPose();
  EXPECT_EQ(pose.status, ModelPose::ALIGNED + 0);
  EXPECT_NEAR(pose.pose.pose.position.z, 0.9, 1e-6);
  EXPECT_NEAR(pose.pose.pose.orientation.z, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(pose.pose.covariance[7], 4e-6, 1e-12);  // position y, m^2
  EXPECT_NEAR(pose.pose.covariance[35], 0.03, 1e-6);  // rotation z, rad^2
  EXPECT_NEAR(pose.scale_m, 0.15, 1e-6);
  EXPECT_NEAR(pose.scale_deviation_m, 0.15 * 0.02, 1e-6);
  EXPECT_NEAR(pose.extents_m.x, 0.8 * 0.15, 1e-6);
  EXPECT_NEAR(pose.extents_m.z, 0.2 * 0.15, 1e-6);
  EXPECT_FALSE(pose.rotation_known);
  EXPECT_EQ(pose.free_axis.y, 1);
  EXPECT_EQ(pose.symmetry[1], 0);
  EXPECT_EQ(modelPoseOf({}, {}, {}).status, ModelPose::NOT_FOUND + 0);
}

TEST(ModelPose, MovesWithItsCovarianceAndFreeAxis) {
  ModelPose pose = foundPose();
  transform(Eigen::Translation3d(0, 0, 1) * Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()), &pose);
  EXPECT_NEAR(pose.pose.pose.position.y, -0.9, 1e-6);
  EXPECT_NEAR(pose.pose.pose.position.z, 1.2, 1e-6);
  EXPECT_NEAR(pose.pose.covariance[7], 9e-6, 1e-12);  // the camera's z lies along y now
  EXPECT_NEAR(pose.pose.covariance[14], 4e-6, 1e-12);
  EXPECT_NEAR(pose.pose.covariance[28], 0.03, 1e-6);
  EXPECT_NEAR(pose.free_axis.z, 1, 1e-12);
}

TEST(ViewOf, SharesThePixels) {
  const auto image = imageOf(TableScene().depth_mm(), ros::Time(1));
  const auto depth = viewOf(*image, *infoOf(ros::Time(1)));
  ASSERT_TRUE(depth.ok()) << depth.status.sentence;
  EXPECT_EQ(depth.value.data, image->data.data());
  EXPECT_EQ(depth.value.width_px, 320);
  EXPECT_EQ(depth.value.height_px, 240);
  EXPECT_EQ(depth.value.row_bytes, 640u);
  EXPECT_EQ(depth.value.camera.fx_q16, 262.5 * 65536);
  EXPECT_EQ(depth.value.camera.cy_q16, 119.5 * 65536);
}

TEST(ViewOf, TakesMetresToo) {
  auto image = imageOf(TableScene().depth_mm(), ros::Time(1));
  std::vector<float> metres;
  for (const std::uint16_t mm : TableScene().depth_mm()) metres.push_back(mm / 1000.0f);
  image->encoding = "32FC1";
  image->step = 320 * 4;
  image->data.resize(metres.size() * 4);
  std::memcpy(image->data.data(), metres.data(), image->data.size());
  const auto depth = viewOf(*image, *infoOf(ros::Time(1)));
  ASSERT_TRUE(depth.ok());
  EXPECT_NEAR(depth.value.depthUm(160, 120), TableScene().depth_mm()[120 * 320 + 160] * 1000, 1);
}

TEST(ViewOf, RefusesWithOneSentence) {
  const auto refused = [](auto spoil) {
    const auto image = imageOf(TableScene().depth_mm(), ros::Time(1));
    const auto info = infoOf(ros::Time(1));
    spoil(*image, *info);
    const auto depth = viewOf(*image, *info);
    EXPECT_FALSE(depth.ok());
    return depth.status.sentence;
  };
  using sensor_msgs::CameraInfo;
  using sensor_msgs::Image;
  const auto has = [](const std::string& sentence, const std::string& part) {
    return sentence.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(refused([](Image& i, CameraInfo&) { i.encoding = "bgr8"; }), "encoding 'bgr8', expected 16UC1"));
  EXPECT_TRUE(has(refused([](Image& i, CameraInfo&) { i.is_bigendian = 1; }), "big-endian"));
  EXPECT_TRUE(has(refused([](Image& i, CameraInfo&) { i.data.resize(100); }), "has 100 bytes"));
  EXPECT_TRUE(has(refused([](Image& i, CameraInfo&) { i.step = 319; }), "rows of 319"));
  EXPECT_TRUE(has(refused([](Image&, CameraInfo& c) { c.width = 640; }),
                  "camera_info is for 640 x 240, the depth image is 320 x 240"));
  EXPECT_TRUE(
      has(refused([](Image&, CameraInfo& c) { c.K[0] = 0; }), "no usable focal length or centre (K has fx 0, "));
  EXPECT_TRUE(has(refused([](Image&, CameraInfo& c) { c.K[5] = NAN; }), "cy nan"));
  for (const bool columns : {false, true}) {
    const auto empty = [columns](Image& i, CameraInfo& c) {
      (columns ? i.width : i.height) = (columns ? c.width : c.height) = 0;
    };
    EXPECT_TRUE(has(refused(empty), columns ? "of 0 x 240 has no pixels" : "of 320 x 0 has no pixels"));
  }
}

TEST(Status, NamesAndSentences) {
  EXPECT_STREQ(statusName(Objects::OK), "OK");
  EXPECT_STREQ(statusName(Objects::NO_DEPTH), "NO_DEPTH");
  EXPECT_STREQ(statusName(Objects::NO_TABLE), "NO_TABLE");
  EXPECT_STREQ(statusName(Objects::EMPTY_TABLE), "EMPTY_TABLE");
  EXPECT_STREQ(statusName(Objects::NO_TRANSFORM), "NO_TRANSFORM");
  EXPECT_STREQ(statusName(Objects::NO_INDEX), "NO_INDEX");
  EXPECT_STREQ(statusName(Objects::BAD_INPUT), "BAD_INPUT");
  EXPECT_STREQ(statusName(7), "UNKNOWN");
  std::set<std::string> sentences;
  for (std::uint8_t status = 0; status <= 7; ++status) sentences.insert(statusText(status));
  EXPECT_EQ(sentences.size(), 8u);
}

TEST(Fit, PixelsMustLieInTheImage) {
  const auto image = imageOf(TableScene().depth_mm(), ros::Time(1));
  const DepthView depth = viewOf(*image, *infoOf(ros::Time(1))).value;
  Segments segments;
  segments.width = 320;
  segments.height = 240;
  segments.segments.resize(1);
  segments.segments[0].pixels = {0, 320 * 240 - 1};
  EXPECT_TRUE(fit(segments, depth));
  segments.segments[0].pixels.push_back(320 * 240);
  EXPECT_FALSE(fit(segments, depth));
  segments.segments.clear();
  segments.width = 640;
  EXPECT_FALSE(fit(segments, depth));
}

TEST(Cloud, HasThePointsInMetresWithTheirColour) {
  const WallScene wall(1050, 2, {120 * 320 + 160, 120 * 320 + 265});
  const sensor_msgs::PointCloud2 cloud = cloudOf(wall.depth, wall.segments);
  EXPECT_EQ(cloud.header.frame_id, "camera");
  EXPECT_EQ(cloud.header.stamp, ros::Time(5));
  ASSERT_EQ(cloud.width * cloud.height, 2u);
  sensor_msgs::PointCloud2ConstIterator<float> xyz(cloud, "x");
  sensor_msgs::PointCloud2ConstIterator<std::uint8_t> bgr(cloud, "rgb");
  ++xyz;
  EXPECT_NEAR(xyz[0], (265 - 159.5) / 262.5 * 1.05, 2e-6);
  EXPECT_NEAR(xyz[1], 0.5 / 262.5 * 1.05, 2e-6);
  EXPECT_NEAR(xyz[2], 1.05, 1e-6);
  EXPECT_EQ(bgr[2], colourOf(2)[0]);
  EXPECT_EQ(bgr[0], colourOf(2)[2]);
}

TEST(Params, ReconfigurableDefaultsAreTheLibrarys) {
  const SegmentParams p = paramsOf(SegmentationConfig::__getDefault__());
  EXPECT_EQ(p.min_depth_mm, SegmentParams().min_depth_mm);
  EXPECT_EQ(p.max_clusters, SegmentParams().max_clusters);
  EXPECT_EQ(paramsOf(ClassificationConfig::__getDefault__()).radius_bits, ClassifyParams().radius_bits);
}

}  // namespace
}  // namespace voxid
