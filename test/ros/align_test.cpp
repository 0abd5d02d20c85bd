// SPDX-License-Identifier: BSD-3-Clause
// Poses of models in the live chain, and its services, against a scene whose poses are known.
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/point_cloud2_iterator.h>
#include <voxid/AlignObject.h>
#include <voxid/ClassifyCloud.h>
#include <voxid/ConfirmObject.h>

#include <fstream>
#include <mutex>
#include <set>

#include "chain_fixture.h"
#include "clouds.h"
#include "geometry/solids.h"
#include "library/ply.h"
#include "scene_index.h"

namespace voxid {
namespace {

using test::eventually;
using test::labelled;
using test::Listener;
using test::TableScene;

Mesh boxMesh(const Eigen::Vector3d& size) {
  return test::box(static_cast<float>(size.x()), static_cast<float>(size.y()), static_cast<float>(size.z()));
}

/// Rings of corners round the z axis.
Mesh ballMesh(float radius) {
  constexpr int kRings = 16, kCorners = 32;
  Mesh mesh;
  for (int ring = 0; ring <= kRings; ++ring) {
    for (int corner = 0; corner < kCorners; ++corner) {
      const double polar = M_PI * ring / kRings, turn = 2 * M_PI * corner / kCorners;
      const Eigen::Vector3d p =
          radius * Eigen::Vector3d(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar));
      mesh.vertices.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
    }
  }
  for (std::uint32_t ring = 0; ring < kRings; ++ring) {
    for (std::uint32_t corner = 0; corner < kCorners; ++corner) {
      const std::uint32_t a = ring * kCorners + corner, b = ring * kCorners + (corner + 1) % kCorners;
      mesh.triangles.push_back({a, b, a + kCorners});
      mesh.triangles.push_back({b, b + kCorners, a + kCorners});
    }
  }
  return mesh;
}

/// The chain, with the surfaces of what TableScene shows.
class Aligned : public test::Chain {
 protected:
  Aligned() : models_(index_path_.string() + "-models") {
    test::writeSceneIndex(index_path_);
    test::writePly(boxMesh(TableScene().boxes[0].size_m), models_ / "box" / "box-7.ply");
    test::writePly(ballMesh(static_cast<float>(TableScene().balls[0].radius_m)), models_ / "ball" / "ball-3.ply");
    node_.setParam("classification/models", models_.string());
  }
  ~Aligned() override { std::filesystem::remove_all(models_); }

  void startWith(const std::string& align) {
    node_.setParam("classification/align", align);
    start();
  }

  /// Shows the scene until a message has what is wanted.
  template <typename Wanted>
  ObjectsConstPtr showUntil(const TableScene& scene, Wanted wanted) {
    Listener<Objects> listener(node_, "objects");
    ObjectsConstPtr objects;
    const bool found = eventually(20, [&] {
      objects = listener.wait(show(scene.depth_mm()), 0.5);
      return objects && wanted(*objects);
    });
    return found ? objects : ObjectsConstPtr();
  }

  AlignObject::Response align(std::uint32_t number) {
    AlignObject call;
    call.request.number = number;
    EXPECT_TRUE(ros::service::call(name_ + "/align_object", call));
    return call.response;
  }

  const std::filesystem::path models_;
};

bool isAligned(const Objects& objects, const std::string& label) {
  const Object* const object = labelled(objects, label);
  return object && object->model_pose.status == ModelPose::ALIGNED;
}

bool hasState(const Objects& objects, std::uint8_t status) {
  const Object* const box = labelled(objects, "box");
  return box && box->model_pose.status == status;
}

/// Half-turns of the box look alike.
void expectTheBox(const ModelPose& pose, const TableScene& scene) {
  ASSERT_EQ(pose.status, ModelPose::ALIGNED + 0);
  EXPECT_EQ(pose.label, "box");
  EXPECT_EQ(pose.model, "box-7");
  EXPECT_LT((eigenOf(pose.pose.pose.position) - scene.inCamera(scene.boxes[0].centre_m)).norm(), 0.004);
  EXPECT_NEAR(pose.scale_m, scene.boxes[0].size_m.norm(), 0.005);
  EXPECT_NEAR(pose.extents_m.z, scene.boxes[0].size_m.z(), 0.005);
  const Eigen::Matrix3d off = scene.tableFromCamera().linear() * eigenOf(pose.pose.pose.orientation).toRotationMatrix();
  for (int i = 0; i < 3; ++i) EXPECT_GT(std::abs(off(i, i)), std::cos(4 * M_PI / 180));
  EXPECT_LT(pose.fit_mm, 3);
  EXPECT_GT(pose.explained, 0.85);
  EXPECT_TRUE(pose.rotation_known);
  for (const int symmetric : {0, 1, 2}) EXPECT_EQ(pose.symmetry[symmetric], 2);
}

void expectSmallCovariance(const ModelPose& pose) {
  for (const int diagonal : {0, 7, 14, 21, 28, 35}) {
    EXPECT_GT(pose.pose.covariance[diagonal], 0);
    EXPECT_LT(pose.pose.covariance[diagonal], diagonal < 21 ? 1e-4 : 1e-2);  // 1 cm, 6 degrees
  }
  EXPECT_GT(pose.scale_deviation_m, 0);
  EXPECT_LT(pose.scale_deviation_m, 0.01);
}

TEST_F(Aligned, AllObjectsGetTheirPosesWhileNoFrameIsLost) {
  startWith("all");
  const TableScene scene;
  ASSERT_TRUE(objectsFor(scene.depth_mm()));  // the chain is connected
  Listener<Objects> listener(node_, "objects");
  ASSERT_TRUE(showUntil(scene, [](const Objects&) { return true; }));
  std::set<ros::Time> shown;
  const std::vector<std::uint16_t> depth_mm = scene.depth_mm();
  for (int frame = 0; frame < 40; ++frame) {
    shown.insert(show(depth_mm));
    ros::WallDuration(0.1).sleep();
  }
  for (const ros::Time& stamp : shown) {
    ASSERT_TRUE(listener.wait(stamp, 5)) << "a frame is lost";
  }
  const ObjectsConstPtr last =
      showUntil(scene, [](const Objects& o) { return isAligned(o, "box") && isAligned(o, "ball"); });
  ASSERT_TRUE(last);
  expectTheBox(labelled(*last, "box")->model_pose, scene);
  expectSmallCovariance(labelled(*last, "box")->model_pose);
  EXPECT_LT(labelled(*last, "box")->model_pose.stamp, last->header.stamp);
  const ModelPose& ball = labelled(*last, "ball")->model_pose;
  EXPECT_LT((eigenOf(ball.pose.pose.position) - scene.inCamera(scene.balls[0].centre_m)).norm(), 0.005);
  EXPECT_NEAR(ball.extents_m.x, 0.12, 0.006);
  EXPECT_FALSE(ball.rotation_known);
  EXPECT_NEAR(eigenOf(ball.free_axis).norm(), 1, 1e-3);
}

/// How far a point of the camera's frame lies from the surface of the scene's box.
double fromTheBox_m(const Eigen::Vector3d& p, const TableScene& scene) {
  const Eigen::Vector3d inside =
      scene.boxes[0].size_m / 2 - (scene.tableFromCamera() * p - scene.boxes[0].centre_m).cwiseAbs();
  return std::abs(inside.minCoeff());
}

TEST_F(Aligned, TheMarkersShowTheSurfaceWhereItStands) {
  startWith("all");
  TableScene scene;
  scene.balls.clear();
  std::mutex mutex;
  visualization_msgs::Marker surface;  // the newest
  const boost::function<void(const visualization_msgs::MarkerArray&)> on = [&](const auto& array) {
    const std::lock_guard<std::mutex> lock(mutex);
    for (const visualization_msgs::Marker& marker : array.markers)
      if (marker.ns == "surface") surface = marker;
  };
  const auto newest = [&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return surface;
  };
  const ros::Subscriber subscriber = node_.subscribe<visualization_msgs::MarkerArray>("markers", 1, on);
  ASSERT_TRUE(showUntil(scene, [&](const Objects&) { return !newest().points.empty(); }));
  const visualization_msgs::Marker shown = newest();
  EXPECT_EQ(shown.header.frame_id, "camera");
  ASSERT_EQ(shown.points.size(), 1000u);
  const Eigen::Quaterniond turn = eigenOf(shown.pose.orientation);
  Eigen::AlignedBox3d reach;
  for (const geometry_msgs::Point& p : shown.points) {
    ASSERT_LT(fromTheBox_m(turn * eigenOf(p) + eigenOf(shown.pose.position), scene), 0.008);
    reach.extend(eigenOf(p));
  }
  EXPECT_GT(reach.diagonal().norm(), 0.95 * scene.boxes[0].size_m.norm());

  scene.boxes.clear();
  const auto deleted = [&](const Objects&) { return newest().action == visualization_msgs::Marker::DELETE; };
  EXPECT_TRUE(showUntil(scene, deleted)) << "it has left";
}

TEST_F(Aligned, AnObjectIsAlignedWhenItIsAskedForAndUntilItMoves) {
  startWith("selected");
  TableScene scene;
  const ObjectsConstPtr before =
      showUntil(scene, [](const Objects& o) { return hasState(o, ModelPose::NOT_SELECTED); });
  ASSERT_TRUE(before);
  const AlignObject::Response answer = align(labelled(*before, "box")->number);
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_EQ(answer.header.frame_id, "camera");
  expectTheBox(answer.model_pose, scene);

  const ObjectsConstPtr after = showUntil(scene, [](const Objects& o) { return isAligned(o, "box"); });
  ASSERT_TRUE(after);
  EXPECT_EQ(labelled(*after, "box")->model_pose, answer.model_pose);
  EXPECT_EQ(labelled(*after, "ball")->model_pose.status, ModelPose::NOT_SELECTED + 0);

  scene.boxes[0].centre_m.x() -= 0.03;
  EXPECT_TRUE(showUntil(scene, [](const Objects& o) { return hasState(o, ModelPose::NOT_SELECTED); }));
}

/// The scene's points between two columns; NaN elsewhere.
sensor_msgs::PointCloud2 cloudBetween(int first, int last) {
  std::vector<std::uint16_t> depth_mm = TableScene().depth_mm();
  TableScene bare;
  bare.boxes.clear();
  bare.balls.clear();
  const std::vector<std::uint16_t> table_mm = bare.depth_mm();
  for (std::size_t i = 0; i < depth_mm.size(); ++i) {
    const int u = static_cast<int>(i % TableScene::kWidth);
    if (depth_mm[i] == table_mm[i] || u < first || u > last) depth_mm[i] = 0;
  }
  return *test::organisedCloud(depth_mm, ros::Time(9));
}

/// Only the points, in one row.
sensor_msgs::PointCloud2 unorganised(const sensor_msgs::PointCloud2& organised) {
  sensor_msgs::PointCloud2 cloud = organised;
  cloud.height = 1;
  cloud.data.clear();
  for (std::size_t at = 0; at < organised.data.size(); at += organised.point_step) {
    float x;
    std::memcpy(&x, &organised.data[at], sizeof x);
    if (std::isfinite(x))
      cloud.data.insert(cloud.data.end(), organised.data.begin() + at,
                        organised.data.begin() + at + organised.point_step);
  }
  cloud.width = cloud.data.size() / cloud.point_step;
  cloud.row_step = cloud.data.size();
  return cloud;
}

/// The codes take the box for an ashtray, which is a plate.
class AlignedNames : public Aligned {
 protected:
  AlignedNames() {
    test::writeSceneIndex(index_path_, "box", "ashtray");
    test::writePly(boxMesh({0.20, 0.16, 0.01}), models_ / "ashtray" / "twin-1.ply");
  }

  /// What AlignedNaming by itself says about the box.
  Answer alignedAnswerTo(const TableScene& scene) {
    const auto image = test::imageOf(scene.depth_mm(), ros::Time(1));
    const DepthView depth = viewOf(*image, *test::infoOf(ros::Time(1))).value;
    const std::shared_ptr<const Index> index = Index::open(index_path_).value;
    Segmenter segmenter;
    const Scene& found = segmenter.segment(depth, {});
    const auto box = std::min_element(found.clusters.begin(), found.clusters.end(),
                                      [](const auto& a, const auto& b) { return a.centroid_m.x() < b.centroid_m.x(); });
    ObservedObject object;
    object.depth = depth;
    object.pixels = box->pixels;
    object.support = SupportPlane{found.table.normal, found.table.distance_m * 1e3f};
    Recogniser recogniser(index);
    AlignedNaming naming(index, models_);
    const Nearest* const nearest = recogniser.nearest(depth, box->pixels, {});
    auto candidates = naming.candidates(recogniser.code().data(), *nearest);
    naming.sketch(object, candidates.value);
    return naming.name(*nearest, candidates.value, 0);
  }
};

void expectNamedAs(const Answer& answer, const Object& object) {
  EXPECT_EQ(object.label, object.model_pose.label);
  EXPECT_NEAR(object.score, answer.score_permille / 1000.0, 0.002);
  ASSERT_EQ(object.alternatives.size(), static_cast<std::size_t>(answer.count));
  for (int i = 0; i < answer.count; ++i)
    EXPECT_NEAR(object.alternatives[i].score, answer.alternatives[i].score_permille / 1000.0, 0.002);
}

TEST_F(AlignedNames, AnObjectThatRestsIsNamedByItsModel) {
  startWith("all");
  TableScene scene;
  const Answer answer = alignedAnswerTo(scene);
  const ObjectsConstPtr before = objectsFor(scene.depth_mm());
  ASSERT_TRUE(before && labelled(*before, "ashtray"));
  ASSERT_TRUE(showUntil(scene, [](const Objects& o) { return isAligned(o, "box"); }));
  Listener<Objects> listener(node_, "objects");
  ASSERT_TRUE(showUntil(scene, [](const Objects&) { return true; }));
  for (int frame = 0; frame < 40; ++frame) {  // the further tries are among them
    const ObjectsConstPtr objects = answerTo(scene.depth_mm(), listener);
    ASSERT_TRUE(objects && labelled(*objects, "box")) << frame;
    expectNamedAs(answer, *labelled(*objects, "box"));
    ros::WallDuration(0.07).sleep();
  }

  test::reconfigure(name_ + "/classification", "min_score_permille", false, answer.score_permille + 10);
  ASSERT_TRUE(showUntil(scene, [](const Objects& o) { return isAligned(o, "") && !labelled(o, "box"); }));
  test::reconfigure(name_ + "/classification", "min_score_permille", false, 0);

  scene.boxes[0].centre_m.x() -= 0.03;
  ObjectsConstPtr moved;
  ros::Time since;
  do {
    moved = answerTo(scene.depth_mm(), listener);
    ASSERT_TRUE(moved);
    if (since.isZero()) since = moved->header.stamp;
  } while ((moved->header.stamp - since).toSec() < 0.25);
  EXPECT_TRUE(labelled(*moved, "ashtray")) << "the name goes with the pose";
  EXPECT_TRUE(showUntil(scene, [](const Objects& o) { return isAligned(o, "box"); }));
}

TEST_F(AlignedNames, WhatSomebodyCallsItIsAlignedAsThat) {
  startWith("all");
  const ObjectsConstPtr named = showUntil(TableScene(), [](const Objects& o) { return isAligned(o, "box"); });
  ASSERT_TRUE(named);
  ConfirmObject call;
  call.request.number = labelled(*named, "box")->number;
  call.request.category = "ashtray";
  ASSERT_TRUE(ros::service::call(name_ + "/confirm_object", call));
  ASSERT_TRUE(call.response.success) << call.response.message;
  const ObjectsConstPtr next = objectsFor(TableScene().depth_mm());
  ASSERT_TRUE(next && labelled(*next, "ashtray"));
  EXPECT_NE(labelled(*next, "ashtray")->model_pose.label, "box") << "its pose was a box's";
  const ObjectsConstPtr after = showUntil(TableScene(), [](const Objects& o) { return isAligned(o, "ashtray"); });
  ASSERT_TRUE(after);
  EXPECT_EQ(labelled(*after, "ashtray")->model_pose.model, "twin-1");
  EXPECT_EQ(labelled(*after, "ashtray")->score, 1);
}

TEST_F(AlignedNames, WithoutAlignNamesLabelsAreThoseOfTheCodes) {
  node_.setParam("classification/align_names", false);
  startWith("all");
  const ObjectsConstPtr objects = showUntil(TableScene(), [](const Objects& o) { return isAligned(o, "ashtray"); });
  ASSERT_TRUE(objects);
  EXPECT_EQ(labelled(*objects, "ashtray")->model_pose.label, "box");
}

TEST_F(AlignedNames, AskedForTheyAreGivenToo) {
  startWith("selected");
  const TableScene scene;
  const ObjectsConstPtr before = objectsFor(scene.depth_mm());
  ASSERT_TRUE(before && labelled(*before, "ashtray"));
  EXPECT_EQ(align(labelled(*before, "ashtray")->number).model_pose.label, "box");
  const ObjectsConstPtr after = showUntil(scene, [](const Objects& o) { return isAligned(o, "box"); });
  ASSERT_TRUE(after);
  expectNamedAs(alignedAnswerTo(scene), *labelled(*after, "box"));

  ClassifyCloud call;
  call.request.cloud = cloudBetween(0, 159);
  ASSERT_TRUE(ros::service::call(name_ + "/classify_cloud", call));
  EXPECT_EQ(call.response.object.label, "ashtray");
  call.request.align = true;
  ASSERT_TRUE(ros::service::call(name_ + "/classify_cloud", call));
  EXPECT_EQ(call.response.object.label, "box");
  EXPECT_EQ(call.response.object.model_pose.label, "box");
}

/// The scope of the answers holds for aligned names, poses and the service, too.
class AlignedNamesInAScope : public AlignedNames {
 protected:
  void expectNothingNamed(const std::string& label) {
    startWith("all");
    const ObjectsConstPtr objects =
        showUntil(TableScene(), [](const Objects& o) { return isAligned(o, "ashtray") && isAligned(o, "ball"); });
    ASSERT_TRUE(objects);
    for (const Object& object : objects->objects) {
      EXPECT_EQ(object.model_pose.label, object.label);
      for (const Candidate& alternative : object.alternatives) EXPECT_NE(alternative.label, label);
    }
    ClassifyCloud call;
    call.request.cloud = cloudBetween(0, 159);
    call.request.align = true;
    ASSERT_TRUE(ros::service::call(name_ + "/classify_cloud", call));
    EXPECT_EQ(call.response.object.label, "ashtray");
    EXPECT_EQ(call.response.object.model_pose.label, "ashtray");
  }
};

TEST_F(AlignedNamesInAScope, NothingIsNamedThatIsNotListed) {
  const std::string list = index_path_.string() + "-list";
  std::ofstream(list) << "ashtray\nball\n";
  node_.setParam("classification/categories", list);
  expectNothingNamed("box");
  std::filesystem::remove(list);
}

TEST_F(AlignedNamesInAScope, NothingIsNamedThatIsNeverSoSmall) {
  test::writeSceneIndex(index_path_, "bed", "ashtray");  // cfg/sizes.yaml: a bed has at least 50 cm
  test::writePly(boxMesh(TableScene().boxes[0].size_m), models_ / "bed" / "box-7.ply");
  node_.setParam("classification/size", true);
  expectNothingNamed("bed");
}

TEST_F(Aligned, TheAnswerSaysWhyThereIsNoPose) {
  startWith("selected");
  EXPECT_TRUE(eventually(10, [&] { return ros::service::exists(name_ + "/align_object", false); }));
  EXPECT_EQ(align(1).message, "no frame has been answered yet: frames are, while somebody listens to objects");
  ASSERT_TRUE(objectsFor(TableScene().depth_mm()));
  EXPECT_EQ(align(77).message, "the newest frame shows no object with number 77");
  EXPECT_FALSE(align(77).success);
}

TEST_F(Aligned, WithoutSurfacesThePoseIsUnknownAndSaysWhy) {
  node_.setParam("classification/models", models_.string() + "-elsewhere");
  startWith("all");
  ASSERT_TRUE(showUntil(TableScene(), [](const Objects& o) { return hasState(o, ModelPose::NO_SURFACE); }));
  const AlignObject::Response answer = align(1);
  EXPECT_FALSE(answer.success);
  EXPECT_EQ(answer.model_pose.status, ModelPose::NO_SURFACE + 0);
  EXPECT_NE(answer.message.find("no mesh of this name"), std::string::npos) << answer.message;
}

TEST_F(Aligned, OffIsTheDefaultAndAWrongWordIsSaid) {
  start();
  const ObjectsConstPtr objects = objectsFor(TableScene().depth_mm());
  ASSERT_TRUE(objects);
  EXPECT_TRUE(hasState(*objects, ModelPose::OFF));
  EXPECT_EQ(align(1).message, "~align is off: set it to selected or all");
  loader_.clear();
  startWith("sometimes");
  EXPECT_TRUE(eventually(10, [&] { return ros::service::exists(name_ + "/align_object", false); }));
  EXPECT_EQ(align(1).message, "~align is 'sometimes', expected off, selected or all: poses stay unknown");
}

TEST_F(Aligned, ACloudOfOneThingIsNamedAndAligned) {
  start();  // even with ~align off
  const TableScene scene;
  for (const auto& cloud : {cloudBetween(0, 159), unorganised(cloudBetween(0, 159))}) {
    ClassifyCloud call;
    call.request.cloud = cloud;
    call.request.align = true;
    ASSERT_TRUE(eventually(10, [&] { return ros::service::call(name_ + "/classify_cloud", call); }));
    ASSERT_TRUE(call.response.success) << call.response.message;
    const Object& object = call.response.object;
    EXPECT_EQ(object.label, "box");
    EXPECT_EQ(object.model, "box-7");
    EXPECT_EQ(object.alternatives.size(), 2u);
    EXPECT_GT(object.score, 0.4);
    EXPECT_LT((eigenOf(object.centroid) - scene.inCamera(scene.boxes[0].centre_m)).norm(), 0.06);
    expectTheBox(object.model_pose, scene);
    for (const int diagonal : {0, 7, 14, 21, 28, 35}) EXPECT_GT(object.model_pose.pose.covariance[diagonal], 0);
  }
}

TEST_F(Aligned, ACloudIsNamedWithoutAPoseOrRefusedWithTheReason) {
  start();
  ClassifyCloud call;
  call.request.cloud = cloudBetween(160, 319);
  ASSERT_TRUE(eventually(10, [&] { return ros::service::call(name_ + "/classify_cloud", call); }));
  EXPECT_EQ(call.response.object.label, "ball");
  EXPECT_EQ(call.response.object.model_pose.status, ModelPose::OFF + 0);

  call.request.cloud = sensor_msgs::PointCloud2();
  ASSERT_TRUE(ros::service::call(name_ + "/classify_cloud", call));
  EXPECT_FALSE(call.response.success);
  EXPECT_EQ(call.response.message, "the cloud has no field 'x' of float32: remap points to another");
  call.request.cloud = cloudBetween(0, -1);
  ASSERT_TRUE(ros::service::call(name_ + "/classify_cloud", call));
  EXPECT_NE(call.response.message.find("the cloud has 0 finite points"), std::string::npos) << call.response.message;
}

}  // namespace
}  // namespace voxid

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "align_test");
  return voxid::test::runAll();
}
