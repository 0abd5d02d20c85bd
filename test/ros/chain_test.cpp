// SPDX-License-Identifier: BSD-3-Clause
// The nodelets in the test's own process, as in one manager: what goes in, what comes out, and by which pointers.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>

#include "chain_fixture.h"
#include "clouds.h"
#include "scene_index.h"

namespace voxid {
namespace {

using test::Chain;
using test::eventually;
using test::imageOf;
using test::infoOf;
using test::labelled;
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
  const std::uint32_t number = labelled(*objects, "box")->number;
  test::writeSceneIndex(index_path_, "carton");
  EXPECT_TRUE(eventually(5, sees("carton")));
  EXPECT_GT(labelled(*objects, "carton")->number, number) << "a number was used again";

  // Cut, and then written over, as `cp` and `scp` do.
  std::filesystem::resize_file(index_path_, 1);
  EXPECT_TRUE(sees("carton")());
  const std::filesystem::path other = index_path_.string() + ".other";
  test::writeSceneIndex(other, "crate");
  std::filesystem::copy_file(other, index_path_, std::filesystem::copy_options::overwrite_existing);
  std::filesystem::remove(other);
  EXPECT_TRUE(eventually(5, sees("crate")));

  // Damage is not taken over: the index that was there answers on.
  std::filesystem::remove(index_path_);
  std::fclose(std::fopen(index_path_.c_str(), "w"));
  ros::WallDuration(1.2).sleep();
  EXPECT_TRUE(sees("crate")());
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
  EXPECT_EQ(overlay->height, 240u);
  EXPECT_EQ(overlay->step, 3 * 320u);
  EXPECT_EQ(overlay->data.size(), 3 * 320u * 240u);
  EXPECT_NE(std::count_if(overlay->data.begin(), overlay->data.end(), [](std::uint8_t byte) { return byte > 0; }), 0);
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

TEST_F(Chain, AListThatCannotBeReadIsNamedAndHidesNothing) {
  test::writeSceneIndex(index_path_);
  node_.setParam("classification/categories", "nowhere.txt");
  start();
  Diagnostics diagnostics(name_);
  const ObjectsConstPtr objects = objectsFor(TableScene().depth_mm());
  ASSERT_TRUE(objects);
  EXPECT_TRUE(labelled(*objects, "box"));
  EXPECT_TRUE(diagnostics.becomes("classification", "message", "nowhere.txt: cannot be read"));
}

TEST_F(Chain, TheTableOfACameraThatHangsUpsideDownIsFoundWhereTfKnowsUp) {
  node_.setParam("segmentation/up_frame", "ground");
  start();
  Diagnostics diagnostics(name_);
  Listener<Objects> listener(node_, "objects");
  const TableScene scene;
  std::vector<std::uint16_t> depth_mm = scene.depth_mm();
  std::reverse(depth_mm.begin(), depth_mm.end());
  ObjectsConstPtr objects = answerTo(depth_mm, listener);
  ASSERT_TRUE(objects);
  EXPECT_EQ(objects->status, Objects::NO_TABLE + 0);
  EXPECT_TRUE(diagnostics.becomes("segmentation", "message", "no transform from 'ground' to 'camera'"));
  EXPECT_GE(std::stoi(diagnostics.value("segmentation", "frames_without_up")), 1);

  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = "ground";
  transform.child_frame_id = "camera";
  const Eigen::Matrix3d turned(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()));
  transform.transform.rotation = quaternionOf(Eigen::Quaterniond(scene.tableFromCamera().rotation() * turned));
  tf2_ros::StaticTransformBroadcaster broadcaster;
  broadcaster.sendTransform(transform);
  EXPECT_TRUE(eventually(5, [&] {
    objects = listener.wait(show(depth_mm), 0.5);
    return objects && objects->status != Objects::NO_TABLE;
  }));
  ASSERT_TRUE(objects);
  EXPECT_NEAR(objects->table.distance_m, scene.height_m, 0.005);
  EXPECT_EQ(objects->objects.size(), 2u);
}

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
