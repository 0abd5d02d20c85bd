// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "voxid/core/index_format.h"

namespace voxid {

/// The directions from which models are rendered (Sec. III): the face centres of an icosahedron whose faces are each
/// cut into four. Face by face, the middle one of the four first, so every fourth direction gives the plain
/// icosahedron's 20.
constexpr int kDirections = 80;
using Directions = std::array<format::Direction, kDirections>;

/// Unit vectors x 32,767; `up` is perpendicular to `to_camera` and lies, as far as it can, along the model's y axis.
const Directions& viewDirections();

}  // namespace voxid
