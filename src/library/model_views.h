// SPDX-License-Identifier: BSD-3-Clause
// A mesh becomes the views of an index.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "voxid/core/encoder.h"
#include "voxid/library/index_writer.h"
#include "voxid/library/mesh.h"

namespace voxid {

/// A raised number makes shards of earlier builds useless to --resume: for any change of what a view looks like.
constexpr std::uint32_t kRecipeRevision = 1;

struct ModelViews {
  std::vector<ViewRecord> views;  ///< by ascending direction
  std::vector<std::uint8_t>
      calibration;                    ///< code of one more view, from a random direction; empty if it showed nothing
  std::vector<std::uint8_t> surface;  ///< as Index::surface, empty unless asked for
  std::string refusal;                ///< why there are no views
};

/// What a view is kept as; empty if there is no answer for it.
using EncodeView = std::function<std::vector<std::uint8_t>(const DepthView& depth, Span<const std::uint32_t> pixels)>;
EncodeView encodeWith(const Profile& profile);

/// Which views are made of a model.
struct ViewChoice {
  int views_every = 1;         ///< every n-th direction only
  bool deform_second = false;  ///< every second view is of a model deformed in its own way: for learning only
  bool keep_surface = false;   ///< for poses
};

/// `name` seeds everything that is random: size, distance, roll, noise.
ModelViews makeViews(const Mesh& mesh, const std::string& name, const ViewChoice& choice, const EncodeView& encode);

}  // namespace voxid
