// SPDX-License-Identifier: BSD-3-Clause
#include "classification_nodelet.h"

#include <algorithm>
#include <functional>
#include <pluginlib/class_list_macros.hpp>
#include <utility>

#include "seconds.h"
#include "stopwatch.h"
#include "transform_at.h"
#include "turns.h"

namespace voxid {
namespace {

constexpr auto kOk = static_cast<std::uint8_t>(SceneStatus::Ok);
constexpr auto kBadInput = static_cast<std::uint8_t>(SceneStatus::BadInput);
constexpr auto kNoIndex = static_cast<std::uint8_t>(SceneStatus::NoIndex);
constexpr auto kNoTransform = static_cast<std::uint8_t>(SceneStatus::NoTransform);

void setStatus(std::uint8_t status, const std::string& sentence, Objects* objects) {
  objects->status = status;
  objects->status_text = sentence;
}

}  // namespace

ClassificationNodelet::~ClassificationNodelet() {
  const std::lock_guard<std::mutex> turn(subscriptionTurn());
  closing_ = true;  // a listener may leave while the members go
  unsubscribe();
}

void ClassificationNodelet::onInit() {
  ros::NodeHandle& node = getNodeHandle();
  health_.start(node, getPrivateNodeHandle(), getName());
  checkTypes<ClassificationConfig>(getPrivateNodeHandle());
  config_ = std::make_unique<dynamic_reconfigure::Server<ClassificationConfig>>(getPrivateNodeHandle());
  config_->setCallback([this](ClassificationConfig& config, std::uint32_t) { onConfig(config); });
  const ClassificationStartParams at_start = classificationStartParams(getPrivateNodeHandle());
  target_frame_ = at_start.target_frame;
  transform_tolerance_ms_ = at_start.transform_tolerance_ms;
  remembers_ = at_start.memory;
  categories_ = at_start.categories;
  size_ = at_start.size;
  confirmed_sizes_ = at_start.confirmed_sizes;
  startTransforms();
  poses_.start(node, at_start, [this] { return params(); });
  watch_.start(at_start.index, at_start.watch_index);
  followIndex(watch_.index() != nullptr);
  if (!watch_.trouble().empty()) health_.reason(Health::Level::Warn, watch_.trouble());

  frames_ = std::make_unique<Frame>(8, image_, info_, segments_, this, &ClassificationNodelet::onFrame,
                                    [this] { health_.dropped(); });

  // The callback may come before advertise has returned, and then must wait for the publisher.
  const std::lock_guard<std::mutex> turn(subscriptionTurn());
  const ros::SubscriberStatusCallback changed = [this](const ros::SingleSubscriberPublisher&) { onListeners(); };
  objects_ = node.advertise<Objects>("objects", 2, changed, changed);
}

void ClassificationNodelet::onListeners() {
  const std::lock_guard<std::mutex> turn(subscriptionTurn());
  if (closing_) return;
  const bool wanted = objects_.getNumSubscribers() > 0;
  const bool subscribed = static_cast<bool>(segments_.getSubscriber());
  if (wanted == subscribed) return;
  health_.listening(wanted);
  if (wanted) {
    // Segments come last; of those only the newest is kept, so that a late frame never delays the next.
    image_.subscribe(getNodeHandle(), "depth/image_raw", 8);
    info_.subscribe(getNodeHandle(), "depth/camera_info", 8);
    segments_.subscribe(getNodeHandle(), "segments", 1);
  } else {
    unsubscribe();
  }
}

void ClassificationNodelet::unsubscribe() {
  image_.unsubscribe();
  info_.unsubscribe();
  segments_.unsubscribe();
}

void ClassificationNodelet::onFrame(const sensor_msgs::ImageConstPtr& image,
                                    const sensor_msgs::CameraInfoConstPtr& info, const SegmentsConstPtr& segments) {
  const Stopwatch watch;
  const double helped_ms = helpersCpuMs();
  followIndex(watch_.refresh());
  const auto objects = objectsFor(*image, *segments);
  const Result<DepthView> depth = viewFor(*image, *info, *segments);
  if (depth.ok())
    nameAll(depth.value, *segments, moveFor(image->header), objects.get());
  else
    refuse(depth.status.sentence, objects.get());
  const TargetMove move = moveFor(image->header);  // again: that of the stamp may have come while objects were named
  moveToTarget(move, objects.get());
  fillAnswers(objects.get());
  objects->classify_ms = watch.ms();
  objects->latency_ms = static_cast<float>(secondsBetween(image->header.stamp, ros::Time::now()) * 1e3);
  objects_.publish(objects);
  if (depth.ok()) poses_.offer({image, info, segments, objects, move.target_from_camera});
  report(*objects, depth.status);
  health_.cost(watch.ms(), watch.cpuMs() + std::max(0.0, helpersCpuMs() - helped_ms));
}

void ClassificationNodelet::refuse(const std::string& sentence, Objects* objects) {
  setStatus(kBadInput, sentence, objects);
  spares_.resize(0, &objects->objects);
  answers_.clear();
}

Result<DepthView> ClassificationNodelet::viewFor(const sensor_msgs::Image& image, const sensor_msgs::CameraInfo& info,
                                                 const Segments& segments) {
  Result<DepthView> depth = viewOf(image, info);
  if (depth.ok() && segments.status != kBadInput && !fit(segments, depth.value))
    return Status::badUse("segments name pixels outside the depth image: they were made from another one");
  return depth;
}

boost::shared_ptr<Objects> ClassificationNodelet::objectsFor(const sensor_msgs::Image& image,
                                                             const Segments& segments) {
  const boost::shared_ptr<Objects> objects = pool_.take();
  objects->header = image.header;
  objects->camera_frame = image.header.frame_id;
  objects->status = segments.status;
  objects->status_text = statusText(segments.status);
  objects->table = segments.table;
  objects->index.clear();
  objects->dropped = segments.dropped;
  objects->segment_ms = segments.segment_ms;
  return objects;
}

double ClassificationNodelet::helpersCpuMs() const { return recognisers_ ? recognisers_->helpersCpuMs() : 0; }

RecogniserPool* ClassificationNodelet::recognisers(int threads) {
  if (watch_.index() && (!recognisers_ || recognisers_->threads() != threads))
    recognisers_ = std::make_unique<RecogniserPool>(watch_.index(), scope_, threads);
  return recognisers_.get();
}

void ClassificationNodelet::nameAll(const DepthView& depth, const Segments& segments, const TargetMove& move,
                                    Objects* objects) {
  const ClassifyParams wanted = params();
  RecogniserPool* const recognisers = this->recognisers(wanted.threads);
  pixels_.clear();
  answers_.clear();
  for (const Segment& segment : segments.segments) pixels_.push_back({segment.pixels.data(), segment.pixels.size()});
  spares_.resize(pixels_.size(), &objects->objects);
  // Poses that did not come into the target frame cannot be compared with those before.
  const bool remembered = memory_ && move.trouble.empty() && segments.status != kBadInput;
  if (remembered) follow(segments, move);
  const auto fill = [&](std::size_t i) {
    const Segment& segment = segments.segments[i];
    const Span<const std::uint32_t> pixels{segment.pixels.data(), segment.pixels.size()};
    const Primitive solid = remembered ? memory_->solidOf(i, depth, pixels, boxOf(segment), move.target_from_camera)
                                       : primitiveOf(depth, pixels, boxOf(segment));
    fillObject(segment, solid, &objects->objects[i]);
  };
  if (!recognisers) {
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      fill(i);
      objects->objects[i].alternatives.clear();
    }
    if (objects->status == kOk) setStatus(kNoIndex, watch_.trouble(), objects);
    return;
  }
  due_.assign(pixels_.size(), true);
  if (remembered) leaveOutWhatIsKnown();
  const std::vector<Answer>& answers =
      recognisers->recogniseAll(depth, {pixels_.data(), pixels_.size()}, wanted, std::ref(fill));
  answers_.assign(answers.begin(), answers.end());
  if (remembered) remember(objects);
  objects->index = recognisers->index().path();
}

ClassificationNodelet::TargetMove ClassificationNodelet::moveFor(const std_msgs::Header& header) const {
  TargetMove move;
  move.wanted = transforms_ && header.frame_id != target_frame_;
  if (!move.wanted) return move;
  try {
    const auto found = transformAt(*transforms_, target_frame_, header.frame_id, header.stamp, transform_tolerance_ms_);
    move.target_from_camera = eigenOf(found.transform);
  } catch (const tf2::TransformException& error) {
    move.trouble = error.what();
  }
  return move;
}

void ClassificationNodelet::moveToTarget(const TargetMove& move, Objects* objects) {
  if (!move.wanted) return;
  if (!move.trouble.empty()) {
    if (!objects->objects.empty())
      setStatus(kNoTransform, std::string(statusText(kNoTransform)) + " (" + move.trouble + ")", objects);
    return;
  }
  transform(move.target_from_camera, objects);
  objects->header.frame_id = target_frame_;
}

void ClassificationNodelet::follow(const Segments& segments, const TargetMove& move) {
  const Eigen::Isometry3d& target_from_camera = move.target_from_camera;
  sightings_.clear();
  for (const Segment& segment : segments.segments) {
    const Eigen::Vector3d position_m = target_from_camera * eigenOf(segment.pose.position);
    sightings_.push_back({position_m.cast<float>(), eigenOf(segment.extents_m).cast<float>()});
  }
  const Eigen::Vector3d up = target_from_camera.rotation() * eigenOf(segments.table.normal);
  memory_->update(microsecondsOf(segments.header.stamp), up.cast<float>(), {sightings_.data(), sightings_.size()},
                  memoryParams());
}

// An object without pixels is not described. New parameters are in effect in the next frame, for all objects.
void ClassificationNodelet::leaveOutWhatIsKnown() {
  const bool all = takeNewParams();
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    due_[i] = all || memory_->isDue(i);
    if (!due_[i]) pixels_[i] = {};
  }
}

void ClassificationNodelet::remember(Objects* objects) {
  const Index& index = recognisers_->index();
  const int min_score_permille = params().min_score_permille;
  for (std::size_t i = 0; i < answers_.size(); ++i) {
    answers_[i] = due_[i] ? memory_->remember(i, index, answers_[i], min_score_permille)
                          : memory_->recall(i, index, min_score_permille);
    objects->objects[i].number = memory_->numberOf(i);
  }
}

void ClassificationNodelet::fillAnswers(Objects* objects) {
  poses_.show(params().min_score_permille, objects, &answers_);
  for (std::size_t i = 0; i < answers_.size(); ++i)
    fillAnswer(answers_[i], recognisers_->index(), &objects->objects[i]);
}

void ClassificationNodelet::report(const Objects& objects, const Status& input) {
  health_.frame(objects.header.stamp, statusName(objects.status));
  if (!input.ok())
    health_.reason(Health::Level::Error, input.sentence);
  else if (!watch_.trouble().empty())
    health_.reason(Health::Level::Warn, watch_.trouble());
  else if (objects.status == kNoTransform)
    health_.reason(Health::Level::Warn, "no transform from '" + objects.camera_frame + "' to '" + target_frame_ +
                                            "' at the depth frame's stamp: poses stay in the camera's frame");
  else
    health_.reason(trouble().empty() ? Health::Level::Ok : Health::Level::Warn, trouble());
}

std::string ClassificationNodelet::trouble() const {
  return scope_ && !scope_->trouble().empty() ? scope_->trouble() : poses_.trouble();
}

void ClassificationNodelet::followIndex(bool replaced) {
  if (replaced) {
    recognisers_.reset();  // of the index before; the next frame makes new ones
    scope_ = std::make_shared<AnswerScope>(*watch_.index(), categories_, size_, confirmed_sizes_);
    recognisers(params().threads);
    poses_.setIndex(watch_.index(), scope_);
    const std::uint32_t last_number = memory_ ? memory_->lastNumber() : 0;
    if (remembers_) memory_ = std::make_unique<ObjectMemory>(watch_.index()->categories().size, last_number);
    NODELET_INFO("index %s: %u models, %u views", watch_.index()->path().c_str(), watch_.index()->header().models,
                 watch_.index()->header().views);
  }
}

void ClassificationNodelet::startTransforms() {
  if (target_frame_.empty()) return;
  transforms_ = std::make_unique<tf2_ros::Buffer>();
  transform_listener_ = std::make_unique<tf2_ros::TransformListener>(*transforms_);
}

void ClassificationNodelet::onConfig(const ClassificationConfig& config) {
  const std::lock_guard<std::mutex> lock(params_mutex_);
  params_ = paramsOf(config);
  memory_params_ = memoryParamsOf(config);
  params_are_new_ = true;
}

bool ClassificationNodelet::takeNewParams() {
  const std::lock_guard<std::mutex> lock(params_mutex_);
  return std::exchange(params_are_new_, false);
}

ClassifyParams ClassificationNodelet::params() const {
  const std::lock_guard<std::mutex> lock(params_mutex_);
  return params_;
}

MemoryParams ClassificationNodelet::memoryParams() const {
  const std::lock_guard<std::mutex> lock(params_mutex_);
  return memory_params_;
}

}  // namespace voxid

PLUGINLIB_EXPORT_CLASS(voxid::ClassificationNodelet, nodelet::Nodelet)
