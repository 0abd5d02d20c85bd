// SPDX-License-Identifier: BSD-3-Clause
#include "table.h"

const void* voxid_cli_pcl() {
  using namespace voxid::cli;
  static constexpr PclTable kTable{makeEsf, poseByPcl, segmentByPcl, readPcdFile};
  return &kTable;
}
