// SPDX-License-Identifier: BSD-3-Clause
// What the live chain remembers over computed sequences, thirty frames a second by their stamps: things that rest, are
// moved, taken away and exchanged, and a camera that circles the table.
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <tf2_ros/transform_broadcaster.h>

#include <map>
#include <set>
#include <utility>

#include "chain_fixture.h"
#include "core/random.h"
#include "recogniser.h"
#include "scene_index.h"

namespace voxid {
namespace {

using test::eventually;
using test::Listener;
using test::TableScene;

constexpr double kFrame_s = 1.0 / 30;

/// A structured-light sensor's: the same in inverse depth everywhere (some 1.5 mm at 0.9 m), and pixels without depth.
std::vector<std::uint16_t> sensed(std::vector<std::uint16_t> depth_mm, test::Random& random) {
  for (std::uint16_t& depth : depth_mm) {
    const double noise = (static_cast<int>(random.below(2001)) - 1000) / 1000.0;
    if (depth > 0) depth = static_cast<std::uint16_t>(std::lround(1 / (1.0 / depth + noise * 3e-6)));
    if (random.below(100) == 0) depth = 0;
  }
  return depth_mm;
}

/// Three things that look alike, and one that does not, seen from all round the table.
struct Known {
  std::string label;
  TableScene scene;
};

TableScene oneThing(const Eigen::Vector3d& size_m) {
  TableScene scene;
  scene.balls.clear();
  scene.boxes = {{{-0.15, 0.70, size_m.z() / 2}, size_m}};
  return scene;
}

TableScene oneBall() {
  TableScene scene;
  scene.boxes.clear();
  return scene;
}

std::vector<Known> knownThings() {
  return {{"box", oneThing({0.10, 0.08, 0.12})},
          {"carton", oneThing({0.10, 0.085, 0.126})},
          {"brick", oneThing({0.104, 0.08, 0.115})},
          {"ball", oneBall()}};
}

class Memory : public test::Chain {
 protected:
  static constexpr int kDirections = 24;

  Memory() { writeIndexOfAllSides(); }

  /// Each thing as it is seen from each of the directions that the camera circles through.
  void writeIndexOfAllSides() {
    IndexContent content;
    content.directions.resize(kDirections);
    for (auto& direction : content.directions) direction = {{32767, 0, 0}, {0, 32767, 0}, {}};
    for (const Known& known : knownThings()) content.models.push_back(modelOf(known));
    content.calibration = builtInCalibration({});
    const Status written = writeIndex(content, index_path_);
    ASSERT_TRUE(written.ok()) << written.sentence;
  }

  static ModelRecord modelOf(const Known& known) {
    ModelRecord model;
    model.category = known.label;
    model.name = known.label + "-1";
    Describer describer;
    for (int i = 0; i < kDirections; ++i) {
      TableScene scene = known.scene;
      scene.turn_deg = 360.0 * i / kDirections;
      const auto image = test::imageOf(scene.depth_mm(), ros::Time(1));
      const DepthView depth = viewOf(*image, *test::infoOf(ros::Time(1))).value;
      Segmenter segmenter;
      const Scene& found = segmenter.segment(depth, {});
      if (found.clusters.size != 1) throw std::runtime_error(known.label + " is not found");
      const Descriptor bins = describer.describe(depth, found.clusters[0].pixels).bins;
      ViewRecord view;
      view.direction = static_cast<std::uint16_t>(i);
      view.points = 1;
      view.code.assign(bins.begin(), bins.end());
      model.views.push_back(view);
    }
    return model;
  }

  /// The answer to the next frame of the sequence; null if none comes.
  ObjectsConstPtr next(const TableScene& scene) {
    now_ += ros::Duration(kFrame_s);
    const auto image = test::imageOf(sensed(scene.depth_mm(), random_), now_);
    ObjectsConstPtr objects;
    // The chain connects in its own time, and a transform may arrive after its frame.
    eventually(10, [&] {
      image_.publish(image);
      info_.publish(test::infoOf(now_));
      objects = objects_.wait(now_, 0.5);
      return objects && objects->status == wanted_status_;
    });
    sent_ = image;
    return objects;
  }

  /// The only object of the next frame.
  Object onlyThing(const TableScene& scene) {
    const ObjectsConstPtr objects = next(scene);
    EXPECT_TRUE(objects && objects->objects.size() == 1);
    return objects && !objects->objects.empty() ? objects->objects[0] : Object();
  }

  /// What each object of the last frame is by that frame alone.
  std::vector<Answer> answersOfTheFrameAlone() {
    const DepthView depth = viewOf(*sent_, *test::infoOf(now_)).value;
    std::vector<Answer> answers;
    for (const Cluster& cluster : segmenter_.segment(depth, {}).clusters)
      answers.push_back(recogniser_->recognise(depth, cluster.pixels, {}));
    return answers;
  }

  void startChain() {
    start();
    recogniser_ = std::make_unique<Recogniser>(Index::open(index_path_).value);
  }

  ros::Time now_{1000};
  std::uint8_t wanted_status_ = Objects::OK;
  test::Random random_{7};
  Listener<Objects> objects_{node_, "objects"};
  Segmenter segmenter_;
  std::unique_ptr<Recogniser> recogniser_;
};

/// How often a label changes from frame to frame after the first second.
class Changes {
 public:
  void see(const std::string& thing, const std::string& label) {
    History& history = things_[thing];
    ++history.frames;
    if (history.frames > 30 && label != history.last) ++history.changes;
    history.last = label;
  }
  int most() const {
    int most = 0;
    for (const auto& [thing, history] : things_) most = std::max(most, history.changes);
    return most;
  }
  std::size_t things() const { return things_.size(); }

 private:
  struct History {
    std::string last;
    int frames = 0, changes = 0;
  };
  std::map<std::string, History> things_;
};

/// The thing nearest to a place on the table.
const Object* at(const Objects& objects, const TableScene& scene, const Eigen::Vector3d& place_m) {
  for (const Object& object : objects.objects) {
    const bool in_camera = objects.header.frame_id == "camera";
    const Eigen::Vector3d p = in_camera ? scene.inCamera(place_m) : place_m;
    if ((eigenOf(object.pose.pose.position) - p).norm() < 0.05) return &object;
  }
  return nullptr;
}

TEST_F(Memory, TheLabelOfARestingThingChangesAtMostOnceAfterItsFirstSecond) {
  startChain();
  TableScene scene;
  scene.boxes = {{{-0.17, 0.70, 0.061}, {0.102, 0.08, 0.122}}, {{0.02, 0.62, 0.059}, {0.101, 0.082, 0.118}}};
  Changes remembered, alone;
  for (int frame = 0; frame < 120; ++frame) {
    const ObjectsConstPtr objects = next(scene);
    ASSERT_TRUE(objects) << frame;
    for (const Object& object : objects->objects) remembered.see(std::to_string(object.number), object.label);
    const auto answers = answersOfTheFrameAlone();
    for (std::size_t i = 0; i < answers.size(); ++i)
      alone.see(std::to_string(i), std::to_string(answers[i].alternatives[0].category));
  }
  EXPECT_LE(remembered.most(), 1);
  EXPECT_EQ(remembered.things(), 3u) << "each has kept its number";
  EXPECT_GE(alone.most(), 5) << "frame by frame the labels flicker: the test would see it";
}

TEST_F(Memory, TheSolidOfARestingThingStaysWhatItIsAndGoesWithItWhenItIsMoved) {
  startChain();
  TableScene scene = oneThing({0.102, 0.08, 0.122});
  const auto thing = [&] { return onlyThing(scene); };
  const auto centreOf = [](const Object& object) { return eigenOf(object.shape_pose.position); };
  std::set<std::vector<double>> sizes, sizes_of_box;
  Object last;
  for (int frame = 0; frame < 60; ++frame) {
    last = thing();
    if (frame < 30) continue;
    sizes.insert(last.shape.dimensions);
    sizes_of_box.insert({last.extents_m.x, last.extents_m.y, last.extents_m.z});
  }
  EXPECT_LE(sizes.size(), 2u);
  EXPECT_GE(sizes_of_box.size(), 10u) << "the visible box is measured in every frame";
  for (const double moved_m : {0.03, 0.12}) {  // within the gate, and beyond
    scene.boxes[0].centre_m.x() -= moved_m;
    const Object moved = thing();
    EXPECT_NEAR((centreOf(moved) - centreOf(last)).norm(), moved_m, 0.006);
    last = moved;
  }
}

TEST_F(Memory, WhatIsMovedTakenAwayOrExchangedIsNoticedWithinHalfASecond) {
  startChain();
  TableScene scene;
  const Eigen::Vector3d place = scene.boxes[0].centre_m;
  ObjectsConstPtr objects;
  for (int frame = 0; frame < 45; ++frame) ASSERT_TRUE(objects = next(scene)) << frame;
  const Object* const box = at(*objects, scene, place);
  ASSERT_TRUE(box);
  const std::uint32_t first = box->number;

  scene.boxes[0].centre_m.x() -= 0.08;  // moved: another number at once
  ASSERT_TRUE(objects = next(scene));
  const Object* const moved = at(*objects, scene, scene.boxes[0].centre_m);
  ASSERT_TRUE(moved);
  EXPECT_GT(moved->number, first);

  scene.boxes[0].centre_m.x() += 0.08;
  for (int frame = 0; frame < 45; ++frame) ASSERT_TRUE(objects = next(scene)) << frame;
  const std::uint32_t before = at(*objects, scene, place)->number;
  scene.boxes.clear();  // exchanged: the ball's twin in the box's place
  scene.balls.push_back({{place.x(), place.y(), 0.06}, 0.06});
  int frames = 0;
  const Object* ball = nullptr;
  do {
    ASSERT_TRUE(objects = next(scene));
    ASSERT_LE(++frames * kFrame_s, 0.5) << "not noticed";
    ball = at(*objects, scene, scene.balls[1].centre_m);
  } while (!ball || ball->number == before || ball->label != "ball");

  scene.balls.pop_back();  // taken away
  ASSERT_TRUE(objects = next(scene));
  EXPECT_EQ(objects->objects.size(), 1u);
}

TEST_F(Memory, ItsParametersWorkInTheNextFrame) {
  startChain();
  TableScene scene = oneThing({0.102, 0.08, 0.122});
  const auto thing = [&] { return onlyThing(scene); };
  const auto set = [&](const std::string& name, int value) {
    test::reconfigure(name_ + "/classification", name, false, value);
  };
  const auto aloneScore = [&] { return answersOfTheFrameAlone()[0].score_permille / 1000.0f; };
  for (int frame = 0; frame < 10; ++frame) thing();
  const float remembered = thing().score;
  EXPECT_NE(remembered, aloneScore()) << "the mean of all frames";

  const auto scoresOfTenFrames = [&] {
    std::set<float> scores;
    for (int frame = 0; frame < 10; ++frame) scores.insert(thing().score);
    return scores.size();
  };
  set("memory_describe_ms", 1000);
  thing();  // new parameters: everything is described once
  EXPECT_LE(scoresOfTenFrames(), 2u) << "described once at most in a third of a second";
  set("memory_describe_ms", 0);
  EXPECT_GE(scoresOfTenFrames(), 5u) << "described in every frame";

  set("memory_half_life_ms", 0);
  const float forgotten = thing().score;
  EXPECT_EQ(forgotten, aloneScore()) << "of the frame alone";

  const std::uint32_t first = thing().number;
  scene.boxes[0].centre_m.x() -= 0.03;
  EXPECT_EQ(thing().number, first) << "within the gate of 5 cm";
  set("memory_gate_mm", 20);
  scene.boxes[0].centre_m.x() += 0.03;
  const std::uint32_t moved = thing().number;
  EXPECT_GT(moved, first);
  EXPECT_EQ(thing().number, moved);
  set("memory_keep_ms", 0);
  EXPECT_GT(thing().number, moved) << "forgotten between two frames";

  std::set<std::string> names;
  MemoryParams params;
  visitParams(params, [&](const char* name, auto&, auto, auto) { names.insert(name); });
  EXPECT_EQ(names,
            (std::set<std::string>{"memory_describe_ms", "memory_gate_mm", "memory_half_life_ms", "memory_keep_ms"}));
}

/// Where the camera is when a frame is taken.
class MovingCamera {
 public:
  void sendTransform(const TableScene& scene, const ros::Time& stamp) {
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = stamp;
    transform.header.frame_id = "table";
    transform.child_frame_id = "camera";
    const Eigen::Isometry3d pose = scene.tableFromCamera();
    transform.transform.translation = vectorOf(pose.translation());
    transform.transform.rotation = quaternionOf(Eigen::Quaterniond(pose.rotation()));
    broadcaster_.sendTransform(transform);
  }

 private:
  tf2_ros::TransformBroadcaster broadcaster_;
};

TEST_F(Memory, ACameraThatCirclesTheTableLeavesNumbersAndLabels) {
  node_.setParam("classification/target_frame", "table");
  startChain();
  MovingCamera camera;
  TableScene scene;
  Changes remembered;
  std::map<std::uint32_t, int> frames_of, solids_of;
  std::map<std::uint32_t, Eigen::Vector3d> solid_at;
  constexpr int kFrames = 120;
  for (int frame = 0; frame < kFrames; ++frame) {
    scene.turn_deg = 360.0 * frame / kFrames;  // once round in four seconds
    camera.sendTransform(scene, now_ + ros::Duration(kFrame_s));
    const ObjectsConstPtr objects = next(scene);
    ASSERT_TRUE(objects) << frame;
    ASSERT_EQ(objects->header.frame_id, "table") << objects->status_text;
    for (const Object& object : objects->objects) {
      ++frames_of[object.number];
      const Eigen::Vector3d solid = eigenOf(object.shape_pose.position);
      solids_of[object.number] += (solid - std::exchange(solid_at[object.number], solid)).norm() > 1e-4;
      remembered.see(std::to_string(object.number), object.label);
    }
  }
  EXPECT_EQ(frames_of, (std::map<std::uint32_t, int>{{1, kFrames}, {2, kFrames}}));
  EXPECT_LE(remembered.most(), 1);
  for (const auto& [number, solids] : solids_of) EXPECT_LE(solids, kFrames / 4) << number;
}

}  // namespace
}  // namespace voxid

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "memory_test");
  return voxid::test::runAll();
}
