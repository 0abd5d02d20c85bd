// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/scene.h"

namespace voxid {

const char* nameOf(SceneStatus status) {
  switch (status) {
    case SceneStatus::Ok:
      return "OK";
    case SceneStatus::NoDepth:
      return "NO_DEPTH";
    case SceneStatus::NoTable:
      return "NO_TABLE";
    case SceneStatus::EmptyTable:
      return "EMPTY_TABLE";
    case SceneStatus::NoTransform:
      return "NO_TRANSFORM";
    case SceneStatus::NoIndex:
      return "NO_INDEX";
    case SceneStatus::BadInput:
      return "BAD_INPUT";
  }
  return "UNKNOWN";
}

const char* nameOf(DropReason reason) {
  switch (reason) {
    case DropReason::TooFewPoints:
      return "too_few_points";
    case DropReason::OutsideOutline:
      return "outside_outline";
    case DropReason::TooMany:
      return "too_many";
    case DropReason::kCount:
      break;
  }
  return "unknown";
}

}  // namespace voxid
