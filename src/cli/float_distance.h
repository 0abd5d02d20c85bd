// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace voxid::cli {

/// Sum of absolute differences; `bins` is a multiple of 8.
float l1OfFloats(const float* a, const float* b, int bins);

}  // namespace voxid::cli
