// SPDX-License-Identifier: BSD-3-Clause
// Objects keep their number from frame to frame, and what every frame said about them. No clock: time comes in.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "voxid/core/evidence.h"
#include "voxid/core/span.h"
#include "voxid/geometry/memory_params.h"
#include "voxid/geometry/steady_solid.h"

namespace voxid {

/// One cluster of a frame, in a frame that the table rests in.
struct Sighting {
  Eigen::Vector3f position_m{0, 0, 0};  ///< centre of the box of the visible points
  Eigen::Vector3f extents_m{0, 0, 0};   ///< along the box's axes; the third is the height above the table
};

/// For one camera and one index. All memory is taken at construction; update and remember allocate nothing.
class ObjectMemory {
 public:
  static constexpr std::size_t kMostTracks = 128;
  static constexpr std::int64_t kSettledAfter_ms = 1000;   ///< then a label is left only for a clearly better one
  static constexpr std::int64_t kExchangedAfter_ms = 250;  ///< what looks like another thing for so long is one
  static constexpr int kEstablishedAfter_frames = 5;       ///< what was cut off for a moment does not rival its whole

  /// `last_number`: of the memory before, where this one takes its place: numbers go on.
  explicit ObjectMemory(std::size_t categories, std::uint32_t last_number = 0);

  /// Starts a frame: each sighting is given the number of the object that it is, 1, 2, ... in the order of their first
  /// sight, never used again. Sightings and objects are paired by their distance on the table, the nearest pair first,
  /// those of objects that were seen in fewer than kEstablishedAfter_frames last, each at most once, none farther than
  /// the gate. A thing whose size has changed suddenly (a quarter and a centimetre, for kExchangedAfter_ms) is another
  /// one. `time_us` goes back: everything is forgotten. `up` is the table's normal; zero: distances are taken in space.
  /// Sightings beyond kMostTracks get number 0 and are not remembered. The result has the order of the sightings and
  /// holds until the next call.
  Span<const std::uint32_t> update(std::int64_t time_us, const Eigen::Vector3f& up, Span<const Sighting> sightings,
                                   const MemoryParams& params);

  /// Whether the i-th sighting of the last update is to be described in this frame: always where it is new, is not
  /// remembered, or looks or measures otherwise than it used to; else once in each memory_describe_ms. The objects'
  /// turns are spread over that time, so that each frame has its share of them.
  bool isDue(std::size_t sighting) const;

  /// The solid of the i-th sighting of the last update, in the camera's frame: that of the frames before as long as it
  /// fits (SteadySolid). Another is looked for where the sighting is due. Threads may ask for different sightings.
  Primitive solidOf(std::size_t sighting, const DepthView& depth, Span<const std::uint32_t> pixels,
                    const OrientedBox& box, const Eigen::Isometry3d& rest_from_camera);

  /// What the frames before said about the i-th sighting of the last update: the answer for one that is not due.
  Answer recall(std::size_t sighting, const Index& index, int min_score_permille);

  /// What this frame and those before say about the i-th sighting of the last update. If the object has looked like
  /// another one for kExchangedAfter_ms (its category lies half as far again as it used to), it is one from then on:
  /// its number is new. Frames out of its turn tell that and add nothing: else the new thing would soon be the usual.
  Answer remember(std::size_t sighting, const Index& index, const Nearest& nearest, const Answer& answer,
                  int min_score_permille);

  /// The same where only the answer was kept: its categories, and no other, were met.
  Answer remember(std::size_t sighting, const Index& index, const Answer& answer, int min_score_permille);

  /// The number of the i-th sighting; as from update, unless remember has found that it was exchanged.
  std::uint32_t numberOf(std::size_t sighting) const { return sighting < numbers_.size() ? numbers_[sighting] : 0; }
  std::uint32_t lastNumber() const { return last_number_; }  ///< that was given; 0: none

 private:
  struct Track {
    std::uint32_t number = 0;  // 0: free
    int frames = 0;            // in which it was seen, until it is established
    std::int64_t first_us = 0, last_us = 0, remembered_us = 0;
    std::int64_t size_changed_us = 0, look_changed_us = 0;  // since when it looks otherwise; 0: it does not
    Eigen::Vector3f position_m, extents_m;
    SteadySolid solid;

    bool hasChanged() const { return size_changed_us != 0 || look_changed_us != 0; }
  };
  struct Pair {
    bool established;
    float distance_m;
    std::uint32_t sighting, track;
  };

  void forgetOld(std::int64_t time_us, const MemoryParams& params);
  void pairUp(const Eigen::Vector3f& up, Span<const Sighting> sightings, float gate_m);
  void begin(Track& track, const Sighting& sighting);
  void follow(Track& track, const Sighting& sighting);
  void startAnew(Track& track);
  Track* freeTrack();
  bool isTracked(std::size_t sighting) const;
  bool isTurn(std::uint32_t track) const;
  std::int64_t turnOf(const Track& track, std::int64_t time_us) const;
  Answer answerOf(std::uint32_t track, const Index& index, int min_score_permille);

  std::vector<Track> tracks_;
  std::vector<Evidence> evidence_;  // by track
  std::vector<Pair> pairs_;
  std::vector<std::uint32_t> numbers_, track_of_;  // by sighting
  std::uint32_t last_number_ = 0;
  std::int64_t now_us_ = 0;
  MemoryParams params_;
};

}  // namespace voxid
