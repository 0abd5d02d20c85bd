// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

namespace voxid {

/// build(), merge(), BuildReport and DamagedError.
void addBuild(pybind11::module& module);

}  // namespace voxid
