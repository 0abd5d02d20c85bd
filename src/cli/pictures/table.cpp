// SPDX-License-Identifier: BSD-3-Clause
#include "table.h"

const void* voxid_cli_pictures() {
  using namespace voxid::cli;
  static constexpr PictureTable kTable{decodePicture, readPicture, writePicture};
  return &kTable;
}
