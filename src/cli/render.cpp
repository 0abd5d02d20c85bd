// SPDX-License-Identifier: BSD-3-Clause
// voxid render: models, or a table with models on it, as a depth camera sees them.
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "picture_file.h"
#include "table_scene.h"
#include "voxid/library/mesh_reader.h"
#include "voxid/library/sensor_model.h"
#include "voxid/library/views.h"

namespace voxid::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string mesh, out, labels, up = "y";
  std::vector<std::string> models;
  std::vector<double> sizes_cm;
  int view = 0, frames = 1, turn = 0;
  std::uint64_t seed = 1;
  bool all = false, clean = false, table = false;
};

Status cannotWrite(const fs::path& path) { return Status::cannotDo("cannot write " + path.string()); }

Status makeFolder(const fs::path& folder) {
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  return error ? Status::cannotDo("cannot make " + folder.string() + ": " + error.message()) : Status{};
}

Status writePng(const fs::path& path, const Imager& imager, const std::vector<std::uint16_t>& pixels) {
  const cv::Mat image(imager.height_px, imager.width_px, CV_16UC1, const_cast<std::uint16_t*>(pixels.data()));
  return writePicture(path.string(), image) ? Status{} : cannotWrite(path);
}

/// As camera_calibration writes it, so that readDepthFile() and camera_info_manager find it.
Status writeCameraInfo(const fs::path& folder, const Imager& imager) {
  const fs::path path = folder / "camera_info.yaml";
  std::ofstream file(path);
  const double q16 = 65536;
  const double fx = imager.camera.fx_q16 / q16, fy = imager.camera.fy_q16 / q16, cx = imager.camera.cx_q16 / q16,
               cy = imager.camera.cy_q16 / q16;
  file << "image_width: " << imager.width_px << "\nimage_height: " << imager.height_px << "\ncamera_name: depth\n"
       << "camera_matrix: {rows: 3, cols: 3, data: [" << fx << ", 0.0, " << cx << ", 0.0, " << fy << ", " << cy
       << ", 0.0, 0.0, 1.0]}\n"
       << "distortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: [0.0, 0.0, 0.0, 0.0, 0.0]}\n"
       << "rectification_matrix: {rows: 3, cols: 3, data: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]}\n"
       << "projection_matrix: {rows: 3, cols: 4, data: [" << fx << ", 0.0, " << cx << ", 0.0, 0.0, " << fy << ", " << cy
       << ", 0.0, 0.0, 0.0, 1.0, 0.0]}\n";
  file.close();
  return file ? Status{} : cannotWrite(path);
}

/// Two streams of seeds, one for where things are, one for the sensor's noise.
std::uint64_t poseSeed(const Options& options, int number) {
  return options.seed * 1000003 + 2 * static_cast<std::uint64_t>(number);
}
std::uint64_t noiseSeed(const Options& options, int number) { return poseSeed(options, number) + 1; }

Status renderView(const Options& options, const RayScene& scene, int view) {
  const Imager imager;
  const Placement pose =
      drawPose(viewDirections()[static_cast<std::size_t>(view)], imager, ViewRange(), poseSeed(options, view));
  const DepthImage image = options.clean ? observeClean(scene, imager, pose)
                                         : observe(scene, imager, pose, SensorParams(), noiseSeed(options, view));
  char number[8];
  std::snprintf(number, sizeof number, "_%02d", view);
  const std::string name = fs::path(options.mesh).stem().string() + number + ".png";
  return writePng(fs::path(options.out) / name, imager, image.depth_mm);
}

/// From a little above, the model's y axis upright, `angle` round it.
Placement turnedPose(double angle) {
  constexpr float kAbove = 0.4f, kScale_mm = 300, kDistance_mm = 800;  // radians; of a model whose box diagonal is 1
  const auto along = static_cast<float>(angle);
  const Eigen::Vector3f to_camera(std::cos(kAbove) * std::sin(along), std::sin(kAbove),
                                  std::cos(kAbove) * std::cos(along));
  const Eigen::Vector3f right = Eigen::Vector3f(0, 1, 0).cross(to_camera).normalized();
  Placement pose;
  pose.rotation.row(0) = right;
  pose.rotation.row(1) = right.cross(to_camera);
  pose.rotation.row(2) = -to_camera;
  pose.translation = {0, 0, kDistance_mm};
  pose.scale = kScale_mm;
  return pose;
}

Status renderTurn(const Options& options, const RayScene& scene) {
  const Imager imager;
  Status status;
  for (int i = 0; i < options.turn && status.ok(); ++i) {
    const DepthImage image = observeClean(scene, imager, turnedPose(2 * M_PI * i / options.turn));
    char number[24];
    std::snprintf(number, sizeof number, "_turn_%02d", i);
    const std::string name = fs::path(options.mesh).stem().string() + number + ".png";
    status = writePng(fs::path(options.out) / name, imager, image.depth_mm);
  }
  return status;
}

Status renderModel(const Options& options) {
  if (options.mesh.empty())
    return Status::badUse("render: which mesh? Give a file, or --table with --models; see --help");
  const Result<Mesh> mesh = readMeshFile(options.mesh);
  if (!mesh.ok()) return mesh.status;
  Status status = makeFolder(options.out);
  if (status.ok()) status = writeCameraInfo(options.out, Imager());
  RayScene scene;
  scene.add(mesh.value, unitPlacement(mesh.value));
  scene.commit();
  if (options.turn > 0) return status.ok() ? renderTurn(options, scene) : status;
  const int first = options.all ? 0 : options.view, last = options.all ? kDirections - 1 : options.view;
  for (int view = first; view <= last && status.ok(); ++view) status = renderView(options, scene, view);
  return status;
}

/// The given size, or the mesh's own, taken as metres.
Result<double> sizeOf(const Options& options, std::size_t number, const Mesh& mesh) {
  const std::size_t given = options.sizes_cm.size();
  if (given > 0) return 10 * options.sizes_cm[given == 1 ? 0 : number];
  const double size_mm = 1000 * boxOf(mesh).largestExtent();
  if (size_mm >= 20 && size_mm <= 600) return size_mm;
  return Status::badUse(options.models[number] + " is " + std::to_string(size_mm / 10) +
                        " cm large if its unit is a metre, expected 2 to 60; say how large by --sizes");
}

Result<std::vector<Prop>> readProps(const Options& options) {
  std::vector<Prop> props;
  for (std::size_t i = 0; i < options.models.size(); ++i) {
    Result<Mesh> mesh = readMeshFile(options.models[i]);
    if (!mesh.ok()) return mesh.status;
    const Result<double> size_mm = sizeOf(options, i, mesh.value);
    if (!size_mm.ok()) return size_mm.status;
    props.push_back({std::move(mesh.value), options.up == "y", size_mm.value});
  }
  return props;
}

/// What `segment --labels` would write if it were always right: 1 for the first of --models and so on, 0 elsewhere.
std::vector<std::uint16_t> truthOf(const DepthImage& image) {
  std::vector<std::uint16_t> truth = image.objects;
  for (std::uint16_t& object : truth) object = object > 1 ? object - 1 : 0;
  return truth;
}

bool isPng(const std::string& path) { return fs::path(path).extension() == ".png"; }

std::string frameName(const Options& options, const std::string& target, int frame) {
  if (options.frames == 1 && isPng(target)) return target;
  char name[32];
  std::snprintf(name, sizeof name, "frame_%04d.png", frame);
  return (fs::path(target) / name).string();
}

Status writeFrame(const Options& options, const TableScene& table, int frame) {
  const Imager imager;
  const DepthImage image = options.clean
                               ? observeClean(table.scene, imager, table.camera)
                               : observe(table.scene, imager, table.camera, sceneSensor(), noiseSeed(options, frame));
  Status status = writePng(frameName(options, options.out, frame), imager, image.depth_mm);
  if (status.ok() && !options.labels.empty())
    status = writePng(frameName(options, options.labels, frame), imager, truthOf(image));
  return status;
}

Status renderTable(const Options& options) {
  if (options.models.empty()) return Status::badUse("render --table: which models? Name them by --models");
  const std::size_t sizes = options.sizes_cm.size();
  if (sizes > 1 && sizes != options.models.size()) {
    return Status::badUse("--sizes has " + std::to_string(sizes) + " numbers for " +
                          std::to_string(options.models.size()) + " models; give one a model, or one for all");
  }
  if (!options.labels.empty() && fs::weakly_canonical(frameName(options, options.labels, 0)) ==
                                     fs::weakly_canonical(frameName(options, options.out, 0)))
    return Status::badUse("--labels " + options.labels + " would be written over --out; choose another place");
  if (options.frames > 1 && isPng(options.out))
    return Status::badUse("--frames " + std::to_string(options.frames) + " needs a folder as --out, not " +
                          options.out);
  const Result<std::vector<Prop>> props = readProps(options);
  if (!props.ok()) return props.status;
  const Result<TableScene> table = setTable(props.value, poseSeed(options, 0));
  if (!table.ok()) return table.status;

  const fs::path folder = isPng(options.out) ? fs::path(options.out).parent_path() : fs::path(options.out);
  Status status = makeFolder(folder);
  if (status.ok() && !options.labels.empty())
    status = makeFolder(isPng(options.labels) ? fs::path(options.labels).parent_path() : fs::path(options.labels));
  if (status.ok()) status = writeCameraInfo(folder, Imager());
  for (int frame = 0; frame < options.frames && status.ok(); ++frame) status = writeFrame(options, table.value, frame);
  return status;
}

void addModelOptions(CLI::App& app, Options& options) {
  app.add_option("mesh", options.mesh, "Mesh file to render as the views of an index are");
  app.add_option("--out", options.out,
                 "Folder for the depth images (16-bit PNG, mm) and camera_info.yaml; with --table also a .png file")
      ->required();
  CLI::Option* const view = app.add_option("--view", options.view, "Direction, 0 to 79")
                                ->capture_default_str()
                                ->check(CLI::Range(0, kDirections - 1));
  app.add_flag("--all", options.all, "All 80 directions")->excludes(view);
  app.add_option("--turn", options.turn,
                 "Instead: so many views of one turn round the model's y axis, of an ideal sensor")
      ->check(CLI::Range(1, 360));
  app.add_flag("--clean", options.clean, "An ideal sensor, without noise, shadow and loss");
  app.add_option("--seed", options.seed, "Draws sizes, places and noise; the same seed gives the same images")
      ->capture_default_str()
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{1} << 32));
}

void addTableOptions(CLI::App& app, Options& options) {
  CLI::Option* const table = app.add_flag("--table", options.table, "A table 1.2 x 0.8 m with --models standing on it");
  app.add_option("--models", options.models, "Mesh files, each once on the table")->needs(table);
  app.add_option("--sizes", options.sizes_cm,
                 "Largest extent of each model in cm, or one for all; without it their unit is a metre")
      ->needs(table)
      ->check(realRange(1.0, 60.0));
  app.add_option("--up", options.up, "Which axis of the models points up")
      ->capture_default_str()
      ->check(CLI::IsMember({"y", "z"}));
  app.add_option("--frames", options.frames, "So many frames frame_0000.png, ... with noise drawn anew")
      ->capture_default_str()
      ->needs(table)
      ->check(CLI::Range(1, 10000));
  app.add_option("--labels", options.labels,
                 "Folder or .png for the truth: 1 where the first model is seen, ..., 0 elsewhere")
      ->needs(table);
}

}  // namespace

Run addRender(CLI::App& app) {
  auto options = std::make_shared<Options>();
  addModelOptions(app, *options);
  addTableOptions(app, *options);
  return [options] { return options->table ? renderTable(*options) : renderModel(*options); };
}

}  // namespace voxid::cli
