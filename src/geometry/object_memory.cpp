// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/object_memory.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace voxid {
namespace {

constexpr std::uint32_t kNoTrack = 0xffffffff;
constexpr std::size_t kMostSightings = 256;
constexpr int kHold = 16;
constexpr float kMmPerM = 1000;

bool sizeDiffers(const Eigen::Vector3f& now_m, const Eigen::Vector3f& usual_m) {
  constexpr float kShare = 0.25f, kLeast_m = 0.01f;
  const Eigen::Array3f change = (now_m - usual_m).array().abs();
  return (change > kShare * usual_m.array() && change > kLeast_m).any();
}

// Notes since when something is so; whether that is long enough.
bool lasts(bool is_so, std::int64_t now_us, std::int64_t& since_us) {
  if (!is_so)
    since_us = 0;
  else if (since_us == 0)
    since_us = now_us;
  return is_so && now_us - since_us >= ObjectMemory::kExchangedAfter_ms * 1000;
}

}  // namespace

ObjectMemory::ObjectMemory(std::size_t categories, std::uint32_t last_number)
    : tracks_(kMostTracks), evidence_(kMostTracks, Evidence(categories)), last_number_(last_number) {
  pairs_.reserve(kMostTracks * kMostSightings);
  numbers_.reserve(kMostSightings);
  track_of_.reserve(kMostSightings);
}

Span<const std::uint32_t> ObjectMemory::update(std::int64_t time_us, const Eigen::Vector3f& up,
                                               Span<const Sighting> sightings, const MemoryParams& params) {
  params_ = params;
  forgetOld(time_us, params);
  now_us_ = time_us;
  const std::size_t count = std::min(sightings.size, kMostSightings);
  numbers_.assign(count, 0);
  track_of_.assign(count, kNoTrack);
  pairUp(up, {sightings.data, count}, static_cast<float>(params.memory_gate_mm) / kMmPerM);
  for (std::size_t i = 0; i < count; ++i) {
    if (track_of_[i] != kNoTrack) {
      follow(tracks_[track_of_[i]], sightings[i]);
    } else if (Track* const track = freeTrack()) {
      begin(*track, sightings[i]);
      track_of_[i] = static_cast<std::uint32_t>(track - tracks_.data());
    }
    if (track_of_[i] != kNoTrack) numbers_[i] = tracks_[track_of_[i]].number;
  }
  return {numbers_.data(), numbers_.size()};
}

// A clock that went back (a recording that begins anew) leaves nothing that could be compared.
void ObjectMemory::forgetOld(std::int64_t time_us, const MemoryParams& params) {
  for (Track& track : tracks_) {
    if (time_us < now_us_ || time_us - track.last_us > std::int64_t{params.memory_keep_ms} * 1000) track.number = 0;
  }
}

void ObjectMemory::pairUp(const Eigen::Vector3f& up, Span<const Sighting> sightings, float gate_m) {
  pairs_.clear();
  for (std::uint32_t i = 0; i < sightings.size; ++i) {
    for (std::uint32_t k = 0; k < tracks_.size(); ++k) {
      if (tracks_[k].number == 0) continue;
      const Eigen::Vector3f apart = sightings[i].position_m - tracks_[k].position_m;
      const float distance_m = (apart - up * up.dot(apart)).norm();
      const bool established = tracks_[k].frames >= kEstablishedAfter_frames;
      if (distance_m <= gate_m) pairs_.push_back({established, distance_m, i, k});
    }
  }
  std::sort(pairs_.begin(), pairs_.end(), [this](const Pair& a, const Pair& b) {
    if (a.established != b.established) return a.established;
    if (a.distance_m != b.distance_m) return a.distance_m < b.distance_m;
    if (a.sighting != b.sighting) return a.sighting < b.sighting;
    return tracks_[a.track].number < tracks_[b.track].number;
  });
  std::array<bool, kMostTracks> taken{};
  for (const Pair& pair : pairs_) {
    if (taken[pair.track] || track_of_[pair.sighting] != kNoTrack) continue;
    taken[pair.track] = true;
    track_of_[pair.sighting] = pair.track;
  }
}

void ObjectMemory::begin(Track& track, const Sighting& sighting) {
  startAnew(track);
  track.frames = 1;
  track.last_us = now_us_;
  track.position_m = sighting.position_m;
  track.extents_m = sighting.extents_m;
}

void ObjectMemory::startAnew(Track& track) {
  track.number = ++last_number_;
  track.first_us = now_us_;
  track.size_changed_us = track.look_changed_us = 0;
  track.solid.clear();
  evidence_[static_cast<std::size_t>(&track - tracks_.data())].clear();
}

// The usual size follows what is seen, as when the camera moves, but not a sudden change.
void ObjectMemory::follow(Track& track, const Sighting& sighting) {
  constexpr float kFollow = 0.25f;
  track.frames = std::min(track.frames + 1, kEstablishedAfter_frames);
  track.last_us = now_us_;
  track.position_m = sighting.position_m;
  const bool differs = sizeDiffers(sighting.extents_m, track.extents_m);
  if (lasts(differs, now_us_, track.size_changed_us)) return begin(track, sighting);
  if (!differs) track.extents_m += kFollow * (sighting.extents_m - track.extents_m);
}

ObjectMemory::Track* ObjectMemory::freeTrack() {
  const auto found = std::find_if(tracks_.begin(), tracks_.end(), [](const Track& t) { return t.number == 0; });
  return found == tracks_.end() ? nullptr : &*found;
}

bool ObjectMemory::isTracked(std::size_t sighting) const {
  return sighting < track_of_.size() && track_of_[sighting] != kNoTrack;
}

// Objects begin their turns at times of their own: the golden ratio's multiples lie evenly, however many there are.
std::int64_t ObjectMemory::turnOf(const Track& track, std::int64_t time_us) const {
  constexpr std::uint32_t kGolden_q32 = 2654435769;
  const std::int64_t every_us = std::int64_t{params_.memory_describe_ms} * 1000;
  return (time_us + (every_us * (track.number * kGolden_q32) >> 32)) / every_us;
}

bool ObjectMemory::isTurn(std::uint32_t track) const {
  if (params_.memory_describe_ms <= 0 || params_.memory_half_life_ms <= 0 || evidence_[track].empty()) return true;
  return turnOf(tracks_[track], now_us_) != turnOf(tracks_[track], tracks_[track].remembered_us);
}

bool ObjectMemory::isDue(std::size_t sighting) const {
  return !isTracked(sighting) || tracks_[track_of_[sighting]].hasChanged() || isTurn(track_of_[sighting]);
}

Primitive ObjectMemory::solidOf(std::size_t sighting, const DepthView& depth, Span<const std::uint32_t> pixels,
                                const OrientedBox& box, const Eigen::Isometry3d& rest_from_camera) {
  if (!isTracked(sighting)) return primitiveOf(depth, pixels, box);
  return tracks_[track_of_[sighting]].solid.see(depth, pixels, box, rest_from_camera, isDue(sighting));
}

Answer ObjectMemory::answerOf(std::uint32_t track, const Index& index, int min_score_permille) {
  const bool settled = now_us_ - tracks_[track].first_us >= kSettledAfter_ms * 1000;
  return evidence_[track].answer(index, min_score_permille, settled ? kHold : 0);
}

Answer ObjectMemory::recall(std::size_t sighting, const Index& index, int min_score_permille) {
  return isTracked(sighting) ? answerOf(track_of_[sighting], index, min_score_permille) : Answer{};
}

Answer ObjectMemory::remember(std::size_t sighting, const Index& index, const Nearest& nearest, const Answer& answer,
                              int min_score_permille) {
  if (!isTracked(sighting) || answer.count == 0) return answer;
  Track& track = tracks_[track_of_[sighting]];
  Evidence& evidence = evidence_[track_of_[sighting]];
  const bool is_added = !track.hasChanged() || isTurn(track_of_[sighting]);
  if (is_added && !evidence.empty())
    evidence.forget((now_us_ - track.remembered_us) / 1000, params_.memory_half_life_ms);
  const std::uint32_t usual = evidence.meanDistance();
  if (is_added) {
    track.remembered_us = now_us_;
    evidence.add(index, nearest, answer);
  } else {
    evidence.see(index, nearest);
  }
  const bool differs = usual > 0 && evidence.lastDistance() > usual + usual / 2;
  if (lasts(differs, now_us_, track.look_changed_us)) {
    startAnew(track);
    track.remembered_us = now_us_;
    evidence.add(index, nearest, answer);
    numbers_[sighting] = track.number;
  }
  return answerOf(track_of_[sighting], index, min_score_permille);
}

Answer ObjectMemory::remember(std::size_t sighting, const Index& index, const Answer& answer, int min_score_permille) {
  std::array<Neighbour, Answer::kMaxAlternatives> met;
  const auto count = static_cast<std::size_t>(answer.count);
  for (std::size_t i = 0; i < count; ++i) met[i] = {answer.alternatives[i].view, answer.alternatives[i].distance};
  std::sort(met.begin(), met.begin() + answer.count);
  const Nearest nearest{{met.data(), count}, {met.data(), count}, 0};
  return remember(sighting, index, nearest, answer, min_score_permille);
}

}  // namespace voxid
