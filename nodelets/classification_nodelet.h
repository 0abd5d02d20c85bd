// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/server.h>
#include <message_filters/subscriber.h>
#include <nodelet/nodelet.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "conversions.h"
#include "frame_sync.h"
#include "health.h"
#include "index_watch.h"
#include "message_pool.h"
#include "params.h"
#include "pose_finder.h"
#include "recogniser_pool.h"
#include "voxid/geometry/object_memory.h"

namespace voxid {

/// depth/image_raw + depth/camera_info + segments of one stamp -> objects, one message a frame. Parameters: params.h.
/// With memory what earlier frames said about an object counts, too, and it keeps its number (doc/memory.md). Poses of
/// models and the services: PoseFinder.
class ClassificationNodelet : public nodelet::Nodelet {
 public:
  ~ClassificationNodelet() override;

 protected:
  virtual void onFrame(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info,
                       const SegmentsConstPtr& segments);

 private:
  using Frame = FrameSync<sensor_msgs::Image, sensor_msgs::CameraInfo, Segments>;
  // From the camera's frame into ~target_frame at a frame's stamp.
  struct TargetMove {
    Eigen::Isometry3d target_from_camera = Eigen::Isometry3d::Identity();
    bool wanted = false;
    std::string trouble;  // why it is not known; empty: it is
  };

  void onInit() override;
  void onListeners();
  void unsubscribe();
  void onConfig(const ClassificationConfig& config);
  void startTransforms();
  void followIndex(bool replaced);
  Result<DepthView> viewFor(const sensor_msgs::Image& image, const sensor_msgs::CameraInfo& info,
                            const Segments& segments);
  boost::shared_ptr<Objects> objectsFor(const sensor_msgs::Image& image, const Segments& segments);
  RecogniserPool* recognisers(int threads);
  double helpersCpuMs() const;
  void refuse(const std::string& sentence, Objects* objects);
  TargetMove moveFor(const std_msgs::Header& header) const;
  void nameAll(const DepthView& depth, const Segments& segments, const TargetMove& move, Objects* objects);
  void follow(const Segments& segments, const TargetMove& move);
  void leaveOutWhatIsKnown();
  void remember(Objects* objects);
  void moveToTarget(const TargetMove& move, Objects* objects);
  void fillAnswers(Objects* objects);
  void report(const Objects& objects, const Status& input);
  std::string trouble() const;
  ClassifyParams params() const;
  MemoryParams memoryParams() const;
  bool takeNewParams();

  bool closing_ = false;
  mutable std::mutex params_mutex_;
  ClassifyParams params_;
  MemoryParams memory_params_;
  bool params_are_new_ = true;  // since the last frame
  IndexWatch watch_;
  std::string categories_;
  bool size_ = false;
  std::string confirmed_sizes_;
  std::shared_ptr<AnswerScope> scope_;  // of the index
  std::unique_ptr<RecogniserPool> recognisers_;
  std::vector<ObjectPixels> pixels_;  // of the frame's objects
  std::vector<Answer> answers_;       // to the frame's objects; empty without an index
  bool remembers_ = true;
  std::unique_ptr<ObjectMemory> memory_;
  std::vector<Sighting> sightings_;
  std::vector<bool> due_;  // of the frame's objects: described in it
  PoseFinder poses_;
  MessagePool<Objects> pool_;
  Spares<Object> spares_;
  std::string target_frame_;
  int transform_tolerance_ms_ = 0;
  std::unique_ptr<tf2_ros::Buffer> transforms_;
  std::unique_ptr<tf2_ros::TransformListener> transform_listener_;
  Health health_;
  ros::Publisher objects_;
  message_filters::Subscriber<sensor_msgs::Image> image_;
  message_filters::Subscriber<sensor_msgs::CameraInfo> info_;
  message_filters::Subscriber<Segments> segments_;
  std::unique_ptr<Frame> frames_;
  std::unique_ptr<dynamic_reconfigure::Server<ClassificationConfig>> config_;
};

}  // namespace voxid
