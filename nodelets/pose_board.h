// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <voxid/Objects.h>

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "voxid/core/classifier.h"
#include "voxid/geometry/steady_solid.h"

namespace voxid {

class ShelvedModel;

/// What alignment found out about an object.
struct AlignedObject {
  ModelPose pose;
  float misfit = 1;                           ///< of the pose, see Alignment
  Answer name;                                ///< count 0: it was not named
  std::shared_ptr<const ShelvedModel> model;  ///< null if none was found; PoseBoard does not keep it
};

/// What is shown of an object that was not aligned yet.
struct Unaligned {
  std::uint8_t status = ModelPose::WAITING;
  bool holds_label = true;  ///< it is about to be named: after its first second its label waits for that
};

/// The models' poses and the names that were found, by the number of the object. The first name, unless somebody has
/// said another, holds until the object is moved, and later tries look for a better pose under it: so the label of a
/// resting object changes at most once after its first second. A pose holds while the object also is where it was
/// aligned: a camera that goes round, or a push, leave the name only. An object is moved if its visible box stays away
/// from where it used to be for ObjectMemory::kExchangedAfter_ms. The box of a resting thing wanders, too, as the
/// segmentation cuts a part off or not; but then its extents change, by twice as much. No clock: time is that of the
/// frames. Thread-safe; no call waits for an alignment.
class PoseBoard {
 public:
  static constexpr double kKeep_s = 10;  ///< after its last sight
  static constexpr int kMostTries = 3;   ///< an object is aligned in so many frames, kApart_s apart: the best counts
  static constexpr double kApart_s = 1;
  static constexpr double kSettledAfter_s = 1;  ///< since its first sight, or since it was moved

  /// Writes into each numbered object's model_pose what is known, or unaligned.status, and its name, if it has one,
  /// over its answer. `answers`: in the order of the objects, or empty. Forgets what has moved or gone.
  void show(const Unaligned& unaligned, int min_score_permille, Objects* objects, std::vector<Answer>* answers);

  /// Which object of the frame to align next: one not yet tried, else one with tries left; none: nothing is to be done.
  std::optional<std::size_t> next(const Objects& objects) const;

  /// The category that an object was named by alignment, or by confirm(); none: it was not, or is elsewhere.
  std::optional<std::uint32_t> categoryOf(const Object& object) const;

  /// What one try gave for an object as it was seen at `stamp`: its pose is kept if it is the first or fits better, its
  /// name if it is the first. Nothing is kept of an object that has moved meanwhile.
  void put(const Object& object, const ros::Time& stamp, const AlignedObject& found);

  /// Somebody says what the object is, as it was seen at `stamp`: that name holds until it is moved. A pose that was
  /// found before is kept only if it was named that already.
  void confirm(const Object& object, const ros::Time& stamp, const Answer& name);

  bool empty() const;  ///< nothing is known of any object

  /// Categories and numbers are others: those of another index.
  void clear();

 private:
  struct Entry {
    VisibleBox usual, aligned;
    ros::Time first_seen, last_seen, away_since, last_try;  // away_since zero: it is where it used to be
    int tries = 0;                                          // where it was aligned
    AlignedObject found;
    Answer settled;  // the label that waits for a name

    static Entry begin(const VisibleBox& box, const ros::Time& now);
    bool moved(const VisibleBox& seen, const ros::Time& now);
    bool waits() const { return found.name.count == 0 && tries < kMostTries; }
    const Answer& answer(const Answer& by_codes, const ros::Time& now, bool holds_label);
  };

  Entry& follow(const Object& object, const ros::Time& now);
  void forgetGone(const ros::Time& now);

  mutable std::mutex mutex_;
  std::map<std::uint32_t, Entry> entries_;
};

}  // namespace voxid
