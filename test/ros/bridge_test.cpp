// SPDX-License-Identifier: BSD-3-Clause
// voxid.launch without a camera in processes of its own, and its consumers: over ROS, and over a real LCM socket.
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <ros/master.h>
#include <ros/ros.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <future>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <thread>

#include "conversions.h"
#include "listener.h"
#include "scene_index.h"

namespace voxid {
namespace {

using test::eventually;
using test::imageOf;
using test::infoOf;
using test::Listener;
using test::TableScene;

std::string parameter(const std::string& name) {
  std::string value;
  ros::param::get(name, value);
  return value;
}

/// A camera at 10 Hz.
class Camera10Hz {
 public:
  explicit Camera10Hz(const std::string& name)
      : node_(name),
        image_(node_.advertise<sensor_msgs::Image>("depth/image_raw", 4)),
        info_(node_.advertise<sensor_msgs::CameraInfo>("depth/camera_info", 4)),
        thread_([this] { run(); }) {}
  ~Camera10Hz() {
    stop_ = true;
    thread_.join();
  }

 private:
  void run() {
    const std::vector<std::uint16_t> depth_mm = TableScene().depth_mm();
    while (!stop_) {
      const ros::Time stamp = ros::Time::now();
      image_.publish(imageOf(depth_mm, stamp));
      info_.publish(infoOf(stamp));
      ros::WallDuration(0.1).sleep();
    }
  }

  ros::NodeHandle node_;
  ros::Publisher image_, info_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// Everything on VOXID_OBJECTS, by utime.
class LcmInbox {
 public:
  explicit LcmInbox(const std::string& url) : lcm_(url) {
    if (!lcm_.good()) return;
    lcm_.subscribe("VOXID_OBJECTS", &LcmInbox::on, this);
    lcm_.subscribe("VOXID_POINTS", &LcmInbox::onPoints, this);
  }
  bool good() const { return lcm_.good(); }
  void handle() { lcm_.handleTimeout(50); }
  std::map<std::int64_t, object_list_t> lists;
  std::map<std::int64_t, std::map<std::int32_t, object_points_t>> points;  // by id

 private:
  void on(const lcm::ReceiveBuffer*, const std::string&, const object_list_t* list) { lists[list->utime] = *list; }
  void onPoints(const lcm::ReceiveBuffer*, const std::string&, const object_points_t* of_one) {
    points[of_one->utime][of_one->id] = *of_one;
  }
  mutable lcm::LCM lcm_;
};

struct Ended {
  int exit_code;
  std::string output;
};

Ended run(const std::string& command) {
  FILE* pipe = popen(command.c_str(), "r");
  std::string output;
  std::array<char, 512> line;
  while (fgets(line.data(), line.size(), pipe)) output += line.data();
  const int status = pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, output};
}

std::vector<std::uint8_t> encoded(const object_list_t& list) {
  std::vector<std::uint8_t> bytes(list.getEncodedSize());
  list.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

/// Where a gripper begins, and whether it looks down with its fingers closing along the box's shorter side.
void expectAboveTheBox(const Eigen::Vector3d& position, const Eigen::Quaterniond& axes) {
  const TableScene scene;
  const Eigen::Vector3d top(0, 0, scene.boxes[0].size_m.z() / 2 + 0.1);
  EXPECT_LT((position - scene.inCamera(scene.boxes[0].centre_m + top)).norm(), 0.02);
  const Eigen::Matrix3d in_table = scene.tableFromCamera().linear() * axes.toRotationMatrix();
  EXPECT_LT(in_table(2, 2), -0.999);
  EXPECT_GT(std::abs(in_table(1, 1)), 0.98);  // the box is 0.10 m along x and 0.08 m along y
}

const std::string kPythonPlanner = VOXID_SOURCE "/lcm/examples/planner_inbox.py --types " VOXID_LCM_PYTHON;

class Bridge : public testing::Test {
 protected:
  static void SetUpTestSuite() { test::writeSceneIndex(parameter("/voxid/classification/index")); }
  static void TearDownTestSuite() { std::filesystem::remove(parameter("/voxid/classification/index")); }

  void SetUp() override {
    if (!LcmInbox(url_).good()) GTEST_SKIP() << "no multicast route, so no LCM here: ip route add 224.0.0.0/4 dev lo";
  }
  const std::string url_ = parameter("/voxid/lcm_bridge/url");
};

TEST_F(Bridge, LcmCarriesWhatRosCarries) {
  ros::NodeHandle node("/voxid");
  Listener<Objects> listener(node, "objects");
  LcmInbox inbox(url_);
  const Camera10Hz camera("/voxid");
  ObjectsConstPtr objects;
  const object_list_t* list = nullptr;
  EXPECT_TRUE(eventually(20, [&] {
    inbox.handle();
    if (inbox.lists.empty()) return false;
    list = &inbox.lists.rbegin()->second;
    objects = listener.find([&](const ros::Time& stamp) { return microsecondsOf(stamp) == list->utime; });
    return objects && list->num_objects == 2 && list->objects[0].label != "";
  }));
  ASSERT_TRUE(list);
  ASSERT_TRUE(objects);
  EXPECT_EQ(encoded(*list), encoded(toLcm(*objects)));
  EXPECT_EQ(list->status, object_list_t::OK + 0);
  EXPECT_EQ(list->frame_name, "camera");
  const bool box_first = list->objects[0].label == "box";
  const object_t& box = list->objects[box_first ? 0 : 1];
  EXPECT_EQ(box.label, "box");
  EXPECT_EQ(box.model, "box-7");
  EXPECT_EQ(box.view, 1);
  const Eigen::Vector3d centre = TableScene().inCamera(TableScene().boxes[0].centre_m);
  EXPECT_LT((Eigen::Vector3d(box.position_m) - centre).norm(), 0.02);
  EXPECT_EQ(list->objects[box_first ? 1 : 0].label, "ball");
}

TEST_F(Bridge, PointsOfEachObjectComeOnAChannelOfTheirOwn) {
  LcmInbox inbox(url_);
  const Camera10Hz camera("/voxid");
  const object_list_t* list = nullptr;
  ASSERT_TRUE(eventually(20, [&] {
    inbox.handle();
    for (const auto& [utime, of_frame] : inbox.points) {
      const bool complete = of_frame.size() == 2 && inbox.lists.count(utime) && inbox.lists[utime].num_objects == 2;
      if (complete) list = &inbox.lists[utime];
    }
    return list != nullptr;
  }));
  for (const object_t& object : list->objects) {
    const object_points_t& points = inbox.points[list->utime][object.id];
    EXPECT_EQ(points.number, object.number);
    EXPECT_EQ(points.frame_name, "camera");
    EXPECT_EQ(points.num_points, object.num_points);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& p : points.xyz_mm) sum += Eigen::Vector3d(p[0], p[1], p[2]);
    EXPECT_LT((sum * 1e-3 / points.num_points - Eigen::Vector3d(object.centroid_m)).norm(), 0.001);
  }
}

/// 10 cm above the box's top, looking down.
void expectApproachAboveTheBox(const std::string& output) {
  const std::size_t at = output.find("approach_m=");
  ASSERT_NE(at, std::string::npos) << output;
  Eigen::Vector3d position;
  Eigen::Quaterniond axes;
  ASSERT_EQ(std::sscanf(output.c_str() + at, "approach_m=%lf,%lf,%lf quat_wxyz=%lf,%lf,%lf,%lf", &position.x(),
                        &position.y(), &position.z(), &axes.w(), &axes.x(), &axes.y(), &axes.z()),
            7);
  expectAboveTheBox(position, axes);
}

TEST_F(Bridge, NothingIsGraspedThatIsWiderThanTheGripper) {
  const Camera10Hz camera("/voxid");
  const Ended planner =
      run(VOXID_BIN "/voxid_planner_inbox --url '" + url_ + "' --seconds 20 --count 5 --opening 0.03");
  EXPECT_EQ(planner.exit_code, 0);
  EXPECT_EQ(planner.output.find("grasp"), std::string::npos) << planner.output;
}

TEST_F(Bridge, PlannersInBothLanguagesReadIt) {
  const Camera10Hz camera("/voxid");
  const std::string options = " --url '" + url_ + "' --seconds 20 --count 30 --label box --opening 0.1";
  auto cpp = std::async(std::launch::async, [&] { return run(VOXID_BIN "/voxid_planner_inbox" + options); });
  const Ended python = run(kPythonPlanner + options);
  for (const Ended& planner : {cpp.get(), python}) {
    EXPECT_EQ(planner.exit_code, 0) << planner.output;
    EXPECT_NE(planner.output.find("label=box score="), std::string::npos) << planner.output;
    EXPECT_NE(planner.output.find("model=ball-3 view=1 position_m="), std::string::npos) << planner.output;
    EXPECT_NE(planner.output.find(" label=box distance_m=0.8"), std::string::npos) << planner.output;
    expectApproachAboveTheBox(planner.output);
    EXPECT_NE(planner.output.find("received=30\n"), std::string::npos) << planner.output;
  }
}

TEST_F(Bridge, PlannersFailWhenNothingComes) {
  const std::string options = " --url 'udpm://239.255.76.67:7742?ttl=0' --seconds 0.5";
  EXPECT_EQ(run(VOXID_BIN "/voxid_planner_inbox" + options).exit_code, 1);
  EXPECT_EQ(run(kPythonPlanner + options).exit_code, 1);
  EXPECT_EQ(run(VOXID_BIN "/voxid_planner_inbox --nonsense 1 2>/dev/null").exit_code, 2);
}

/// A plain node with two arguments.
pid_t startNode(const std::string& name, const char* first, const char* second) {
  const pid_t pid = fork();
  if (pid != 0) return pid;
  const std::string program = VOXID_NODES "/voxid_" + name;
  execl(program.c_str(), program.c_str(), first, second, "_label:=box", nullptr);
  _exit(127);
}

pid_t startNode(const std::string& name) {
  return startNode(name, "__ns:=/nodes", "_url:=udpm://239.255.76.67:7743?ttl=0");
}

int exitStatusAfterSigint(pid_t pid) {
  kill(pid, SIGINT);
  int status = -1;
  const bool ended = eventually(10, [&] { return waitpid(pid, &status, WNOHANG) == pid; });
  if (!ended) {
    kill(pid, SIGKILL);
    waitpid(pid, &status, 0);
  }
  return ended && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(PlannerNode, SaysWhereTheGripperIsToGo) {
  ros::NodeHandle node("/voxid");
  Listener<geometry_msgs::PoseStamped> approaches(node, "approach");
  const pid_t planner = startNode("planner_node", "__ns:=/voxid", "_opening:=0.1");
  const Camera10Hz camera("/voxid");
  geometry_msgs::PoseStampedConstPtr approach;
  EXPECT_TRUE(
      eventually(20, [&] { return (approach = approaches.find([](const ros::Time&) { return true; })) != nullptr; }));
  EXPECT_EQ(exitStatusAfterSigint(planner), 0);
  ASSERT_TRUE(approach);
  EXPECT_EQ(approach->header.frame_id, "camera");
  expectAboveTheBox(eigenOf(approach->pose.position), eigenOf(approach->pose.orientation));
}

TEST(PlainNodes, WorkTogetherAndEndCleanlyOnSigint) {
  const std::vector<std::string> names{"segmentation", "classification", "overlay", "lcm_bridge"};
  std::map<std::string, pid_t> nodes;
  for (const std::string& name : names) nodes[name] = startNode(name);
  ros::NodeHandle node("/nodes");
  Listener<Objects> listener(node, "objects");
  Listener<sensor_msgs::Image> overlays(node, "overlay/image_raw");
  const Camera10Hz camera("/nodes");
  EXPECT_TRUE(eventually(15, [&] { return listener.count() > 0 && overlays.count() > 0; }));
  for (const std::string& name : names) EXPECT_EQ(exitStatusAfterSigint(nodes[name]), 0) << name;
}

}  // namespace
}  // namespace voxid

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "bridge_test");
  return voxid::test::runAll();
}
