// SPDX-License-Identifier: BSD-3-Clause
// voxid classify: what an object is, or the objects of a scene.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "command.h"
#include "depth_file.h"
#include "evidence.h"
#include "recogniser.h"
#include "scene_json.h"
#include "segment_choice.h"
#include "voxid/core/coarse.h"
#include "voxid/geometry/segmenter.h"
#include "written_files.h"

namespace voxid::cli {
namespace {

struct Options {
  std::vector<std::string> files;
  std::string index;
  CameraChoice camera;
  SearchChoice search;
  EvidenceChoice evidence;
  std::string models, categories;
  SegmentChoice segment;
  bool scene = false, align = false, json = false, vote = false, one_nn = false;
  double min_score = ClassifyParams{}.min_score_permille / 1000.0;
  std::string plot, labels;

  ClassifyMethod method() const {
    if (vote || one_nn) return vote ? ClassifyMethod::Vote : ClassifyMethod::OneNn;
    return ClassifyParams{}.vote ? ClassifyMethod::Vote : ClassifyMethod::OneNn;
  }
  int minScorePermille() const { return static_cast<int>(std::lround(min_score * 1000)); }
};

/// Everything that lasts from frame to frame.
struct Session {
  const Options& options;
  EvidenceRecogniser recogniser;
  Segmenter segmenter;
  SegmentParams params;
  std::optional<Eigen::Vector3f> up;  ///< as SegmentChoice has it
};

/// What is said about one object.
struct Named {
  Answer answer;
  ObjectPose pose;  ///< with --align
};

Result<Named> nameOf(Session& session, const ObservedObject& object) {
  const auto answer =
      session.recogniser.recognise(object, session.options.method(), session.options.minScorePermille());
  if (!answer.ok()) return answer.status;
  Named named{answer.value, {}};
  if (!session.options.align || named.answer.count == 0) return named;
  auto pose = session.recogniser.pose(object, named.answer.alternatives[0].category);
  if (!pose.ok()) return pose.status;
  named.pose = std::move(pose.value);
  return named;
}

void addNamed(const Session& session, const Named& named, Json& object) {
  addAnswer(session.recogniser.index(), named.answer, object);
  if (session.options.align) object["pose"] = toJson(named.pose);
}

std::string rankedText(const Index& index, const Answer& answer) {
  std::string text;
  for (int i = 0; i < std::min(answer.count, 5); ++i) {
    const Alternative& a = answer.alternatives[static_cast<std::size_t>(i)];
    char score[32];
    std::snprintf(score, sizeof score, " %.3f", a.score_permille / 1000.0);
    text += (i ? ", " : "") + std::string(index.categoryName(a.category)) + score;
  }
  return text;
}

void printPose(const ObjectPose& pose) {
  const Alignment& a = pose.alignment;
  if (!a.found) return;
  std::printf("%-28s %s, diagonal %.0f mm, centre at %.0f %.0f %.0f mm, %.1f mm off, %.0f %% explained\n", "",
              pose.model.c_str(), static_cast<double>(a.pose.scale), static_cast<double>(a.pose.translation.x()),
              static_cast<double>(a.pose.translation.y()), static_cast<double>(a.pose.translation.z()),
              static_cast<double>(a.fit_mm), 100 * static_cast<double>(a.explained));
}

/// What can be told where the category cannot; empty where there is no more to tell.
std::string coarseText(const Index& index, const Answer& answer) {
  const CoarseAnswer coarse = coarseAnswer(index, answer);
  if (coarse.synset.empty() || coarse.is_category) return {};
  char score[32];
  std::snprintf(score, sizeof score, " %.3f", coarse.score_permille / 1000.0);
  return "  " + std::string(coarse.synset) + score;
}

void printRow(const Index& index, const Answer& answer, const std::string& what) {
  Json fields;
  addAnswer(index, answer, fields);
  const std::string view = fields["view"].is_null() ? "-" : std::to_string(fields["view"].get<int>());
  const auto label = fields["label"].get<std::string>(), model = fields["model"].get<std::string>();
  std::printf("%-28s %-18s %.3f  %s, view %s  [%s]%s\n", what.c_str(), label.empty() ? "?" : label.c_str(),
              answer.score_permille / 1000.0, model.empty() ? "-" : model.c_str(), view.c_str(),
              rankedText(index, answer).c_str(), coarseText(index, answer).c_str());
}

cv::Mat drawAnswer(const DepthView& depth, const Index& index, const Answer& answer) {
  cv::Mat picture = drawScene(depth, Scene{});
  for (int i = 0; i < answer.count; ++i) {
    const Alternative& a = answer.alternatives[static_cast<std::size_t>(i)];
    const std::string text =
        std::string(index.categoryName(a.category)) + " " + std::to_string(a.score_permille / 10) + " %";
    const int y = 20 * (i + 1);
    cv::rectangle(picture, {4, y - 12}, {4 + a.score_permille / 10, y + 3}, {150, 100, 40}, cv::FILLED);
    cv::putText(picture, text, {8, y}, cv::FONT_HERSHEY_SIMPLEX, 0.45, {255, 255, 255}, 1, cv::LINE_AA);
  }
  return picture;
}

Status writePlot(const Options& options, const std::string& file, const cv::Mat& picture) {
  return writeImage(plotPath(options.plot, file, options.files.size() == 1), picture);
}

/// The frame shows one object and nothing else.
Result<SceneStatus> classifyObject(Session& session, const DepthFile& file) {
  const DepthView depth = file.view();
  const std::vector<std::uint32_t> pixels = setPixels(depth);
  const auto named = nameOf(session, {depth, {pixels.data(), pixels.size()}, {}});
  if (!named.ok()) return named.status;
  const Answer& answer = named.value.answer;
  const Index& index = session.recogniser.index();
  if (session.options.json) {
    Json line;
    line["file"] = file.path;
    addNamed(session, named.value, line);
    line["pixels"] = pixels.size();
    std::cout << lineOf(line) << std::flush;
  } else {
    printRow(index, answer, file.path);
    printPose(named.value.pose);
  }
  if (!session.options.plot.empty()) {
    cv::Mat picture = drawAnswer(depth, index, answer);
    drawPose(depth, named.value.pose, colourOf(1), picture);
    const Status status = writePlot(session.options, file.path, picture);
    if (!status.ok()) return status;
  }
  return answer.count > 0 ? SceneStatus::Ok : SceneStatus::NoDepth;
}

void printScene(const Session& session, const std::string& file, const Scene& scene, const std::vector<Named>& named) {
  const Index& index = session.recogniser.index();
  if (!session.options.json) {
    std::printf("%s: %s, %s\n", file.c_str(), nameOf(scene.status), sentenceOf(scene.status));
    for (std::size_t i = 0; i < named.size(); ++i) {
      printRow(index, named[i].answer, "  object " + std::to_string(scene.clusters[i].id));
      printPose(named[i].pose);
    }
    return;
  }
  Json line = toJson(file, scene);
  for (std::size_t i = 0; i < named.size(); ++i) addNamed(session, named[i], line["objects"][i]);
  std::cout << lineOf(line) << std::flush;
}

Status writePictures(const Session& session, const DepthFile& file, const Scene& scene,
                     const std::vector<Named>& named) {
  const Options& options = session.options;
  if (!options.labels.empty()) {
    const Status status = writeLabels(options.labels, file.path, labelImage(scene, file.pixels.cols, file.pixels.rows));
    if (!status.ok()) return status;
  }
  if (options.plot.empty()) return {};
  std::vector<std::string> captions;
  for (const Named& one : named) captions.push_back(captionOf(session.recogniser.index(), one.answer));
  cv::Mat picture = drawScene(file.view(), scene);
  for (std::size_t i = 0; i < named.size(); ++i)
    drawPose(file.view(), named[i].pose, colourOf(scene.clusters[i].id), picture);
  writeCaptions(scene, captions, picture);
  return writePlot(options, file.path, picture);
}

/// The frame shows a table with objects.
Result<SceneStatus> classifyScene(Session& session, const DepthFile& file) {
  const Scene& scene = session.segmenter.segment(file.view(), session.params, session.up);
  std::vector<Named> named;
  const SupportPlane table{scene.table.normal, 1000 * scene.table.distance_m};
  for (const Cluster& cluster : scene.clusters) {
    auto one = nameOf(session, {file.view(), cluster.pixels, table});
    if (!one.ok()) return one.status;
    named.push_back(std::move(one.value));
  }
  printScene(session, file.path, scene, named);
  const Status written = writePictures(session, file, scene, named);
  if (!written.ok()) return written;
  return scene.status;
}

Status objectsStatus(const std::vector<SceneStatus>& frames, const std::string& first_file) {
  const auto isOk = [](SceneStatus s) { return s == SceneStatus::Ok; };
  if (std::any_of(frames.begin(), frames.end(), isOk)) return {};
  const std::string where =
      frames.size() == 1 ? first_file : "all " + std::to_string(frames.size()) + " frames, first " + first_file;
  return Status::nothingFound(where +
                              ": nothing to classify; expected an object's pixels, at least two of them apart, "
                              "with depth and all others 0 (whole scenes: --scene)");
}

Status classifyFiles(Session& session) {
  std::vector<SceneStatus> statuses;
  const Options& options = session.options;
  for (const std::string& path : options.files) {
    const Result<DepthFile> file = readDepthFile(path, options.camera);
    if (!file.ok()) return file.status;
    const auto status = options.scene ? classifyScene(session, file.value) : classifyObject(session, file.value);
    if (!status.ok()) return status.status;
    statuses.push_back(status.value);
  }
  return options.scene ? statusOf(statuses, options.files.front()) : objectsStatus(statuses, options.files.front());
}

Status run(const Options& options) {
  if (!options.scene && !(options.labels.empty() && options.segment.empty())) {
    return Status::badUse("classify: --labels, --set and --up are for whole scenes; add --scene");
  }
  if (options.evidence.align() && (options.vote || options.one_nn))
    return Status::badUse("classify: --vote and --1nn are ways of counting codes; --evidence align has its own");
  if (const Status fits = options.evidence.check(); !fits.ok()) return fits;
  const auto params = options.segment.params();
  if (!params.ok()) return params.status;
  const auto up = options.segment.up();
  if (!up.ok()) return up.status;
  if (const Status free = checkWritten(options.files, options.labels, options.plot); !free.ok()) return free;
  const auto index = Index::open(options.index);
  if (!index.ok()) return index.status;
  if (const Status fits = options.search.check(*index.value); !fits.ok()) return fits;
  if (options.align || options.evidence.align()) {
    const std::string option = options.align ? "--align" : "--evidence align";
    if (const Status known = checkSurfaces(option, *index.value, options.models); !known.ok()) return known;
  }
  Session session{options, EvidenceRecogniser(index.value, options.search, options.evidence, options.models),
                  Segmenter(), params.value, up.value};
  if (!options.categories.empty()) {
    auto allowed = readAllowedCategories(options.categories, *index.value);
    if (!allowed.ok()) return allowed.status;
    session.recogniser.restrictTo(std::move(allowed.value));
  }
  return classifyFiles(session);
}

}  // namespace

Run addClassify(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("files", options->files, "Depth images")->type_name("FILES")->required();
  app.add_option("--index", options->index, "The index (.vxi) to compare with")->type_name("FILE")->required();
  options->camera.addTo(app);
  app.add_flag("--scene", options->scene,
               "Find the table and name what stands on it; without, the set pixels are the object");
  app.add_flag("--json", options->json, "One object a frame and line");
  app.add_option("--categories", options->categories,
                 "A file of categories, one a line, that alone may be answers (cfg/table_top.txt)")
      ->type_name("FILE");
  options->evidence.addTo(app);
  app.add_flag("--align", options->align, "Where each object's model stands; with --plot it is drawn over the picture");
  app.add_option("--models", options->models,
                 "With --align, --evidence align: the folder that the index was made from, if it keeps no surfaces")
      ->type_name("DIR");
  options->search.addTo(app);
  CLI::Option* const vote = app.add_flag("--vote", options->vote, "The models of the 64 nearest views vote (default)");
  app.add_flag("--1nn", options->one_nn, "The nearest view alone decides")->excludes(vote);
  app.add_option("--min-score", options->min_score,
                 "Below this score (0 to 1) the label is left empty; alternatives stay")
      ->check(realRange(0.0, 1.0));
  options->segment.addTo(app, "With --scene: ");
  app.add_option("--labels", options->labels,
                 "With --scene: write each frame's objects to DIR/STEM.png, 16 bit, object id a pixel")
      ->type_name("DIR");
  app.add_option("--plot", options->plot, "Draw the answer; with several frames to PATH-STEM.png")
      ->type_name("PATH.png");
  return [options] { return run(*options); };
}

}  // namespace voxid::cli
