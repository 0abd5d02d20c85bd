// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "../picture_file.h"

namespace voxid::cli {

/// What libvoxid_cli_pictures.so holds of picture_file.h.
struct PictureTable {
  decltype(&decodePicture) decode;
  decltype(&readPicture) read;
  decltype(&writePicture) write;
};

}  // namespace voxid::cli

extern "C" __attribute__((visibility("default"))) const void* voxid_cli_pictures();  ///< the PictureTable
