// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <voxid/Objects.h>

#include <Eigen/Core>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "voxid/core/classifier.h"

namespace voxid {

/// What alignment found out about an object.
struct AlignedObject {
  ModelPose pose;
  float misfit = 1;  ///< of the pose, see Alignment
  Answer name;       ///< count 0: it was not named
};

/// The models' poses and the names that were found, by the number of the object: each holds while the object rests
/// where it was. The first name holds, and later tries look for a better pose under it.
/// No clock: time is that of the frames. Thread-safe; no call waits for an alignment.
class PoseBoard {
 public:
  static constexpr double kRest_m = 0.015;  ///< the centre of a resting thing's visible box wanders by less, mostly
  static constexpr double kKeep_s = 10;     ///< after its last sight
  static constexpr int kMostTries = 3;      ///< an object is aligned in so many frames, kApart_s apart: the best counts
  static constexpr double kApart_s = 1;

  /// Writes into each numbered object's model_pose what is known, or `otherwise`, and its name, if it has one, over its
  /// answer. `answers`: in the order of the objects, or empty. Forgets what has moved or gone.
  void show(std::uint8_t otherwise, int min_score_permille, Objects* objects, std::vector<Answer>* answers);

  /// Which object of the frame to align next: one not yet tried, else one with tries left; none: nothing is to be done.
  std::optional<std::size_t> next(const Objects& objects) const;

  /// The category that an object was named by alignment; none: it was not, or has moved since.
  std::optional<std::uint32_t> categoryOf(const Object& object) const;

  /// What one try gave for an object as it was seen at `stamp`: its pose is kept if it is the first or fits better, its
  /// name if it is the first.
  void put(const Object& object, const ros::Time& stamp, const AlignedObject& found);

  /// Numbers begin anew: another index, or a memory that was cleared.
  void clear();

 private:
  struct Entry {
    Eigen::Vector3d position_m;
    AlignedObject found;
    int tries = 0;
    ros::Time last_try, last_seen;

    bool restsAt(const Eigen::Vector3d& position) const { return (position - position_m).norm() <= kRest_m; }
  };

  mutable std::mutex mutex_;
  std::map<std::uint32_t, Entry> entries_;
};

}  // namespace voxid
