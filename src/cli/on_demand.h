// SPDX-License-Identifier: BSD-3-Clause
// PCL and the codecs of OpenCV bring 174 libraries, whose relocation took most of every start of the command. What
// needs them is in shared objects of its own, pcl/ and pictures/, which the first call loads.
#pragma once

#include <string>

namespace voxid::cli {

/// What the function voxid_cli_PART of libvoxid_cli_PART.so returns, which lies beside the other libraries of voxid.
/// Throws std::runtime_error if it is not there.
const void* load(const std::string& part);

/// The same, loaded by the first call: a part's functions.
template <typename Table>
const Table& tableOf(const std::string& part) {
  static const auto& table = *static_cast<const Table*>(load(part));
  return table;
}

}  // namespace voxid::cli
