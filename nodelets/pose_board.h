// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <voxid/Objects.h>

#include <Eigen/Core>
#include <map>
#include <mutex>
#include <optional>

namespace voxid {

/// The models' poses that were found, by the number of the object: each holds while the object rests where it was.
/// No clock: time is that of the frames. Thread-safe; no call waits for an alignment.
class PoseBoard {
 public:
  static constexpr double kRest_m = 0.015;  ///< the centre of a resting thing's visible box wanders by less
  static constexpr double kKeep_s = 10;     ///< after its last sight
  static constexpr int kMostTries = 3;      ///< an object is aligned in so many frames, kApart_s apart: the best counts
  static constexpr double kApart_s = 1;

  /// Writes into each numbered object's model_pose what is known, or `otherwise`. Forgets what has moved or gone.
  void show(std::uint8_t otherwise, Objects* objects);

  /// Which object of the frame to align next: one not yet tried, else one with tries left; none: nothing is to be done.
  std::optional<std::size_t> next(const Objects& objects) const;

  /// What one try gave for an object as it was seen in `header`'s frame; kept if it is the first or fits better.
  void put(const Object& object, const ros::Time& stamp, const ModelPose& found, float misfit);

  /// Numbers begin anew: another index, or a memory that was cleared.
  void clear();

 private:
  struct Entry {
    Eigen::Vector3d position_m;
    ModelPose found;
    float misfit = 1;
    int tries = 0;
    ros::Time last_try, last_seen;

    bool restsAt(const Eigen::Vector3d& position) const { return (position - position_m).norm() <= kRest_m; }
  };

  mutable std::mutex mutex_;
  std::map<std::uint32_t, Entry> entries_;
};

}  // namespace voxid
