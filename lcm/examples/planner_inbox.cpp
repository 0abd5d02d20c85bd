// SPDX-License-Identifier: BSD-3-Clause
// What a grasp planner does with VOXID_OBJECTS: a line an object, the nearest graspable one of a wanted label, and
// where a gripper is to go first.
//   voxid_planner_inbox [--url URL] [--seconds S] [--count N] [--label LABEL] [--opening METRES]
// Ends after S seconds (default: never) or N messages; exits 1 if none arrived.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <voxid/object_list_t.hpp>

namespace {

struct Options {
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
  std::string label;        // a category, or the synset of what is only known so far ("container.n.01"); empty: any
  double opening_m = 0.08;  // of the gripper
  double seconds = HUGE_VAL;
  long count = 0;  // 0: no limit
};

bool parse(int argc, char** argv, Options* options) {
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i];
    if (name == "--url")
      options->url = argv[i + 1];
    else if (name == "--label")
      options->label = argv[i + 1];
    else if (name == "--opening")
      options->opening_m = std::atof(argv[i + 1]);
    else if (name == "--seconds")
      options->seconds = std::atof(argv[i + 1]);
    else if (name == "--count")
      options->count = std::atol(argv[i + 1]);
    else
      return false;
  }
  return argc % 2 == 1;
}

double distance(const voxid::object_t& object) {
  return std::hypot(std::hypot(object.position_m[0], object.position_m[1]), object.position_m[2]);
}

struct Approach {
  double position_m[3], quat_wxyz[4];
};

/// The shorter of the box's sides across the table's normal; y of its axes.
double gripWidth(const voxid::object_t& object) { return object.extents_m[1]; }

/// 10 cm above the middle of the box's top. The box's z is the table's normal; turned by half about its x it points
/// down, and y, along the shorter side, is what the fingers close in.
Approach approachFromAbove(const voxid::object_t& object) {
  constexpr double kAbove_m = 0.1;
  const double w = object.quat_wxyz[0], x = object.quat_wxyz[1], y = object.quat_wxyz[2], z = object.quat_wxyz[3];
  const double up[3] = {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
  Approach approach{{}, {-x, w, z, -y}};
  for (int i = 0; i < 3; ++i)
    approach.position_m[i] = object.position_m[i] + (object.extents_m[2] / 2 + kAbove_m) * up[i];
  return approach;
}

class Inbox {
 public:
  explicit Inbox(const Options& options) : wanted_(options.label), opening_m_(options.opening_m) {}

  void onObjects(const lcm::ReceiveBuffer*, const std::string&, const voxid::object_list_t* list) {
    ++messages;
    for (const voxid::object_t& object : list->objects) print(list->utime, object);
    if (const voxid::object_t* nearest = nearestWanted(*list)) printGrasp(*nearest);
    std::fflush(stdout);
  }

  long messages = 0;

 private:
  static void print(std::int64_t utime, const voxid::object_t& object) {
    std::printf(
        "object utime=%lld number=%d label=%s score=%.3f coarse=%s model=%s view=%d position_m=%.3f,%.3f,%.3f\n",
        static_cast<long long>(utime), object.number, object.label.c_str(), object.score, object.coarse.c_str(),
        object.model.c_str(), object.view, object.position_m[0], object.position_m[1], object.position_m[2]);
  }

  static void printGrasp(const voxid::object_t& object) {
    const Approach a = approachFromAbove(object);
    std::printf(
        "grasp number=%d label=%s distance_m=%.3f width_m=%.3f approach_m=%.3f,%.3f,%.3f "
        "quat_wxyz=%.3f,%.3f,%.3f,%.3f\n",
        object.number, object.label.c_str(), distance(object), gripWidth(object), a.position_m[0], a.position_m[1],
        a.position_m[2], a.quat_wxyz[0], a.quat_wxyz[1], a.quat_wxyz[2], a.quat_wxyz[3]);
    const voxid::model_pose_t& model = object.model_pose;
    if (model.status == voxid::model_pose_t::ALIGNED + 0)
      std::printf("aligned number=%d model=%s/%s scale_m=%.3f fit_mm=%.1f rotation_known=%d\n", object.number,
                  model.label.c_str(), model.model.c_str(), static_cast<double>(model.scale_m),
                  static_cast<double>(model.fit_mm), model.rotation_known);
  }

  bool graspable(const voxid::object_t& object) const {
    const bool wanted = wanted_.empty() || object.label == wanted_ || object.coarse == wanted_;
    return wanted && !object.truncated && gripWidth(object) <= opening_m_;
  }

  const voxid::object_t* nearestWanted(const voxid::object_list_t& list) const {
    const voxid::object_t* nearest = nullptr;
    for (const voxid::object_t& object : list.objects) {
      if (!graspable(object)) continue;
      if (!nearest || distance(object) < distance(*nearest)) nearest = &object;
    }
    return nearest;
  }

  std::string wanted_;
  double opening_m_;
};

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (!parse(argc, argv, &options)) {
    std::fprintf(
        stderr,
        "usage: voxid_planner_inbox [--url URL] [--seconds S] [--count N] [--label LABEL] [--opening METRES]\n");
    return 2;
  }
  lcm::LCM lcm(options.url);
  if (!lcm.good()) {
    std::fprintf(
        stderr,
        "voxid_planner_inbox: cannot listen at %s: is there a multicast route? (ip route add 224.0.0.0/4 dev lo)\n",
        options.url.c_str());
    return 1;
  }
  Inbox inbox(options);
  lcm.subscribe("VOXID_OBJECTS", &Inbox::onObjects, &inbox);
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed_s = [start] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  while (elapsed_s() < options.seconds && (options.count == 0 || inbox.messages < options.count))
    lcm.handleTimeout(100);
  std::printf("received=%ld\n", inbox.messages);
  return inbox.messages > 0 ? 0 : 1;
}
