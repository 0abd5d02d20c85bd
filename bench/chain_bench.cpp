// SPDX-License-Identifier: BSD-3-Clause
// voxid_chain_bench FOLDER INDEX OPENNI2 SECONDS ALIGN MODELS: the live chain on a folder of depth images, played by
// the replay driver at 30 frames a second, under a ROS master and an LCM address of its own. One JSON object on stdout,
// or one sentence there and exit code 1.
#include <ros/ros.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "child.h"
#include "conversions.h"
#include "listeners.h"
#include "manager.h"

namespace voxid::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kFps = 30;
constexpr double kStart_s = 30, kWarmUp_s = 3, kStragglers_s = 0.5;
constexpr char kMaster[] = "/usr/bin/rosmaster";

struct Options {
  std::string folder, index, openni2;
  double seconds;
  std::string align, models;
};

/// A folder for the logs of ROS, gone with this object.
struct LogFolder {
  LogFolder() {
    char name[] = "/tmp/voxid_chain_XXXXXX";
    if (!mkdtemp(name)) throw std::runtime_error("cannot make a folder in /tmp");
    path = name;
  }
  ~LogFolder() {
    std::error_code error;
    fs::remove_all(path, error);
  }
  fs::path path;
};

template <typename Condition>
bool eventually(double seconds, Condition condition) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(seconds);
  while (!condition()) {
    if (ros::WallTime::now() > end) return false;
    ros::WallDuration(0.02).sleep();
  }
  return true;
}

std::unique_ptr<Child> startMaster(const fs::path& logs) {
  if (access(kMaster, X_OK) != 0)
    throw std::runtime_error(std::string(kMaster) + " is not there: scripts/install_deps");
  const std::string port = std::to_string(freePort(false));
  setenv("ROS_MASTER_URI", ("http://127.0.0.1:" + port).c_str(), 1);
  setenv("ROS_IP", "127.0.0.1", 1);
  unsetenv("ROS_HOSTNAME");  // would hide ROS_IP
  setenv("ROS_HOME", logs.c_str(), 1);
  unsetenv("ROS_NAMESPACE");
  auto master = std::make_unique<Child>(std::vector<std::string>{kMaster, "--core", "-p", port},
                                        std::map<std::string, std::string>{});
  return master;
}

std::unique_ptr<Child> startManager(const Options& options) {
  const char* const libraries = std::getenv("LD_LIBRARY_PATH");
  return std::make_unique<Child>(
      std::vector<std::string>{fs::read_symlink("/proc/self/exe"), "--manager"},
      std::map<std::string, std::string>{
          // OpenNI2 takes its drivers from where it is loaded.
          {"LD_LIBRARY_PATH", options.openni2 + (libraries ? std::string(":") + libraries : "")},
          {"VOXID_REPLAY", options.folder},
          {"VOXID_REPLAY_FPS", std::to_string(kFps)},
          {"VOXID_REPLAY_LOOP", "1"},
      });
}

double quantile(std::vector<double> sorted, double share) {
  const auto at = static_cast<std::size_t>(share * static_cast<double>(sorted.size()));
  return sorted[std::min(at, sorted.size() - 1)];
}

double rounded(double x) { return std::round(x * 1000) / 1000; }

/// What lies between two times, of the stamps.
struct Window {
  std::int64_t from_us, to_us;
  double cpu_ms;  ///< of the manager, in it
};

struct Sums {
  std::vector<double> latency_ms, segment_ms, classify_ms;
  std::size_t frames = 0, answered = 0, objects = 0, aligned = 0;
};

Sums sumsOf(const Frames& frames, const Window& window, bool lcm) {
  Sums sums;
  for (const auto& [stamp_us, frame] : frames) {
    if (stamp_us < window.from_us || stamp_us >= window.to_us) continue;
    ++sums.frames;
    if (frame.ros_us == 0 || (lcm && frame.lcm_us == 0)) continue;
    ++sums.answered;
    sums.latency_ms.push_back(static_cast<double>(std::max(frame.ros_us, frame.lcm_us) - stamp_us) * 1e-3);
    sums.segment_ms.push_back(frame.segment_ms);
    sums.classify_ms.push_back(frame.classify_ms);
    sums.objects += frame.objects;
    sums.aligned += frame.aligned;
  }
  for (auto* samples : {&sums.latency_ms, &sums.segment_ms, &sums.classify_ms})
    std::sort(samples->begin(), samples->end());
  return sums;
}

/// By stage, and `other`: what the manager used outside the nodelets' callbacks (OpenNI2, ROS, timers).
Json stageRow(const std::map<std::string, double>& stages, const Window& window, std::size_t frames) {
  Json row;
  double all = window.cpu_ms / static_cast<double>(frames);
  row["all"] = rounded(all);
  for (const auto& [stage, cpu_ms] : stages) {
    row[stage] = rounded(cpu_ms);
    all -= cpu_ms;
  }
  row["other"] = rounded(all);
  return row;
}

Json rowOf(const Frames& frames, const Window& window, StageTimes& stages, bool lcm) {
  const Sums sums = sumsOf(frames, window, lcm);
  if (sums.answered == 0) throw std::runtime_error("no frame was answered while the chain was measured");
  const double span_us = static_cast<double>(window.to_us - window.from_us);
  // What the camera should have shown; a stamp may fall out of the window at either end.
  const auto due = static_cast<std::size_t>(std::max(0.0, std::round(span_us * 1e-6 * kFps) - 1));
  Json row;
  row["name"] = "chain";
  row["p50_ms"] = rounded(quantile(sums.latency_ms, 0.5));
  row["p99_ms"] = rounded(quantile(sums.latency_ms, 0.99));
  row["worst_latency_ms"] = rounded(sums.latency_ms.back());
  row["core_share"] = rounded(window.cpu_ms * 1e3 / span_us);
  row["frames"] = sums.frames;
  row["lost"] = std::max(sums.frames, due) - sums.answered;
  row["cpu_ms_per_frame"] = stageRow(stages.cpuMsPerFrame(window.from_us, window.to_us), window, sums.frames);
  row["objects_per_frame"] = rounded(static_cast<double>(sums.objects) / static_cast<double>(sums.answered));
  row["aligned_per_frame"] = rounded(static_cast<double>(sums.aligned) / static_cast<double>(sums.answered));
  row["segment_ms_p50"] = rounded(quantile(sums.segment_ms, 0.5));
  row["classify_ms_p50"] = rounded(quantile(sums.classify_ms, 0.5));
  row["lcm"] = lcm;
  return row;
}

Json measure(const Options& options) {
  const LogFolder logs;
  const auto master = startMaster(logs.path);
  ros::init(ros::M_string{}, "chain_bench", ros::init_options::NoSigintHandler | ros::init_options::NoRosout);
  if (!eventually(10, [&] { return !master->running() || ros::master::check(); }) || !master->running())
    throw std::runtime_error("rosmaster does not start");
  ros::NodeHandle node(kNamespace);
  const std::string url = "udpm://239.255.76.67:" + std::to_string(freePort(true)) + "?ttl=0";
  node.setParam("classification/index", options.index);
  node.setParam("classification/align", options.align);
  node.setParam("classification/models", options.models);
  node.setParam("lcm_bridge/url", url);
  Arrivals arrivals(node, url);
  StageTimes stages(node);
  ros::AsyncSpinner spinner(1);
  spinner.start();
  const auto manager = startManager(options);
  if (!eventually(kStart_s, [&] { return !manager->running() || arrivals.any(); }) || !manager->running())
    throw std::runtime_error("the chain does not answer: " +
                             (stages.trouble().empty() ? "its manager has ended" : stages.trouble()));

  ros::WallDuration(kWarmUp_s).sleep();
  const std::int64_t from_us = microsecondsOf(ros::Time::now());
  const double cpu_before_ms = manager->cpuMs();
  ros::WallDuration(options.seconds).sleep();
  const std::int64_t to_us = microsecondsOf(ros::Time::now());
  const double cpu_ms = manager->cpuMs() - cpu_before_ms;
  ros::WallDuration(kStragglers_s).sleep();
  if (!manager->running()) throw std::runtime_error("the chain's manager has ended while it was measured");
  const Json row = rowOf(arrivals.frames(), {from_us, to_us, cpu_ms}, stages, arrivals.hearsLcm());
  spinner.stop();
  return row;
}

}  // namespace
}  // namespace voxid::bench

int main(int argc, char** argv) try {
  if (argc > 1 && std::string(argv[1]) == "--manager") return voxid::bench::runManager(argc, argv);
  if (argc != 7)
    throw std::runtime_error("voxid_chain_bench FOLDER INDEX OPENNI2 SECONDS ALIGN MODELS: run by voxid bench --chain");
  const auto row = voxid::bench::measure({argv[1], argv[2], argv[3], std::strtod(argv[4], nullptr), argv[5], argv[6]});
  std::printf("%s\n", row.dump().c_str());
  return 0;
} catch (const std::exception& error) {
  std::printf("%s\n", error.what());
  return 1;
}
