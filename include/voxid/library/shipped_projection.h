// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "voxid/core/projection.h"

namespace voxid {

/// The projection that comes with voxid, cfg/default.vxp; what it was learnt from and how good it is:
/// doc/descriptor.md.
Result<std::shared_ptr<const Projection>> shippedProjection();

}  // namespace voxid
