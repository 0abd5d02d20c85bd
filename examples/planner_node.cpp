// SPDX-License-Identifier: BSD-3-Clause
// What a grasp planner does with `objects`, as a plain ROS node: says where a gripper is to go for the nearest
// graspable thing of a wanted label (or coarser synset, "container.n.01", where no more is known), and asks for its
// model's pose where the chain aligns on demand (align:=selected).
//   rosrun voxid voxid_planner_node __ns:=/voxid [_label:=mug] [_opening:=0.08]
#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>
#include <voxid/AlignObject.h>
#include <voxid/Objects.h>

#include <cmath>
#include <string>

namespace {

double distanceOf(const voxid::Object& object) {
  const geometry_msgs::Point& p = object.pose.pose.position;
  return std::hypot(std::hypot(p.x, p.y), p.z);
}

/// 10 cm above the middle of the box's top. The box's z is the table's normal; turned by half about its x it points
/// down, and y, along the shorter side, is what the fingers close in.
geometry_msgs::Pose approachFromAbove(const voxid::Object& object) {
  constexpr double kAbove_m = 0.1;
  const geometry_msgs::Quaternion& q = object.pose.pose.orientation;
  const double height_m = object.extents_m.z / 2 + kAbove_m;
  geometry_msgs::Pose approach = object.pose.pose;
  approach.position.x += height_m * 2 * (q.x * q.z + q.w * q.y);
  approach.position.y += height_m * 2 * (q.y * q.z - q.w * q.x);
  approach.position.z += height_m * (1 - 2 * (q.x * q.x + q.y * q.y));
  approach.orientation.w = -q.x;
  approach.orientation.x = q.w;
  approach.orientation.y = q.z;
  approach.orientation.z = -q.y;
  return approach;
}

class Planner {
 public:
  Planner() {
    const ros::NodeHandle own("~");
    label_ = own.param<std::string>("label", "");
    opening_m_ = own.param("opening", 0.08);
    align_ = node_.serviceClient<voxid::AlignObject>("align_object");
    approach_ = node_.advertise<geometry_msgs::PoseStamped>("approach", 1, true);
    objects_ = node_.subscribe("objects", 1, &Planner::onObjects, this);
  }

 private:
  void onObjects(const voxid::ObjectsConstPtr& objects) {
    const voxid::Object* const object = nearestGraspable(*objects);
    if (!object) return;
    geometry_msgs::PoseStamped approach;
    approach.header = objects->header;
    approach.pose = approachFromAbove(*object);
    approach_.publish(approach);
    ROS_INFO("grasp number=%u label=%s distance_m=%.3f width_m=%.3f", object->number, object->label.c_str(),
             distanceOf(*object), object->extents_m.y);
    if (object->model_pose.status == voxid::ModelPose::NOT_SELECTED) select(object->number);
    if (object->model_pose.status == voxid::ModelPose::ALIGNED) say(object->model_pose);
  }

  const voxid::Object* nearestGraspable(const voxid::Objects& objects) const {
    const voxid::Object* nearest = nullptr;
    for (const voxid::Object& object : objects.objects) {
      const bool wanted = label_.empty() || object.label == label_ || object.coarse == label_;
      if (!wanted || object.truncated || object.extents_m.y > opening_m_) continue;
      if (!nearest || distanceOf(object) < distanceOf(*nearest)) nearest = &object;
    }
    return nearest;
  }

  /// The pose also comes with the messages from now on, while the object rests.
  void select(std::uint32_t number) {
    voxid::AlignObject call;
    call.request.number = number;
    if (!align_.call(call)) {
      ROS_WARN_THROTTLE(10, "align_object does not answer");
    } else if (!call.response.success) {
      ROS_WARN_THROTTLE(10, "no pose: %s", call.response.message.c_str());
    }
  }

  static void say(const voxid::ModelPose& model) {
    ROS_INFO("aligned model=%s/%s scale_m=%.3f fit_mm=%.1f rotation_known=%d", model.label.c_str(), model.model.c_str(),
             static_cast<double>(model.scale_m), static_cast<double>(model.fit_mm), model.rotation_known);
  }

  std::string label_;
  double opening_m_ = 0;
  ros::NodeHandle node_;
  ros::ServiceClient align_;
  ros::Publisher approach_;
  ros::Subscriber objects_;
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "voxid_planner");
  const Planner planner;
  ros::spin();
  return 0;
}
