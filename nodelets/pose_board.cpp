// SPDX-License-Identifier: BSD-3-Clause
#include "pose_board.h"

#include <cmath>

#include "conversions.h"

namespace voxid {

void PoseBoard::show(std::uint8_t otherwise, int min_score_permille, Objects* objects, std::vector<Answer>* answers) {
  const ros::Time now = objects->header.stamp;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (std::size_t i = 0; i < objects->objects.size(); ++i) {
    Object& object = objects->objects[i];
    if (object.number == 0) continue;
    object.model_pose.status = otherwise;
    const auto entry = entries_.find(object.number);
    if (entry == entries_.end()) continue;
    if (!entry->second.restsAt(eigenOf(object.pose.pose.position))) {
      entries_.erase(entry);
      continue;
    }
    entry->second.last_seen = now;
    const AlignedObject& found = entry->second.found;
    object.model_pose = found.pose;
    if (found.name.count == 0 || i >= answers->size()) continue;
    (*answers)[i] = found.name;
    (*answers)[i].known = found.name.score_permille >= min_score_permille;
  }
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    const bool gone = std::abs((now - entry->second.last_seen).toSec()) > kKeep_s;
    entry = gone ? entries_.erase(entry) : std::next(entry);
  }
}

std::optional<std::size_t> PoseBoard::next(const Objects& objects) const {
  std::optional<std::size_t> again;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (std::size_t i = 0; i < objects.objects.size(); ++i) {
    const Object& object = objects.objects[i];
    if (object.number == 0) continue;
    const auto found = entries_.find(object.number);
    if (found == entries_.end()) return i;
    const Entry& entry = found->second;
    const bool due = (objects.header.stamp - entry.last_try).toSec() >= kApart_s;
    if (!again && due && entry.tries < kMostTries && entry.restsAt(eigenOf(object.pose.pose.position))) again = i;
  }
  return again;
}

std::optional<std::uint32_t> PoseBoard::categoryOf(const Object& object) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto entry = entries_.find(object.number);
  if (entry == entries_.end() || entry->second.found.name.count == 0) return {};
  if (!entry->second.restsAt(eigenOf(object.pose.pose.position))) return {};
  return entry->second.found.name.alternatives[0].category;
}

void PoseBoard::put(const Object& object, const ros::Time& stamp, const AlignedObject& found) {
  if (object.number == 0) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  Entry& entry = entries_[object.number];
  const Eigen::Vector3d position_m = eigenOf(object.pose.pose.position);
  if (entry.tries > 0 && !entry.restsAt(position_m)) entry = {};
  if (entry.tries == 0) entry.position_m = position_m;
  if (entry.tries == 0 || found.misfit < entry.found.misfit) {
    entry.found.pose = found.pose;
    entry.found.misfit = found.misfit;
  }
  if (entry.found.name.count == 0) entry.found.name = found.name;
  ++entry.tries;
  entry.last_try = entry.last_seen = stamp;
}

void PoseBoard::clear() {
  const std::lock_guard<std::mutex> lock(mutex_);
  entries_.clear();
}

}  // namespace voxid
