// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <voxid/AlignObject.h>
#include <voxid/AlignedModels.h>
#include <voxid/ClassifyCloud.h>
#include <voxid/ConfirmObject.h>
#include <voxid/Segments.h>

#include <Eigen/Geometry>
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "params.h"
#include "pose_board.h"
#include "recogniser.h"
#include "voxid/library/aligned_naming.h"
#include "voxid/library/model_aligner.h"

namespace voxid {

/// A frame that was answered.
struct AnsweredFrame {
  sensor_msgs::ImageConstPtr image;
  sensor_msgs::CameraInfoConstPtr info;
  SegmentsConstPtr segments;
  ObjectsConstPtr objects;  ///< in the order of the segments
  Eigen::Isometry3d target_from_camera = Eigen::Isometry3d::Identity();
};

/// Aligns CAD models with objects, names them by it, and answers align_object, classify_cloud and confirm_object, in
/// a thread of its own that gives way to the frames' (nice 10); publishes the surfaces of aligned models. Of the
/// parameters align, align_names, align_percent, models and confirmed_sizes.
class PoseFinder {
 public:
  ~PoseFinder();

  /// `params`: how clouds are to be classified; called from the thread.
  void start(ros::NodeHandle node, const ClassificationStartParams& at_start, std::function<ClassifyParams()> params);

  /// Poses that were found in an index before are forgotten.
  void setIndex(const std::shared_ptr<const Index>& index, const std::shared_ptr<AnswerScope>& scope);
  /// Fills the objects' model_pose, and the answers, in their order, that alignment knows better. Never waits for an
  /// alignment; nor does any other call of the frame's thread.
  void show(int min_score_permille, Objects* objects, std::vector<Answer>* answers);
  /// The newest frame, for the thread to work on.
  void offer(AnsweredFrame frame);

  std::string trouble() const;  ///< why poses stay unknown; empty if nothing stands in the way

 private:
  enum class Mode { Off, Selected, All };
  /// Of one index; the thread's own.
  struct Tools {
    Tools(const std::shared_ptr<const Index>& of, const std::shared_ptr<AnswerScope>& with, const std::string& models)
        : index(of), scope(with), recogniser(of, with), aligner(of, models), naming(of, models) {}
    std::shared_ptr<const Index> index;
    std::shared_ptr<AnswerScope> scope;
    Recogniser recogniser;
    ModelAligner aligner;  // without ~align_names
    AlignedNaming naming;  // with it
    AlignedModels aligned;
  };

  static Mode modeOf(const std::string& name, std::string* trouble);
  void run();
  bool alignNext();
  Tools* tools();
  AnsweredFrame frame() const;
  std::uint64_t indices() const;
  AlignedObject alignAndKeep(const AnsweredFrame& frame, std::size_t object);
  AlignedObject align(const AnsweredFrame& frame, std::size_t object);
  AlignedObject align(Tools& tools, const ObservedObject& object, const ClassifyParams& params,
                      std::optional<std::uint32_t> named);
  AlignedObject poseOf(Tools& tools, const ObservedObject& object, const Nearest& nearest);
  AlignedObject nameOf(Tools& tools, const ObservedObject& object, const Nearest& nearest, int min_score_permille,
                       std::optional<std::uint32_t> named);
  void publishSurface(const AlignedObject& found);
  bool onAlign(AlignObject::Request& request, AlignObject::Response& response);
  bool onClassify(ClassifyCloud::Request& request, ClassifyCloud::Response& response);
  bool onConfirm(ConfirmObject::Request& request, ConfirmObject::Response& response);
  Result<std::string> confirm(std::uint32_t number, const std::string& category);
  Answer confirmedAnswer(const DepthView& depth, Span<const std::uint32_t> pixels, std::uint32_t category);
  void setTrouble(const std::string& sentence);

  Mode mode_ = Mode::Off;
  std::string models_;
  int percent_ = 50;
  bool names_ = true;
  bool keeps_sizes_ = false;
  std::function<ClassifyParams()> params_;
  PoseBoard board_;
  std::unique_ptr<Tools> tools_;
  ros::SteadyTime resting_until_;

  mutable std::mutex mutex_;  // held for copies only
  std::shared_ptr<const Index> index_;
  std::shared_ptr<AnswerScope> scope_;
  std::uint64_t indices_ = 0;  // so many so far
  AnsweredFrame frame_;
  std::string trouble_;

  ros::CallbackQueue queue_;
  ros::Publisher aligned_models_;
  ros::ServiceServer align_, classify_, confirm_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace voxid
