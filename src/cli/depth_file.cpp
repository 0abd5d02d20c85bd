// SPDX-License-Identifier: BSD-3-Clause
#include "depth_file.h"

#include <yaml-cpp/yaml.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <vector>

#include "counted.h"
#include "picture_file.h"

namespace voxid::cli {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

constexpr std::array<std::uint8_t, 8> kPngSignature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr std::size_t kChunkFrame = 12;  ///< length, type and sum around a chunk's data

struct Intrinsics {
  double fx_px, fy_px, cx_px, cy_px;
};
constexpr Intrinsics kKinect{525, 525, 319.5, 239.5};  ///< at 640 x 480
constexpr double kKinectWidth_px = 640;

Result<Bytes> readBytes(const std::string& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return Status::cannotDo(path + ": no such file");
  if (!fs::is_regular_file(path, error)) return Status::cannotDo(path + ": is not a file; expected a depth image");
  std::ifstream file(path, std::ios::binary);
  if (!file) return Status::cannotDo(path + ": cannot be opened for reading");
  Bytes bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (bytes.empty()) return Status::damaged(path + ": is empty; expected a depth image (PNG or TIFF)");
  return bytes;
}

bool startsAs(const Bytes& bytes, const std::uint8_t* signature, std::size_t length) {
  return std::equal(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(std::min(bytes.size(), length)),
                    signature);
}

bool isPng(const Bytes& bytes) { return startsAs(bytes, kPngSignature.data(), kPngSignature.size()); }

bool isTiff(const Bytes& bytes) {
  const std::uint8_t little[] = {'I', 'I', '*', 0}, big[] = {'M', 'M', 0, '*'};
  return startsAs(bytes, little, 4) || startsAs(bytes, big, 4);
}

std::uint32_t bigEndian32(const std::uint8_t* p) {
  return std::uint32_t{p[0]} << 24 | std::uint32_t{p[1]} << 16 | std::uint32_t{p[2]} << 8 | p[3];
}

/// Walks the chunks: libpng decodes what it can of a cut file, and speaks to stderr on its own.
Status checkPng(const std::string& path, const Bytes& bytes) {
  std::size_t at = kPngSignature.size();
  while (at + kChunkFrame <= bytes.size()) {
    const std::size_t length = bigEndian32(&bytes[at]);
    if (length > bytes.size() - at - kChunkFrame) break;
    const std::uint8_t* type = &bytes[at + 4];
    const std::uint32_t sum = static_cast<std::uint32_t>(crc32(0, type, static_cast<uInt>(length + 4)));
    if (sum != bigEndian32(type + 4 + length)) {
      return Status::damaged(path + ": damaged PNG, wrong checksum of the chunk at byte " + std::to_string(at));
    }
    if (std::memcmp(type, "IEND", 4) == 0) return {};
    at += kChunkFrame + length;
  }
  return Status::damaged(path + ": damaged PNG, ends after " + std::to_string(bytes.size()) + " bytes inside a chunk");
}

std::string typeName(const cv::Mat& image) {
  static constexpr const char* kDepths[] = {"8-bit",          "8-bit signed", "16-bit",       "16-bit signed",
                                            "32-bit integer", "32-bit float", "64-bit float", "16-bit float"};
  return std::string(kDepths[image.depth()]) + ", " + counted(image.channels(), "channel");
}

Result<cv::Mat> readPixels(const std::string& path) {
  const Result<Bytes> bytes = readBytes(path);
  if (!bytes.ok()) return bytes.status;
  if (isPng(bytes.value)) {
    const Status status = checkPng(path, bytes.value);
    if (!status.ok()) return status;
  }
  const cv::Mat image = decodePicture(bytes.value);
  if (image.empty()) {
    if (isPng(bytes.value)) return Status::damaged(path + ": damaged PNG, cannot be decoded");
    if (isTiff(bytes.value)) return Status::damaged(path + ": damaged TIFF, cannot be decoded");
    return Status::cannotDo(path + ": is not an image that can be read; expected a depth image (PNG or TIFF)");
  }
  if (image.type() != CV_16UC1 && image.type() != CV_32FC1) {
    return Status::cannotDo(path + ": holds no depth but " + typeName(image) +
                            "; expected 16-bit millimetres or 32-bit float metres, 1 channel");
  }
  return image;
}

std::optional<Intrinsics> parseIntrinsics(const std::string& text) {
  std::istringstream stream(text);
  std::array<double, 4> v{};
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (!(stream >> v[i])) return std::nullopt;
    if (i + 1 < v.size() && stream.get() != ',') return std::nullopt;
  }
  if (stream.peek() != std::istringstream::traits_type::eof()) return std::nullopt;
  return Intrinsics{v[0], v[1], v[2], v[3]};
}

Camera cameraOf(const Intrinsics& k) { return Camera::fromPixels(k.fx_px, k.fy_px, k.cx_px, k.cy_px); }

struct CameraInfo {
  int width_px, height_px;
  Intrinsics intrinsics;
};

Result<CameraInfo> parseCameraInfo(const std::string& path) {
  const std::string wanted =
      "; expected a camera_info file as camera_calibration writes it (image_width, image_height, camera_matrix: data "
      "of 9 numbers)";
  try {
    const YAML::Node root = YAML::LoadFile(path);
    const auto k = root["camera_matrix"]["data"].as<std::vector<double>>();
    if (k.size() != 9) return Status::cannotDo(path + ": camera_matrix has " + counted(k.size(), "number") + wanted);
    return CameraInfo{root["image_width"].as<int>(), root["image_height"].as<int>(), {k[0], k[4], k[2], k[5]}};
  } catch (const YAML::Exception&) {
    return Status::cannotDo(path + ": no camera in it" + wanted);
  }
}

std::string sizeText(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

Result<Camera> cameraFromInfo(const std::string& path, cv::Size size) {
  const Result<CameraInfo> info = parseCameraInfo(path);
  if (!info.ok()) return info.status;
  if (info.value.width_px != size.width || info.value.height_px != size.height) {
    return Status::cannotDo(path + ": is for images of " + sizeText(info.value.width_px, info.value.height_px) +
                            ", the depth image has " + sizeText(size.width, size.height) +
                            "; give the right camera with --camera");
  }
  const Camera camera = cameraOf(info.value.intrinsics);
  if (!camera.valid()) return Status::cannotDo(path + ": focal length or centre out of range (0 to 32767 px)");
  return camera;
}

Result<Camera> cameraFromText(const std::string& text, cv::Size size) {
  std::error_code error;
  if (fs::is_regular_file(text, error)) return cameraFromInfo(text, size);
  const std::optional<Intrinsics> intrinsics = parseIntrinsics(text);
  if (!intrinsics)
    return Status::badUse("--camera " + text + ": neither four numbers fx,fy,cx,cy in pixels nor a camera_info file");
  const Camera camera = cameraOf(*intrinsics);
  if (!camera.valid())
    return Status::badUse("--camera " + text + ": focal length or centre out of range (0 to 32767 px)");
  return camera;
}

Camera assumedCamera(cv::Size size) {
  static std::atomic_flag said = ATOMIC_FLAG_INIT;
  if (!said.test_and_set())
    std::fputs("voxid: no --camera and no camera_info.yaml beside the image: taking 525,525,319.5,239.5 at 640 x 480\n",
               stderr);
  const double scale = size.width / kKinectWidth_px;
  // Pixel centres lie at whole numbers, so the image begins at -0.5.
  return Camera::fromPixels(kKinect.fx_px * scale, kKinect.fy_px * scale, (kKinect.cx_px + 0.5) * scale - 0.5,
                            (kKinect.cy_px + 0.5) * scale - 0.5);
}

Result<Camera> chooseCamera(const std::string& path, const CameraChoice& choice, cv::Size size) {
  if (!choice.text.empty()) return cameraFromText(choice.text, size);
  const fs::path beside = fs::path(path).parent_path() / "camera_info.yaml";
  std::error_code error;
  if (fs::exists(beside, error)) return cameraFromInfo(beside.string(), size);
  return assumedCamera(size);
}

}  // namespace

DepthView DepthFile::view() const {
  DepthView view;
  view.data = pixels.data;
  view.width_px = pixels.cols;
  view.height_px = pixels.rows;
  view.row_bytes = pixels.step[0];
  view.unit = pixels.type() == CV_16UC1 ? DepthUnit::MillimetreU16 : DepthUnit::MetreF32;
  view.camera = camera;
  return view;
}

void CameraChoice::addTo(CLI::App& app) {
  app.add_option("--camera", text,
                 "fx,fy,cx,cy in pixels, or a camera_info YAML (default: camera_info.yaml beside the image, else "
                 "525,525,319.5,239.5 at 640 x 480)");
}

Result<DepthFile> readDepthFile(const std::string& path, const CameraChoice& choice) {
  const Result<cv::Mat> pixels = readPixels(path);
  if (!pixels.ok()) return pixels.status;
  const Result<Camera> camera = chooseCamera(path, choice, pixels.value.size());
  if (!camera.ok()) return camera.status;
  return DepthFile{path, pixels.value, camera.value};
}

}  // namespace voxid::cli
