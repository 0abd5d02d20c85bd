// SPDX-License-Identifier: BSD-3-Clause
#include "pose_board.h"

#include <cmath>

#include "conversions.h"
#include "seconds.h"
#include "voxid/geometry/object_memory.h"

namespace voxid {
namespace {

VisibleBox visibleBoxOf(const Object& object) {
  return {eigenOf(object.pose.pose.position), eigenOf(object.extents_m)};
}

// What changes slowly, as when the camera moves.
void follow(const VisibleBox& seen, VisibleBox& usual) {
  constexpr double kFollow = 0.25;
  usual.centre_m += kFollow * (seen.centre_m - usual.centre_m);
  usual.extents_m += kFollow * (seen.extents_m - usual.extents_m);
}

}  // namespace

PoseBoard::Entry PoseBoard::Entry::begin(const VisibleBox& box, const ros::Time& now) {
  Entry entry;
  entry.usual = box;
  entry.first_seen = entry.last_seen = now;
  return entry;
}

bool PoseBoard::Entry::moved(const VisibleBox& seen, const ros::Time& now) {
  constexpr double kMovedAfter_s = ObjectMemory::kExchangedAfter_ms / 1e3;
  if (usual.holds(seen)) {
    voxid::follow(seen, usual);
    away_since = {};
  } else if (away_since.isZero()) {
    away_since = now;
  }
  return !away_since.isZero() && secondsBetween(away_since, now) >= kMovedAfter_s;
}

const Answer& PoseBoard::Entry::answer(const Answer& by_codes, const ros::Time& now, bool holds_label) {
  if (found.name.count > 0) return found.name;
  const bool held = holds_label && waits() && settled.count > 0 && secondsBetween(first_seen, now) > kSettledAfter_s;
  if (!held) settled = by_codes;
  return settled;
}

PoseBoard::Entry& PoseBoard::follow(const Object& object, const ros::Time& now) {
  const VisibleBox box = visibleBoxOf(object);
  const auto known = entries_.find(object.number);
  const bool anew = known == entries_.end() || known->second.moved(box, now);
  Entry& entry = anew ? entries_[object.number] = Entry::begin(box, now) : known->second;
  if (!entry.aligned.holds(entry.usual)) entry.tries = 0;
  entry.last_seen = now;
  return entry;
}

void PoseBoard::show(const Unaligned& unaligned, int min_score_permille, Objects* objects,
                     std::vector<Answer>* answers) {
  const ros::Time now = objects->header.stamp;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (std::size_t i = 0; i < objects->objects.size(); ++i) {
    Object& object = objects->objects[i];
    if (object.number == 0) continue;
    Entry& entry = follow(object, now);
    const bool posed = entry.tries > 0 && entry.away_since.isZero();
    if (posed) object.model_pose = entry.found.pose;
    if (!posed) object.model_pose.status = unaligned.status;
    if (i >= answers->size()) continue;
    Answer& answer = (*answers)[i];
    answer = entry.answer(answer, now, unaligned.holds_label);
    answer.known = answer.count > 0 && answer.score_permille >= min_score_permille;
  }
  forgetGone(now);
}

void PoseBoard::forgetGone(const ros::Time& now) {
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    const bool gone = std::abs(secondsBetween(entry->second.last_seen, now)) > kKeep_s;
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
    if (!entry.usual.holds(visibleBoxOf(object))) continue;
    if (entry.tries == 0) return i;
    const bool due = secondsBetween(entry.last_try, objects.header.stamp) >= kApart_s;
    if (!again && due && entry.tries < kMostTries) again = i;
  }
  return again;
}

std::optional<std::uint32_t> PoseBoard::categoryOf(const Object& object) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto entry = entries_.find(object.number);
  if (entry == entries_.end() || entry->second.found.name.count == 0) return {};
  if (!entry->second.usual.holds(visibleBoxOf(object))) return {};
  return entry->second.found.name.alternatives[0].category;
}

void PoseBoard::put(const Object& object, const ros::Time& stamp, const AlignedObject& found) {
  if (object.number == 0) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  const VisibleBox box = visibleBoxOf(object);
  Entry& entry = entries_.try_emplace(object.number, Entry::begin(box, stamp)).first->second;
  if (!entry.usual.holds(box)) return;
  if (entry.tries == 0 || found.misfit < entry.found.misfit) {
    entry.aligned = box;
    entry.found.pose = found.pose;
    entry.found.misfit = found.misfit;
  }
  if (entry.found.name.count == 0) entry.found.name = found.name;
  ++entry.tries;
  entry.last_try = stamp;
}

void PoseBoard::confirm(const Object& object, const ros::Time& stamp, const Answer& name) {
  if (object.number == 0) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  const Entry anew = Entry::begin(visibleBoxOf(object), stamp);
  Entry& entry = entries_.try_emplace(object.number, anew).first->second;
  const Answer& before = entry.found.name;
  const bool the_same = before.count > 0 && before.alternatives[0].category == name.alternatives[0].category;
  if (!the_same || !entry.usual.holds(anew.usual)) entry = anew;
  entry.found.name = name;
}

bool PoseBoard::empty() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return entries_.empty();
}

void PoseBoard::clear() {
  const std::lock_guard<std::mutex> lock(mutex_);
  entries_.clear();
}

}  // namespace voxid
