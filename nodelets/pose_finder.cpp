// SPDX-License-Identifier: BSD-3-Clause
#include "pose_finder.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "cloud_patch.h"
#include "conversions.h"
#include "model_pose.h"
#include "voxid/geometry/object_memory.h"

namespace voxid {
namespace {

constexpr int kNice = 10;
constexpr double kWaiting_s = 0.02, kIdle_s = 0.2;  // between looks for a new frame; services wake the thread

void giveWay() { setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kNice); }

SupportPlane supportOf(const TablePlane& table) {
  return {eigenOf(table.normal).cast<float>(), table.distance_m * 1e3f};
}

AlignedObject stateOnly(std::uint8_t status) {
  AlignedObject object;
  object.pose.status = status;
  return object;
}

AlignedObject posed(const Index& index, std::uint32_t model, const std::shared_ptr<const ShelvedModel>& shelved,
                    const Alignment& alignment) {
  AlignedObject found;
  found.model = shelved;
  found.pose = modelPoseOf(alignment, shelved->model.surface(), shelved->symmetry());
  found.pose.label = std::string(index.categoryName(index.models()[model].category));
  found.pose.model = std::string(index.modelName(model));
  found.misfit = alignment.misfit;
  return found;
}

constexpr char kNoIndex[] = "no index is loaded to compare with";
constexpr char kNoFrame[] = "no frame has been answered yet: frames are, while somebody listens to objects";

std::string notShown(std::uint32_t number) {
  return "the newest frame shows no object with number " + std::to_string(number);
}

/// Where the object of this number is in a list; none, too, for number 0.
std::optional<std::size_t> placeOf(const Objects& objects, std::uint32_t number) {
  for (std::size_t i = 0; i < objects.objects.size(); ++i) {
    if (number != 0 && objects.objects[i].number == number) return i;
  }
  return {};
}

std::optional<std::uint32_t> categoryNamed(const Index& index, const std::string& name) {
  for (std::uint32_t i = 0; i < index.categories().size; ++i) {
    if (index.categoryName(i) == name) return i;
  }
  return {};
}

/// It is `first` for certain; what else it was taken for keeps its order.
Answer certainly(Alternative first, const Answer& by_codes) {
  Answer answer;
  answer.margin_permille = by_codes.margin_permille;
  answer.score_permille = first.score_permille = 1000;
  answer.alternatives[0] = first;
  answer.count = 1;
  for (int i = 0; i < by_codes.count && answer.count < Answer::kMaxAlternatives; ++i) {
    Alternative other = by_codes.alternatives[static_cast<std::size_t>(i)];
    other.score_permille = 0;
    if (other.category != first.category) answer.alternatives[static_cast<std::size_t>(answer.count++)] = other;
  }
  return answer;
}

/// Mean of the points, metres.
Eigen::Vector3d centroidOf(const DepthView& depth, Span<const std::uint32_t> pixels) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::uint32_t pixel : pixels) {
    const auto width = static_cast<std::uint32_t>(depth.width_px);
    const int u = static_cast<int>(pixel % width), v = static_cast<int>(pixel / width);
    const PointUm p = backProject(depth.camera, u, v, depth.depthUm(u, v));
    sum += Eigen::Vector3d(p.x, p.y, p.z);
  }
  return sum * 1e-6 / static_cast<double>(std::max<std::size_t>(1, pixels.size));
}

}  // namespace

PoseFinder::~PoseFinder() {
  stop_ = true;
  align_.shutdown();
  classify_.shutdown();
  confirm_.shutdown();
  queue_.disable();
  if (thread_.joinable()) thread_.join();
}

void PoseFinder::start(ros::NodeHandle node, const ClassificationStartParams& at_start,
                       std::function<ClassifyParams()> params) {
  params_ = std::move(params);
  models_ = at_start.models;
  percent_ = at_start.align_percent;
  names_ = at_start.align_names;
  keeps_sizes_ = !at_start.confirmed_sizes.empty();
  std::string trouble;
  mode_ = modeOf(at_start.align, &trouble);
  if (mode_ != Mode::Off && !at_start.memory) {
    mode_ = Mode::Off;
    trouble = "~align needs ~memory, as a pose is that of an object that keeps its number: poses stay unknown";
  }
  setTrouble(trouble);
  node.setCallbackQueue(&queue_);
  constexpr bool kLatched = true;
  aligned_models_ = node.advertise<AlignedModels>("aligned_models", 1, kLatched);
  align_ = node.advertiseService("align_object", &PoseFinder::onAlign, this);
  classify_ = node.advertiseService("classify_cloud", &PoseFinder::onClassify, this);
  confirm_ = node.advertiseService("confirm_object", &PoseFinder::onConfirm, this);
  thread_ = std::thread([this] { run(); });
}

PoseFinder::Mode PoseFinder::modeOf(const std::string& name, std::string* trouble) {
  if (name == "selected") return Mode::Selected;
  if (name == "all") return Mode::All;
  if (name != "off") *trouble = "~align is '" + name + "', expected off, selected or all: poses stay unknown";
  return Mode::Off;
}

void PoseFinder::setIndex(const std::shared_ptr<const Index>& index, const std::shared_ptr<AnswerScope>& scope) {
  const std::lock_guard<std::mutex> lock(mutex_);
  index_ = index;
  scope_ = scope;
  ++indices_;
  frame_ = {};
  board_.clear();
}

void PoseFinder::show(int min_score_permille, Objects* objects, std::vector<Answer>* answers) {
  if (mode_ == Mode::Off && board_.empty()) return;
  const bool all = mode_ == Mode::All;
  const std::uint8_t status = all ? ModelPose::WAITING : mode_ == Mode::Off ? ModelPose::OFF : ModelPose::NOT_SELECTED;
  board_.show({status, all && names_}, min_score_permille, objects, answers);
}

void PoseFinder::offer(AnsweredFrame frame) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::swap(frame_, frame);  // the one before is let go outside
}

std::string PoseFinder::trouble() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return trouble_;
}

void PoseFinder::setTrouble(const std::string& sentence) {
  const std::lock_guard<std::mutex> lock(mutex_);
  trouble_ = sentence;
}

AnsweredFrame PoseFinder::frame() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return frame_;
}

std::uint64_t PoseFinder::indices() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return indices_;
}

void PoseFinder::run() {
  giveWay();
  while (!stop_) {
    const bool busy = mode_ == Mode::All && alignNext();
    queue_.callAvailable(ros::WallDuration(busy ? 0 : mode_ == Mode::All ? kWaiting_s : kIdle_s));
  }
}

/// False if there was nothing to do, or no time left for it.
bool PoseFinder::alignNext() {
  if (ros::SteadyTime::now() < resting_until_) return false;
  const AnsweredFrame newest = frame();
  if (!newest.objects) return false;
  const auto object = board_.next(*newest.objects);
  if (!object) return false;
  const ros::SteadyTime began = ros::SteadyTime::now();
  alignAndKeep(newest, *object);
  const ros::SteadyTime ended = ros::SteadyTime::now();
  resting_until_ = ended + (ended - began) * (100.0 / percent_ - 1);
  return true;
}

/// While it is aligned, an index with other categories may come.
AlignedObject PoseFinder::alignAndKeep(const AnsweredFrame& frame, std::size_t object) {
  const std::uint64_t before = indices();
  const AlignedObject found = align(frame, object);
  publishSurface(found);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (indices_ == before) board_.put(frame.objects->objects[object], frame.image->header.stamp, found);
  return found;
}

/// Publishes its surface, unless that was done before.
void PoseFinder::publishSurface(const AlignedObject& found) {
  if (!found.model) return;
  std::vector<AlignedModel>& models = tools_->aligned.models;
  const bool known = std::any_of(models.begin(), models.end(), [&](const AlignedModel& model) {
    return model.label == found.pose.label && model.model == found.pose.model;
  });
  if (known) return;
  if (models.size() == ObjectMemory::kMostTracks) models.erase(models.begin());
  models.push_back(alignedModelOf(found.model->model.surface()));
  models.back().label = found.pose.label;
  models.back().model = found.pose.model;
  aligned_models_.publish(tools_->aligned);
}

PoseFinder::Tools* PoseFinder::tools() {
  std::shared_ptr<const Index> index;
  std::shared_ptr<AnswerScope> scope;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    index = index_;
    scope = scope_;
  }
  if (!index) tools_.reset();
  if (index && (!tools_ || tools_->index != index)) tools_ = std::make_unique<Tools>(index, scope, models_);
  return tools_.get();
}

AlignedObject PoseFinder::align(const AnsweredFrame& frame, std::size_t object) {
  Tools* const tools = this->tools();
  const Result<DepthView> depth = viewOf(*frame.image, *frame.info);
  if (!tools || !depth.ok() || object >= frame.segments->segments.size()) return stateOnly(ModelPose::NOT_FOUND);
  const std::vector<std::uint32_t>& pixels = frame.segments->segments[object].pixels;
  ObservedObject observed;
  observed.depth = depth.value;
  observed.pixels = {pixels.data(), pixels.size()};
  observed.support = supportOf(frame.segments->table);
  const auto named = board_.categoryOf(frame.objects->objects[object]);
  AlignedObject found = align(*tools, observed, params_(), named);
  if (found.pose.status == ModelPose::ALIGNED) found.pose.stamp = frame.image->header.stamp;
  transform(frame.target_from_camera, &found.pose);
  return found;
}

/// `named`: the category that the object was named before; it is then looked for alone.
AlignedObject PoseFinder::align(Tools& tools, const ObservedObject& object, const ClassifyParams& params,
                                std::optional<std::uint32_t> named) {
  const Nearest* const nearest = tools.recogniser.nearest(object.depth, object.pixels, params, named);
  if (!nearest) return stateOnly(ModelPose::NOT_FOUND);
  if (names_) return nameOf(tools, object, *nearest, params.min_score_permille, named);
  return poseOf(tools, object, *nearest);
}

AlignedObject PoseFinder::poseOf(Tools& tools, const ObservedObject& object, const Nearest& nearest) {
  const auto ranked = tools.aligner.rank(object, nearest);
  setTrouble(ranked.status.sentence);
  if (!ranked.ok()) return stateOnly(ModelPose::NO_SURFACE);
  const auto best = std::find_if(ranked.value.begin(), ranked.value.end(),
                                 [](const RankedModel& model) { return model.alignment.found; });
  if (best == ranked.value.end()) return stateOnly(ModelPose::NOT_FOUND);
  const auto shelved = tools.aligner.shelf().find(best->model);
  if (!shelved.ok()) return stateOnly(ModelPose::NO_SURFACE);
  return posed(*tools.index, best->model, shelved.value, best->alignment);
}

AlignedObject PoseFinder::nameOf(Tools& tools, const ObservedObject& object, const Nearest& nearest,
                                 int min_score_permille, std::optional<std::uint32_t> named) {
  auto candidates = tools.naming.candidates(tools.recogniser.code().data(), nearest);
  setTrouble(candidates.status.sentence);
  if (!candidates.ok()) return stateOnly(ModelPose::NO_SURFACE);
  tools.naming.sketch(object, candidates.value);
  Answer name;
  if (!named) name = tools.naming.name(nearest, candidates.value, min_score_permille);
  const auto best = tools.naming.pose(candidates.value, named ? *named : name.alternatives[0].category);
  if (best.model == nullptr) return stateOnly(ModelPose::NOT_FOUND);
  AlignedObject found = posed(*tools.index, best.model->model, best.model->shelved, best.alignment);
  found.name = name;
  return found;
}

bool PoseFinder::onAlign(AlignObject::Request& request, AlignObject::Response& response) {
  const AnsweredFrame newest = frame();
  response.model_pose.status = ModelPose::OFF;
  if (mode_ == Mode::Off) {
    response.message = trouble().empty() ? "~align is off: set it to selected or all" : trouble();
    return true;
  }
  if (!newest.objects) {
    response.message = kNoFrame;
    return true;
  }
  response.header = newest.objects->header;
  const auto wanted = placeOf(*newest.objects, request.number);
  if (!wanted) {
    response.message = notShown(request.number);
    return true;
  }
  const AlignedObject found = alignAndKeep(newest, *wanted);
  response.model_pose = found.pose;
  response.success = found.pose.status == ModelPose::ALIGNED;
  if (found.pose.status == ModelPose::NO_SURFACE) response.message = trouble();
  if (found.pose.status == ModelPose::NOT_FOUND) response.message = "too few points to align a model with";
  return true;
}

bool PoseFinder::onClassify(ClassifyCloud::Request& request, ClassifyCloud::Response& response) {
  Tools* const tools = this->tools();
  if (!tools) {
    response.message = kNoIndex;
    return true;
  }
  const Result<CloudPatch> patch = CloudPatch::of(request.cloud);
  response.message = patch.status.sentence;
  if (!patch.ok()) return true;
  ObservedObject observed;
  observed.depth = patch.value.view();
  observed.pixels = patch.value.pixels();
  const ClassifyParams params = params_();
  Answer answer = tools->recogniser.recognise(observed.depth, observed.pixels, params);
  if (request.align) {
    const AlignedObject found = align(*tools, observed, params, {});
    response.object.model_pose = found.pose;
    if (found.name.count > 0) answer = found.name;
  }
  fillAnswer(answer, *tools->index, &response.object);
  response.object.points = static_cast<std::uint32_t>(observed.pixels.size);
  response.object.centroid = pointOf(centroidOf(observed.depth, observed.pixels));
  response.success = !response.object.alternatives.empty();
  if (!response.success) response.message = "the points have no extent";
  if (response.object.model_pose.status == ModelPose::NO_SURFACE) response.message = trouble();
  return true;
}

bool PoseFinder::onConfirm(ConfirmObject::Request& request, ConfirmObject::Response& response) {
  const Result<std::string> confirmed = confirm(request.number, request.category);
  response.success = confirmed.ok();
  response.message = confirmed.ok() ? confirmed.value : confirmed.status.sentence;
  return true;
}

/// Says how long the object is.
Result<std::string> PoseFinder::confirm(std::uint32_t number, const std::string& category) {
  const std::uint64_t before = indices();
  const AnsweredFrame newest = frame();
  Tools* const tools = this->tools();
  if (!newest.objects) return Status::cannotDo(kNoFrame);
  if (!tools) return Status::cannotDo(kNoIndex);
  const auto wanted = placeOf(*newest.objects, number);
  if (!wanted) return Status::cannotDo(notShown(number));
  const auto known = categoryNamed(*tools->index, category);
  if (!known) return Status::cannotDo("the index has no category '" + category + "'");
  const Result<DepthView> depth = viewOf(*newest.image, *newest.info);
  if (!depth.ok()) return depth.status;
  const std::vector<std::uint32_t>& listed = newest.segments->segments[*wanted].pixels;
  const Span<const std::uint32_t> pixels{listed.data(), listed.size()};
  const int longest_mm = static_cast<int>(std::lround(LongestExtent().of_mm(depth.value, pixels)));
  const Status kept = keeps_sizes_ ? tools->scope->confirm(*tools->index, category, longest_mm) : Status{};
  if (!kept.ok()) return kept;
  const Answer answer = confirmedAnswer(depth.value, pixels, *known);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (indices_ == before) board_.confirm(newest.objects->objects[*wanted], newest.image->header.stamp, answer);
  return category + ": " + std::to_string(longest_mm) + (keeps_sizes_ ? " mm, kept" : " mm");
}

/// With the view of the category that is nearest.
Answer PoseFinder::confirmedAnswer(const DepthView& depth, Span<const std::uint32_t> pixels, std::uint32_t category) {
  Recogniser& recogniser = tools_->recogniser;
  const ClassifyParams params = params_();
  const Answer by_codes = recogniser.recognise(depth, pixels, params);
  Alternative confirmed;
  confirmed.category = category;
  const Nearest* const nearest = recogniser.nearest(depth, pixels, params, category);
  if (nearest && !nearest->views.empty()) {
    confirmed.view = nearest->views[0].view;
    confirmed.distance = nearest->views[0].distance;
  }
  return certainly(confirmed, by_codes);
}

}  // namespace voxid
