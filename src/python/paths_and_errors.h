// SPDX-License-Identifier: BSD-3-Clause
// How the module's functions take files' names, and how they fail.
#pragma once

#include <pybind11/pybind11.h>

#include <stdexcept>
#include <string>
#include <utility>

#include "voxid/core/status.h"

namespace voxid {

namespace py = pybind11;

inline void require(bool condition, const std::string& sentence) {
  if (!condition) throw py::value_error(sentence);
}

/// As Python's own functions take a path: text, bytes, or os.PathLike.
inline std::string pathOf(const py::object& path) {
  PyObject* bytes = nullptr;
  if (PyUnicode_FSConverter(path.ptr(), &bytes) == 0) throw py::error_already_set();
  return py::reinterpret_steal<py::bytes>(bytes);
}

/// Names of files need not be UTF-8.
inline py::str textOf(const std::string& text) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace"));
}

/// A kind of OSError.
struct DamagedError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// BadUse becomes ValueError, everything else what Python uses for files.
inline void requireOk(const Status& status) {
  if (status.ok()) return;
  const std::string sentence = textOf(status.sentence);
  if (status.kind == Status::Kind::BadUse) throw py::value_error(sentence);
  if (status.kind == Status::Kind::Damaged) throw DamagedError(sentence);
  PyErr_SetString(PyExc_OSError, sentence.c_str());
  throw py::error_already_set();
}

template <typename T>
T valueOf(Result<T> result) {
  requireOk(result.status);
  return std::move(result.value);
}

}  // namespace voxid
