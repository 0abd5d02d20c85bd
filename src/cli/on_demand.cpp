// SPDX-License-Identifier: BSD-3-Clause
#include "on_demand.h"

#include <dlfcn.h>

#include <stdexcept>

namespace voxid::cli {

const void* load(const std::string& part) {
  const std::string name = "voxid_cli_" + part;
  void* const library = ::dlopen(("lib" + name + ".so").c_str(), RTLD_LAZY | RTLD_LOCAL);
  void* const function = library == nullptr ? nullptr : ::dlsym(library, name.c_str());
  if (function == nullptr) throw std::runtime_error(std::string("install voxid anew: ") + ::dlerror());
  return reinterpret_cast<const void* (*)()>(function)();
}

}  // namespace voxid::cli
