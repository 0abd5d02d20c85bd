// SPDX-License-Identifier: BSD-3-Clause
// What a grasp planner does with VOXID_OBJECTS: a line an object, and the nearest one of a wanted label.
//   voxid_planner_inbox [--url URL] [--seconds S] [--count N] [--label LABEL]
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
  std::string label;  // empty: any
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

class Inbox {
 public:
  explicit Inbox(std::string wanted) : wanted_(std::move(wanted)) {}

  void onObjects(const lcm::ReceiveBuffer*, const std::string&, const voxid::object_list_t* list) {
    ++messages;
    for (const voxid::object_t& object : list->objects) print(list->utime, object);
    if (const voxid::object_t* nearest = nearestWanted(*list))
      std::printf("grasp number=%d label=%s distance_m=%.3f\n", nearest->number, nearest->label.c_str(), distance(*nearest));
    std::fflush(stdout);
  }

  long messages = 0;

 private:
  static void print(std::int64_t utime, const voxid::object_t& object) {
    std::printf("object utime=%lld number=%d label=%s score=%.3f model=%s view=%d position_m=%.3f,%.3f,%.3f\n",
                static_cast<long long>(utime), object.number, object.label.c_str(), object.score, object.model.c_str(),
                object.view, object.position_m[0], object.position_m[1], object.position_m[2]);
  }

  const voxid::object_t* nearestWanted(const voxid::object_list_t& list) const {
    const voxid::object_t* nearest = nullptr;
    for (const voxid::object_t& object : list.objects) {
      if (!wanted_.empty() && object.label != wanted_) continue;
      if (!nearest || distance(object) < distance(*nearest)) nearest = &object;
    }
    return nearest;
  }

  std::string wanted_;
};

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (!parse(argc, argv, &options)) {
    std::fprintf(stderr, "usage: voxid_planner_inbox [--url URL] [--seconds S] [--count N] [--label LABEL]\n");
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
  Inbox inbox(options.label);
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
