// SPDX-License-Identifier: BSD-3-Clause
// The nodelets in the test's own process, as in one manager: what goes in, what comes out, and by which pointers.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <map>
#include <mutex>
#include <set>
#include <type_traits>

#include "chain_fixture.h"
#include "clouds.h"
#include "core/index_fixture.h"
#include "core/projection_fixture.h"
#include "scene_index.h"

namespace voxid {
namespace {

using test::Chain;
using test::eventually;
using test::imageOf;
using test::infoOf;
using test::Listener;
using test::TableScene;

/// Classification that tells where the depth image lay that it was given.
class SpyClassification : public ClassificationNodelet {
 public:
  static std::map<ros::Time, const void*> received;
  static std::mutex mutex;

 protected:
  void onFrame(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info,
               const SegmentsConstPtr& segments) override {
    {
      const std::lock_guard<std::mutex> lock(mutex);
      received[image->header.stamp] = image->data.data();
    }
    ClassificationNodelet::onFrame(image, info, segments);
  }
};
std::map<ros::Time, const void*> SpyClassification::received;
std::mutex SpyClassification::mutex;

const Object* labelled(const Objects& objects, const std::string& label) {
  for (const Object& object : objects.objects)
    if (object.label == label) return &object;
  return nullptr;
}

TEST_F(Chain, NamesTheThingsOnTheTable) {
  test::writeSceneIndex(index_path_);
  start();
  const TableScene scene;
  const ObjectsConstPtr objects = objectsFor(scene.depth_mm());
  ASSERT_TRUE(objects);
  EXPECT_EQ(objects->header.stamp, sent_->header.stamp);
  EXPECT_EQ(objects->header.frame_id, "camera");
  EXPECT_EQ(objects->camera_frame, "camera");
  EXPECT_EQ(objects->status, Objects::OK + 0) << objects->status_text;
  EXPECT_EQ(objects->index, index_path_.string());
  EXPECT_EQ(objects->dropped.size(), 3u);
  EXPECT_NEAR(objects->table.distance_m, scene.height_m, 0.005);
  const Eigen::Vector3d up = scene.tableFromCamera().linear().transpose() * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(eigenOf(objects->table.normal).dot(up), 1, 1e-3);
  EXPECT_GE(objects->table.outline.size(), 3u);
  EXPECT_GT(objects->segment_ms, 0);
  EXPECT_GT(objects->classify_ms, 0);
  EXPECT_GT(objects->latency_ms, objects->segment_ms);
  ASSERT_EQ(objects->objects.size(), 2u);

  const Object* box = labelled(*objects, "box");
  ASSERT_TRUE(box);
  EXPECT_EQ(box->model, "box-7");
  EXPECT_EQ(box->view, 1);
  EXPECT_EQ(box->synset, 2883344u);
  EXPECT_EQ(box->distance, 0);
  EXPECT_EQ(box->margin, 1);
  EXPECT_GT(box->score, 0.5);
  ASSERT_EQ(box->alternatives.size(), 2u);
  EXPECT_EQ(box->alternatives[1].label, "ball");
  EXPECT_GT(box->alternatives[1].distance, 0);
  EXPECT_FALSE(box->truncated);
  EXPECT_GT(box->points, 500u);
  const Eigen::Vector3d centre = scene.inCamera(scene.boxes[0].centre_m);
  EXPECT_LT((eigenOf(box->pose.pose.position) - centre).norm(), 0.02);
  EXPECT_NEAR(box->extents_m.z, 0.12, 0.01);
  EXPECT_NEAR((eigenOf(box->pose.pose.orientation) * Eigen::Vector3d::UnitZ()).dot(up), 1, 1e-3);
  EXPECT_NEAR(box->pose.covariance[0] + box->pose.covariance[7] + box->pose.covariance[14],
              eigenOf(box->extents_m).squaredNorm() / 12, 1e-6);
  ASSERT_EQ(box->shape.type, shape_msgs::SolidPrimitive::BOX + 0);
  EXPECT_NEAR(box->shape.dimensions[2], 0.12, 0.01);
  EXPECT_LT((eigenOf(box->shape_pose.position) - centre).norm(), 0.02);
  EXPECT_EQ(box->model_pose.status, ModelPose::OFF + 0);
  ASSERT_EQ(objects->table.shape.type, shape_msgs::SolidPrimitive::BOX + 0);
  EXPECT_NEAR(objects->table.shape.dimensions[1], 0.9, 0.03);
  const Eigen::Vector3d above = scene.inCamera({0, scene.table_centre_y_m, -kTableThickness_m / 2});
  EXPECT_LT((eigenOf(objects->table.shape_pose.position) - above).norm(), 0.03);
  const double u = centre.x() / centre.z() * TableScene::kFocal_px + TableScene::kCx_px;
  EXPECT_NEAR(box->box.x_offset + box->box.width / 2.0, u, 6);

  const Object* ball = labelled(*objects, "ball");
  ASSERT_TRUE(ball);
  EXPECT_EQ(ball->distance, 0);
  EXPECT_LT((eigenOf(ball->pose.pose.position) - scene.inCamera(scene.balls[0].centre_m)).norm(), 0.03);
}

TEST_F(Chain, AnObjectKeepsItsNumberAndAMovedOneHasANewOne) {
  test::writeSceneIndex(index_path_);
  start();
  TableScene scene;
  const ObjectsConstPtr first = objectsFor(scene.depth_mm());
  ASSERT_TRUE(first && first->objects.size() == 2);
  scene.balls[0].centre_m.x() += 0.1;
  const ObjectsConstPtr second = objectsFor(scene.depth_mm());
  ASSERT_TRUE(second && second->objects.size() == 2);
  std::vector<std::uint32_t> before, after;
  for (const Object& object : first->objects) before.push_back(object.number);
  for (const Object& object : second->objects) after.push_back(object.number);
  std::sort(before.begin(), before.end());
  std::sort(after.begin(), after.end());
  EXPECT_EQ(before, (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(after[1], 3u);
  EXPECT_TRUE(after[0] == 1 || after[0] == 2) << "the box, which rested";
}

TEST_F(Chain, DepthIsNotCopiedOnItsWayToClassification) {
  start();
  const ObjectsConstPtr objects = objectsFor(TableScene().depth_mm());
  ASSERT_TRUE(objects);
  const std::lock_guard<std::mutex> lock(SpyClassification::mutex);
  EXPECT_EQ(SpyClassification::received[objects->header.stamp], sent_->data.data());
}

// That the test above can fail: a message published by value is written out and read back.
TEST_F(Chain, APublishedValueIsACopy) {
  start();
  Listener<Objects> listener(node_, "objects");
  ASSERT_TRUE(answerTo(TableScene().depth_mm(), listener));
  const ros::Time stamp = ros::Time::now();
  const sensor_msgs::ImagePtr image = imageOf(TableScene().depth_mm(), stamp);
  image_.publish(*image);
  info_.publish(infoOf(stamp));
  ASSERT_TRUE(listener.wait(stamp, 5));
  const std::lock_guard<std::mutex> lock(SpyClassification::mutex);
  EXPECT_NE(SpyClassification::received[stamp], image->data.data());
}

TEST_F(Chain, NothingIsDoneWithoutListeners) {
  start();
  EXPECT_EQ(image_.getNumSubscribers(), 0u);
  {
    Listener<Objects> listener(node_, "objects");
    EXPECT_TRUE(answerTo(TableScene().depth_mm(), listener));
    EXPECT_GT(image_.getNumSubscribers(), 0u);
  }
  EXPECT_TRUE(eventually(5, [&] { return image_.getNumSubscribers() == 0 && info_.getNumSubscribers() == 0; }));
}

TEST_F(Chain, WithoutIndexObjectsAreFoundAndNotNamed) {
  start();
  const ObjectsConstPtr objects = objectsFor(TableScene().depth_mm());
  ASSERT_TRUE(objects);
  EXPECT_EQ(objects->status, Objects::NO_INDEX + 0);
  EXPECT_NE(objects->status_text.find(index_path_.string()), std::string::npos) << objects->status_text;
  ASSERT_EQ(objects->objects.size(), 2u);
  EXPECT_EQ(objects->objects[0].label, "");
  EXPECT_TRUE(objects->objects[0].alternatives.empty());
  EXPECT_GT(objects->objects[0].extents_m.z, 0.05);
  EXPECT_EQ(objects->index, "");
}

TEST_F(Chain, IndexMayAppearAndBeReplacedWhileFramesCome) {
  start();
  Listener<Objects> listener(node_, "objects");
  const std::vector<std::uint16_t> depth_mm = TableScene().depth_mm();
  ObjectsConstPtr objects = answerTo(depth_mm, listener);
  ASSERT_TRUE(objects);
  EXPECT_EQ(objects->status, Objects::NO_INDEX + 0);

  test::writeSceneIndex(index_path_);
  const auto sees = [&](const std::string& label) {
    return [&, label] {
      objects = listener.wait(show(depth_mm), 0.5);
      return objects && labelled(*objects, label);
    };
  };
  EXPECT_TRUE(eventually(5, sees("box")));
  test::writeSceneIndex(index_path_, "carton");
  EXPECT_TRUE(eventually(5, sees("carton")));

  // Damage is not taken over: the index that was there answers on.
  std::filesystem::remove(index_path_);
  std::fclose(std::fopen(index_path_.c_str(), "w"));
  ros::WallDuration(1.2).sleep();
  EXPECT_TRUE(sees("carton")());
}

TEST_F(Chain, SaysWhyThereIsNothing) {
  start();
  Listener<Objects> listener(node_, "objects");
  TableScene bare;
  bare.boxes.clear();
  bare.balls.clear();
  const ObjectsConstPtr empty = answerTo(bare.depth_mm(), listener);
  ASSERT_TRUE(empty);
  EXPECT_EQ(empty->status, Objects::EMPTY_TABLE + 0);
  EXPECT_NEAR(empty->table.distance_m, bare.height_m, 0.005);

  const ObjectsConstPtr dark = answerTo(std::vector<std::uint16_t>(320 * 240, 0), listener);
  ASSERT_TRUE(dark);
  EXPECT_EQ(dark->status, Objects::NO_DEPTH + 0);
  EXPECT_EQ(dark->status_text, statusText(Objects::NO_DEPTH));
  EXPECT_TRUE(dark->table.outline.empty());

  std::vector<std::uint16_t> crumbs(320 * 240, 0);
  for (int i = 0; i < 50; ++i) crumbs[i * 1201] = 700 + 9 * i;
  const ObjectsConstPtr none = answerTo(crumbs, listener);
  ASSERT_TRUE(none);
  EXPECT_EQ(none->status, Objects::NO_TABLE + 0);
}

TEST_F(Chain, WrongEncodingIsBadInputWithTheReason) {
  start();
  Listener<Objects> listener(node_, "objects");
  ObjectsConstPtr objects;
  eventually(10, [&] {
    const ros::Time stamp = ros::Time::now();
    const auto image = imageOf(TableScene().depth_mm(), stamp);
    image->encoding = "8UC2";
    image_.publish(image);
    info_.publish(infoOf(stamp));
    return (objects = listener.wait(stamp, 0.5)) != nullptr;
  });
  ASSERT_TRUE(objects);
  EXPECT_EQ(objects->status, Objects::BAD_INPUT + 0);
  EXPECT_NE(objects->status_text.find("encoding '8UC2', expected 16UC1"), std::string::npos) << objects->status_text;
  EXPECT_TRUE(objects->objects.empty());
}

TEST_F(Chain, PosesGoIntoTheTargetFrame) {
  node_.setParam("classification/target_frame", "table");
  test::writeSceneIndex(index_path_);
  start();
  Listener<Objects> listener(node_, "objects");
  const TableScene scene;
  ObjectsConstPtr objects = answerTo(scene.depth_mm(), listener);
  ASSERT_TRUE(objects);
  EXPECT_EQ(objects->status, Objects::NO_TRANSFORM + 0);
  EXPECT_EQ(objects->header.frame_id, "camera");
  EXPECT_TRUE(labelled(*objects, "box"));

  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = "table";
  transform.child_frame_id = "camera";
  const Eigen::Isometry3d pose = scene.tableFromCamera();
  transform.transform.translation = vectorOf(pose.translation());
  transform.transform.rotation = quaternionOf(Eigen::Quaterniond(pose.rotation()));
  tf2_ros::StaticTransformBroadcaster broadcaster;
  broadcaster.sendTransform(transform);
  EXPECT_TRUE(eventually(5, [&] {
    objects = listener.wait(show(scene.depth_mm()), 0.5);
    return objects && objects->status == Objects::OK;
  }));
  ASSERT_TRUE(objects);
  EXPECT_EQ(objects->header.frame_id, "table");
  EXPECT_EQ(objects->camera_frame, "camera");
  EXPECT_NEAR(objects->table.normal.z, 1, 1e-3);
  for (const geometry_msgs::Point& corner : objects->table.outline) EXPECT_NEAR(corner.z, 0, 0.01);
  const Object* box = labelled(*objects, "box");
  ASSERT_TRUE(box);
  EXPECT_LT((eigenOf(box->pose.pose.position) - scene.boxes[0].centre_m).norm(), 0.02);
  EXPECT_NEAR(box->pose.covariance[35], M_PI * M_PI / 3, 0.01);
}

TEST_F(Chain, MarkersOverlayAndCloudForPeople) {
  test::writeSceneIndex(index_path_);
  start();
  const std::vector<std::uint16_t> depth_mm = TableScene().depth_mm();
  Listener<sensor_msgs::Image> overlays(node_, "overlay/image_raw");
  Listener<sensor_msgs::PointCloud2> clouds(node_, "cloud");
  std::mutex mutex;
  visualization_msgs::MarkerArrayConstPtr markers;
  const ros::Subscriber subscriber = node_.subscribe<visualization_msgs::MarkerArray>(
      "markers", 5, [&](const visualization_msgs::MarkerArrayConstPtr& heard) {
        const std::lock_guard<std::mutex> lock(mutex);
        markers = heard;
      });
  const auto overlay = answerTo(depth_mm, overlays);
  ASSERT_TRUE(overlay);
  EXPECT_EQ(overlay->encoding, "bgr8");
  EXPECT_EQ(overlay->width, 320u);
  EXPECT_EQ(overlay->header.frame_id, "camera");
  const auto cloud = answerTo(depth_mm, clouds);
  ASSERT_TRUE(cloud);
  EXPECT_GT(cloud->width, 1000u);
  const auto arrived = [&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return markers != nullptr;
  };
  ASSERT_TRUE(eventually(5, arrived));
  std::vector<std::string> texts;
  const std::lock_guard<std::mutex> lock(mutex);
  for (const auto& marker : markers->markers)
    if (marker.ns == "label") texts.push_back(marker.text.substr(0, marker.text.find(' ')));
  std::sort(texts.begin(), texts.end());
  EXPECT_EQ(texts, (std::vector<std::string>{"ball", "box"}));
}

/// Everything that the nodelets say of themselves, by name of nodelet and key.
class Diagnostics {
 public:
  explicit Diagnostics(const std::string& ns) : prefix_(ns.substr(1) + "/") {
    subscriber_ = node_.subscribe("/diagnostics", 50, &Diagnostics::on, this);
  }
  std::string value(const std::string& nodelet, const std::string& key) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return values_[prefix_ + nodelet + ": frames"][key];
  }
  bool becomes(const std::string& nodelet, const std::string& key, const std::string& part) {
    return eventually(5, [&] { return value(nodelet, key).find(part) != std::string::npos; });
  }

 private:
  void on(const diagnostic_msgs::DiagnosticArrayConstPtr& array) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const auto& status : array->status) {
      values_[status.name]["message"] = status.message;
      for (const auto& pair : status.values) values_[status.name][pair.key] = pair.value;
    }
  }
  const std::string prefix_;
  std::mutex mutex_;
  std::map<std::string, std::map<std::string, std::string>> values_;
  ros::NodeHandle node_;
  ros::Subscriber subscriber_;
};

TEST_F(Chain, AnOrganisedCloudStandsInForADepthImage) {
  test::writeSceneIndex(index_path_);
  image_.shutdown();  // the cloud's own
  info_.shutdown();
  start();
  ASSERT_TRUE(loader_.load(name_ + "/points", "voxid/points", {}, {}));
  Diagnostics diagnostics(name_);
  ros::Publisher points = node_.advertise<sensor_msgs::PointCloud2>("points", 4);
  Listener<Objects> listener(node_, "objects");
  ObjectsConstPtr objects;
  ASSERT_TRUE(eventually(10, [&] {
    const ros::Time stamp = ros::Time::now();
    points.publish(test::organisedCloud(TableScene().depth_mm(), stamp));
    return (objects = listener.wait(stamp, 0.5)) != nullptr;
  }));
  EXPECT_EQ(objects->status, Objects::OK + 0) << objects->status_text;
  EXPECT_EQ(objects->header.frame_id, "camera");
  EXPECT_TRUE(labelled(*objects, "box"));
  EXPECT_TRUE(labelled(*objects, "ball"));

  const auto unorganised = test::organisedCloud(TableScene().depth_mm(), ros::Time::now());
  unorganised->width *= unorganised->height;
  unorganised->row_step *= unorganised->height;
  unorganised->height = 1;
  points.publish(unorganised);
  EXPECT_TRUE(diagnostics.becomes("points", "message", "the cloud is not organised"))
      << diagnostics.value("points", "message");
  EXPECT_TRUE(diagnostics.becomes("points", "refused_clouds", "1"));
}

TEST_F(Chain, DebugCloudsShowTableAndWhatStandsOnIt) {
  node_.setParam("segmentation/debug", true);
  start();
  const TableScene scene;
  Listener<sensor_msgs::PointCloud2> tables(node_, "debug/table"), above(node_, "debug/above_table"),
      clusters(node_, "debug/clusters");
  const auto heights = [&](const sensor_msgs::PointCloud2ConstPtr& cloud) {
    std::vector<double> heights_m;
    for (sensor_msgs::PointCloud2ConstIterator<float> p(*cloud, "x"); p != p.end(); ++p)
      heights_m.push_back((scene.tableFromCamera() * Eigen::Vector3d(p[0], p[1], p[2])).z());
    std::sort(heights_m.begin(), heights_m.end());
    return heights_m;
  };
  const auto table = answerTo(scene.depth_mm(), tables);
  ASSERT_TRUE(table);
  ASSERT_GT(table->width, 20000u);
  EXPECT_GT(heights(table).front(), -0.008);
  EXPECT_LT(heights(table).back(), 0.008);
  const auto things = answerTo(scene.depth_mm(), above);
  ASSERT_TRUE(things);
  ASSERT_GT(things->width, 2000u);
  EXPECT_GT(heights(things).front(), 0.004);
  EXPECT_NEAR(heights(things).back(), 0.12, 0.01);
  const auto coloured = answerTo(scene.depth_mm(), clusters);
  ASSERT_TRUE(coloured);
  std::set<std::array<std::uint8_t, 3>> colours;
  for (sensor_msgs::PointCloud2ConstIterator<std::uint8_t> c(*coloured, "rgb"); c != c.end(); ++c)
    colours.insert({c[2], c[1], c[0]});
  EXPECT_EQ(colours, (std::set<std::array<std::uint8_t, 3>>{colourOf(1), colourOf(2)}));
}

TEST_F(Chain, DebugCloudsAreNotThereUnlessAskedFor) {
  start();
  ros::master::V_TopicInfo topics;
  ASSERT_TRUE(ros::master::getTopics(topics));
  for (const auto& topic : topics) EXPECT_EQ(topic.name.find(name_ + "/debug"), std::string::npos) << topic.name;
}

TEST_F(Chain, DiagnosticsCountWhatWasDroppedAndWhy) {
  start();
  Diagnostics diagnostics(name_);
  Listener<Segments> segmented(node_, "segments");
  Listener<Objects> listener(node_, "objects");
  TableScene scene;
  scene.boxes.push_back({{0.0, 0.62, 0.006}, {0.012, 0.012, 0.012}});  // a crumb
  const ObjectsConstPtr objects = answerTo(scene.depth_mm(), listener);
  ASSERT_TRUE(objects);
  ASSERT_GE(objects->dropped[0], 1u);
  const SegmentsConstPtr segments = segmented.wait(objects->header.stamp, 5);
  ASSERT_TRUE(segments);
  ASSERT_EQ(segments->dropped_clusters.size(), objects->dropped[0]);
  EXPECT_EQ(segments->dropped_clusters[0].cause, 0u);
  EXPECT_GT(segments->dropped_clusters[0].points, 5u);
  const Eigen::Vector3d crumb = scene.inCamera(scene.boxes.back().centre_m);
  const double u = crumb.x() / crumb.z() * TableScene::kFocal_px + TableScene::kCx_px;
  EXPECT_TRUE(std::any_of(
      segments->dropped_clusters.begin(), segments->dropped_clusters.end(),
      [&](const auto& cluster) { return std::abs(cluster.box.x_offset + cluster.box.width / 2.0 - u) < 3; }));
  ASSERT_TRUE(listener.wait(show(std::vector<std::uint16_t>(320 * 240, 0)), 5));
  EXPECT_TRUE(diagnostics.becomes("segmentation", "frames_NO_DEPTH", "1"));
  const int ok = std::stoi(diagnostics.value("segmentation", "frames_OK"));
  EXPECT_EQ(std::stoi(diagnostics.value("segmentation", "clusters_too_few_points")),
            ok * static_cast<int>(objects->dropped[0]));
  EXPECT_EQ(diagnostics.value("segmentation", "clusters_too_many"), "0");
  EXPECT_TRUE(diagnostics.becomes("classification", "frames_NO_INDEX", "1"));
}

/// Sets a parameter of a nodelet as `rosrun dynamic_reconfigure dynparam` does.
void reconfigure(const std::string& nodelet, const std::string& name, bool boolean, int value) {
  dynamic_reconfigure::Reconfigure change;
  if (boolean) {
    change.request.config.bools.resize(1);
    change.request.config.bools[0].name = name;
    change.request.config.bools[0].value = static_cast<std::uint8_t>(value);
  } else {
    change.request.config.ints.resize(1);
    change.request.config.ints[0].name = name;
    change.request.config.ints[0].value = value;
  }
  ASSERT_TRUE(ros::service::call(nodelet + "/set_parameters", change)) << name;
}

/// A name, whether it is a bool, and one of its limits.
struct Setting {
  std::string name;
  bool boolean;
  int value, usual;
};
template <typename Params>
std::vector<Setting> settingsOf() {
  std::vector<Setting> settings;
  Params params;
  visitParams(params, [&](const char* name, auto& value, auto least, auto most) {
    const bool boolean = std::is_same_v<std::decay_t<decltype(value)>, bool>;
    for (const int limit : {static_cast<int>(least), static_cast<int>(most)})
      if (limit != static_cast<int>(value)) settings.push_back({name, boolean, limit, static_cast<int>(value)});
  });
  return settings;
}
template <typename Params>
Params with(const Setting& setting) {
  Params params;
  visitParams(params, [&](const char* name, auto& value, auto, auto) {
    if (name == setting.name) value = static_cast<std::decay_t<decltype(value)>>(setting.value);
  });
  return params;
}

template <typename Params>
std::set<std::string> namesOf() {
  std::set<std::string> names;
  Params params;
  visitParams(params, [&](const char* name, auto&, auto, auto) { names.insert(name); });
  return names;
}

/// A few millimetres of noise, the same in each run.
std::vector<std::uint16_t> noisy(std::vector<std::uint16_t> depth_mm) {
  std::uint32_t random = 1;
  for (std::uint16_t& depth : depth_mm) {
    random = random * 1664525u + 1013904223u;
    if (depth > 0) depth = static_cast<std::uint16_t>(depth + (random >> 28) % 7 - 3);
  }
  return depth_mm;
}

/// Things apart from each other.
std::vector<std::uint16_t> scatteredThings() {
  TableScene scene;
  scene.boxes.push_back({{0.0, 0.80, 0.01}, {0.10, 0.08, 0.02}});
  scene.boxes.push_back({{-0.10, 0.62, 0.03}, {0.05, 0.06, 0.06}});
  return scene.depth_mm();
}

/// Cut by a nearer one, stacked, side by side, and beyond the table's edge; stripes without depth.
std::vector<std::uint16_t> crowdedThings() {
  TableScene scene;
  scene.boxes = {{{0, 0.90, 0.05}, {0.5, 0.06, 0.10}},     {{0, 0.62, 0.10}, {0.06, 0.06, 0.20}},
                 {{-0.2, 0.66, 0.04}, {0.10, 0.10, 0.08}}, {{-0.2, 0.66, 0.11}, {0.05, 0.05, 0.06}},
                 {{0.3, 0.60, 0.03}, {0.10, 0.06, 0.06}},  {{0.3, 0.64, 0.034}, {0.10, 0.02, 0.068}},
                 {{0.47, 0.75, 0.05}, {0.08, 0.08, 0.10}}};
  scene.balls = {{{0.22, 0.80, 0.06}, 0.06}};
  std::vector<std::uint16_t> depth_mm = noisy(scene.depth_mm());
  for (std::size_t i = 0; i < depth_mm.size(); ++i) {
    const std::size_t column = i % TableScene::kWidth;
    if (column % 40 >= 30 && column % 40 < 34) depth_mm[i] = 0;
  }
  return depth_mm;
}

/// Boxes in two rows that leave little of a small table.
std::vector<std::uint16_t> coveredTable(int boxes) {
  TableScene scene;
  scene.table_half_m = 0.3;
  scene.balls.clear();
  scene.boxes.clear();
  for (int i = 0; i < boxes; ++i) {
    const double height_m = 0.04 + 0.02 * (i % 5);
    scene.boxes.push_back({{-0.2 + 0.1 * (i % 5), 0.58 + 0.14 * (i / 5), height_m / 2}, {0.09, 0.11, height_m}});
  }
  return noisy(scene.depth_mm());
}

bool differ(const Segments& a, const Segments& b) {
  return a.status != b.status || a.valid_pixels != b.valid_pixels || a.table != b.table || a.segments != b.segments ||
         a.dropped != b.dropped;
}

TEST_F(Chain, EveryParameterOfTheSegmentationWorksInTheNextFrame) {
  start();
  Listener<Segments> listener(node_, "segments");
  Segmenter segmenter;
  const auto segmented = [&](const SegmentParams& params) {
    Segments segments;
    fillSegments(segmenter.segment(viewOf(*sent_, *infoOf(ros::Time(1))).value, params), 320, 240, &segments);
    return segments;
  };
  std::set<std::string> seen;  // in a scene that shows a difference
  for (const auto& depth_mm : {scatteredThings(), crowdedThings(), coveredTable(6), coveredTable(10)}) {
    ASSERT_TRUE(answerTo(depth_mm, listener));
    const Segments usual = segmented({});
    for (const Setting& setting : settingsOf<SegmentParams>()) {
      const Segments expected = segmented(with<SegmentParams>(setting));
      if (seen.count(setting.name) || !differ(expected, usual)) continue;
      reconfigure(name_ + "/segmentation", setting.name, setting.boolean, setting.value);
      const SegmentsConstPtr heard = listener.wait(show(depth_mm), 5);
      ASSERT_TRUE(heard) << setting.name;
      EXPECT_FALSE(differ(*heard, expected)) << setting.name << " = " << setting.value;
      seen.insert(setting.name);
      reconfigure(name_ + "/segmentation", setting.name, setting.boolean, setting.usual);
      const SegmentsConstPtr again = listener.wait(show(depth_mm), 5);
      ASSERT_TRUE(again) << setting.name;
      EXPECT_FALSE(differ(*again, usual)) << setting.name << " = " << setting.usual;
    }
  }
  EXPECT_EQ(seen, namesOf<SegmentParams>());
}

/// Threads of this process.
int threads() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return static_cast<int>(std::distance(begin(tasks), end(tasks)));
}

/// Of each parameter both limits; those that made a difference in the next frame.
class ClassificationSettings : public Chain {
 protected:
  std::set<std::string> seen() {
    node_.setParam("classification/memory", false);  // each frame by itself
    start();
    const std::shared_ptr<const Index> index = Index::open(index_path_).value;
    std::set<std::string> seen;
    const Listener<Objects>::Ptr first = answerTo(scene_, objects_);
    if (!first) return seen;
    const int threads_before = threads();
    for (const Setting& setting : settingsOf<ClassifyParams>()) {
      reconfigure(name_ + "/classification", setting.name, setting.boolean, setting.value);
      const ObjectsConstPtr heard = objects_.wait(show(scene_), 5);
      if (!heard) return {};
      const std::vector<Object> expected = answers(index, with<ClassifyParams>(setting));
      expectSame(*heard, expected, setting.name + " = " + std::to_string(setting.value));
      if (differ(expected, answers(index, {})) || threads() != threads_before) seen.insert(setting.name);
      if (setting.name == "threads") {
        EXPECT_EQ(threads(), threads_before + setting.value - setting.usual);
      }
      reconfigure(name_ + "/classification", setting.name, setting.boolean, setting.usual);
      if (!objects_.wait(show(scene_), 5)) return {};
    }
    return seen;
  }

 private:
  std::vector<Object> answers(const std::shared_ptr<const Index>& index, const ClassifyParams& params) {
    const DepthView depth = viewOf(*sent_, *infoOf(ros::Time(1))).value;
    Recogniser recogniser(index);
    std::vector<Object> objects;
    for (const Cluster& cluster : segmenter_.segment(depth, {}).clusters) {
      objects.emplace_back();
      fillAnswer(recogniser.recognise(depth, cluster.pixels, params), *index, &objects.back());
    }
    return objects;
  }
  static bool differ(const std::vector<Object>& a, const std::vector<Object>& b) {
    return !std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Object& p, const Object& q) {
      return p.label == q.label && p.score == q.score && p.alternatives == q.alternatives;
    });
  }
  static void expectSame(const Objects& heard, const std::vector<Object>& expected, const std::string& setting) {
    EXPECT_FALSE(differ(heard.objects, expected)) << setting;
  }

  const std::vector<std::uint16_t> scene_ = TableScene().depth_mm();
  Segmenter segmenter_;
  Listener<Objects> objects_{node_, "objects"};
};

TEST_F(ClassificationSettings, WorkInTheNextFrameByTheKeysOfThePapersDescriptor) {
  ASSERT_TRUE(writeIndex(test::randomContent(12, 3, 4, 5), index_path_).ok());
  EXPECT_EQ(seen(), (std::set<std::string>{"exact", "min_score_permille", "radius_bits", "threads", "vote"}));
}

TEST_F(ClassificationSettings, WorkInTheNextFrameByTheListsOfTheDefault) {
  constexpr std::uint32_t kBytes = 32;
  IndexContent content = test::randomContent(12, 3, 4, 5);
  content.profile = {{}, test::projectionOf(test::randomProjectionContent(kBytes, 200, 1))};
  test::Random random(3);
  for (ModelRecord& model : content.models) {
    for (ViewRecord& view : model.views) {
      view.code.resize(kBytes);
      for (std::uint8_t& number : view.code) number = static_cast<std::uint8_t>(random.between(-60, 60));
    }
  }
  ASSERT_TRUE(writeIndex(content, index_path_).ok());
  EXPECT_EQ(seen(), (std::set<std::string>{"exact", "lists", "min_score_permille", "threads", "vote"}));
}

TEST_F(Chain, DiagnosticsSayTheState) {
  start();
  std::mutex mutex;
  std::map<std::string, diagnostic_msgs::DiagnosticStatus> heard;
  const ros::Subscriber subscriber = node_.subscribe<diagnostic_msgs::DiagnosticArray>(
      "/diagnostics", 50, [&](const diagnostic_msgs::DiagnosticArrayConstPtr& array) {
        const std::lock_guard<std::mutex> lock(mutex);
        for (const auto& status : array->status) heard[status.name] = status;
      });
  const auto says = [&](const std::string& nodelet, const std::string& part) {
    return eventually(5, [&, nodelet, part] {
      const std::lock_guard<std::mutex> lock(mutex);
      return heard[name_.substr(1) + "/" + nodelet + ": frames"].message.find(part) != std::string::npos;
    });
  };
  EXPECT_TRUE(says("segmentation", "idle: nobody listens"));
  EXPECT_TRUE(says("classification", index_path_.string()));
  EXPECT_TRUE(objectsFor(TableScene().depth_mm()));
  Listener<Objects> listener(node_, "objects");
  EXPECT_TRUE(answerTo(TableScene().depth_mm(), listener));
  EXPECT_TRUE(says("segmentation", "OK"));
  const std::lock_guard<std::mutex> lock(mutex);
  std::map<std::string, std::string> values;
  for (const auto& pair : heard[name_.substr(1) + "/segmentation: frames"].values) values[pair.key] = pair.value;
  EXPECT_GT(std::stoi(values["frames"]), 0);
  EXPECT_EQ(values.count("dropped"), 1u);
  EXPECT_LT(std::stod(values["last_frame_age_s"]), 10);
}

}  // namespace
}  // namespace voxid

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "chain_test");
  voxid::test::Chain::makeClassification = [] { return boost::make_shared<voxid::SpyClassification>(); };
  return voxid::test::runAll();
}
