// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "../esf.h"
#include "../pcd_file.h"
#include "../pcl_pose.h"
#include "../pcl_segmentation.h"

namespace voxid::cli {

/// What libvoxid_cli_pcl.so holds of these headers.
struct PclTable {
  decltype(&makeEsf) esf;
  decltype(&poseByPcl) pose;
  decltype(&segmentByPcl) segment;
  decltype(&readPcdFile) read_pcd;
};

}  // namespace voxid::cli

extern "C" __attribute__((visibility("default"))) const void* voxid_cli_pcl();  ///< the PclTable
