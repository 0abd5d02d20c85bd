// SPDX-License-Identifier: BSD-3-Clause
// After warm-up a frame's messages are filled without taking memory, whatever number of objects comes and goes. This
// binary counts every allocation.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "conversions.h"
#include "counted_allocations.h"
#include "message_pool.h"
#include "pose_board.h"
#include "recogniser.h"
#include "scene_index.h"

namespace voxid {
namespace {

using test::imageOf;
using test::infoOf;
using test::TableScene;

/// A frame as its segmentation and classification leave it.
struct Frame {
  sensor_msgs::ImagePtr image;
  DepthView depth;
  Segmenter segmenter;
  Scene scene;
  std::vector<Answer> answers;

  Frame(const std::vector<std::uint16_t>& depth_mm, Recogniser& recogniser)
      : image(imageOf(depth_mm, ros::Time(1))), depth(viewOf(*image, *infoOf(ros::Time(1))).value) {
    scene = segmenter.segment(depth, {});
    for (const Cluster& cluster : scene.clusters) answers.push_back(recogniser.recognise(depth, cluster.pixels, {}));
  }
};

/// Messages and what the nodelets keep beside them.
struct Messages {
  Segments segments;
  Objects objects;
  Spares<Segment> spare_segments;
  Spares<Object> spare_objects;
  PoseBoard poses;
  std::vector<Answer> answers;

  void fill(const Frame& frame, const Index& index) {
    spare_segments.resize(frame.scene.clusters.size, &segments.segments);
    fillSegments(frame.scene, frame.depth.width_px, frame.depth.height_px, &segments);
    objects.status_text = statusText(segments.status);
    objects.table = segments.table;
    spare_objects.resize(segments.segments.size(), &objects.objects);
    answers = frame.answers;
    for (std::size_t i = 0; i < answers.size(); ++i) {
      const Segment& segment = segments.segments[i];
      const Primitive solid =
          primitiveOf(frame.depth, {segment.pixels.data(), segment.pixels.size()}, boxOf(segment));
      fillObject(segment, solid, &objects.objects[i]);
      objects.objects[i].number = numberOf(objects.objects[i]);
    }
    poses.show({}, 0, &objects, &answers);
    for (std::size_t i = 0; i < answers.size(); ++i) fillAnswer(answers[i], index, &objects.objects[i]);
  }

  /// What rests keeps its number.
  static std::uint32_t numberOf(const Object& object) {
    return static_cast<std::uint32_t>(1000 + std::lround(object.centroid.x * 100));
  }

  /// A model is aligned with each object, and names it.
  void align(const std::string& model) {
    AlignedObject found;
    found.pose.status = ModelPose::ALIGNED;
    found.pose.label = found.pose.model = model;
    found.name.count = 1;
    found.name.score_permille = 321;
    for (const Object& object : objects.objects) poses.put(object, objects.header.stamp, found);
  }
};

class MessageAllocation : public testing::Test {
 protected:
  MessageAllocation() : path_(std::filesystem::temp_directory_path() / ("messages" + std::to_string(getpid()))) {
    test::writeSceneIndex(path_, "a box that has a name of many letters");
    index_ = Index::open(path_).value;
  }
  ~MessageAllocation() override { std::filesystem::remove(path_); }

  /// Two things, four, none.
  std::vector<std::unique_ptr<Frame>> frames() {
    TableScene more, none;
    more.boxes.push_back({{0.0, 0.80, 0.01}, {0.10, 0.08, 0.02}});
    more.boxes.push_back({{-0.10, 0.62, 0.03}, {0.05, 0.06, 0.06}});
    none.boxes.clear();
    none.balls.clear();
    Recogniser recogniser(index_, std::make_shared<const AnswerScope>(*index_, std::string(), true));
    std::vector<std::unique_ptr<Frame>> frames;
    for (const TableScene& scene : {TableScene(), more, none})
      frames.push_back(std::make_unique<Frame>(scene.depth_mm(), recogniser));
    return frames;
  }

  const std::filesystem::path path_;
  std::shared_ptr<const Index> index_;
};

TEST_F(MessageAllocation, AfterWarmUpThereIsNone) {
  const auto made = frames();
  ASSERT_EQ(made[0]->answers.size(), 2u);
  ASSERT_EQ(made[1]->answers.size(), 4u);
  ASSERT_EQ(made[2]->answers.size(), 0u);
  Messages messages;
  const int at_first = allocations;
  messages.fill(*made[1], *index_);
  EXPECT_GT(allocations, at_first);  // they are counted
  for (const int i : {2, 1, 0, 1}) messages.fill(*made[i], *index_);
  const int before = allocations;
  for (const int i : {0, 1, 2, 0, 2, 1, 1, 0}) messages.fill(*made[i], *index_);
  EXPECT_EQ(allocations - before, 0);
}

TEST_F(MessageAllocation, PosesOfModelsThatAreShownAgainTakeNone) {
  const std::string model = "a model that has a name of many letters";
  const auto made = frames();
  Messages messages;
  messages.fill(*made[1], *index_);
  messages.align(model);
  for (const int i : {2, 1, 0, 1}) messages.fill(*made[i], *index_);
  const int before = allocations;
  for (const int i : {0, 1, 2, 0, 2, 1, 1, 0}) {
    messages.fill(*made[i], *index_);
    for (const Object& object : messages.objects.objects) {
      ASSERT_EQ(object.model_pose.label, model) << i;
      ASSERT_EQ(object.score, 0.321f) << i;
    }
  }
  EXPECT_EQ(allocations - before, 0);
}

TEST_F(MessageAllocation, MessagesThatAreUsedAgainSayWhatNewOnesSay) {
  const auto made = frames();
  Messages used;
  for (const int i : {1, 0, 2, 1}) {
    for (Object& object : used.objects.objects) {  // of the frame before
      object.number = 7;
      object.model_pose.status = ModelPose::ALIGNED;
      object.model_pose.label = "mug";
    }
    used.fill(*made[i], *index_);
    Messages fresh;
    fresh.fill(*made[i], *index_);
    EXPECT_EQ(used.segments, fresh.segments);
    EXPECT_EQ(used.objects, fresh.objects);
  }
}

}  // namespace
}  // namespace voxid
