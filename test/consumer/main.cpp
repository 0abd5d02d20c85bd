// SPDX-License-Identifier: BSD-3-Clause
// Uses the installed library and the installed messages: an empty scene keeps its reason through both.
#include <voxid/Objects.h>

#include <cstdio>
#include <cstring>

#include "voxid/geometry/scene.h"

int main() {
  const voxid::Scene scene;
  voxid::Objects message;
  message.status = static_cast<std::uint8_t>(scene.status);
  std::printf("%s\n", voxid::nameOf(scene.status));
  return message.status == voxid::Objects::NO_DEPTH && std::strcmp(voxid::nameOf(scene.status), "NO_DEPTH") == 0 ? 0
                                                                                                                 : 1;
}
