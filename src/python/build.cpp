// SPDX-License-Identifier: BSD-3-Clause
#include "build.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "paths_and_errors.h"
#include "voxid/library/builder.h"
#include "voxid/library/index_editor.h"

namespace voxid {
namespace {

/// Calls `on_progress`, and lets Ctrl-C through.
class ProgressCall : public BuildListener {
 public:
  explicit ProgressCall(py::object on_progress) : on_progress_(std::move(on_progress)) {}
  void onProgress(int done, int models, std::uint64_t views) override {
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!on_progress_.is_none()) on_progress_(done, models, views);
  }

 private:
  py::object on_progress_;
};

BuildReport runBuild(const BuildOptions& options, const std::optional<std::pair<int, int>>& part,
                     const py::object& on_progress) {
  ProgressCall listener(on_progress);
  Result<BuildReport> report = Status::cannotDo("");
  {
    const py::gil_scoped_release release;
    report = part ? buildPart(options, {part->first, part->second}, listener) : buildIndex(options, listener);
  }
  return valueOf(std::move(report));
}

BuildReport build(const py::object& models, const py::object& out, const std::optional<std::pair<int, int>>& part,
                  bool resume, std::optional<int> jobs, int views_every, bool keep_points,
                  const std::string& descriptor, const py::object& projection, std::optional<std::uint32_t> pairs,
                  std::optional<std::uint32_t> code_bytes, const py::object& on_progress) {
  require(!pairs || *pairs > 0, "pairs: expected 1 to 1000000");
  BuildOptions options;
  options.models = pathOf(models);
  options.out = pathOf(out);
  options.jobs = jobs ? *jobs : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  options.resume = resume;
  options.views_every = views_every;
  options.keep_surfaces = keep_points;
  options.profile = valueOf(profileOf(descriptor, projection.is_none() ? std::string() : pathOf(projection),
                                      pairs.value_or(0), code_bytes.value_or(0)));
  return runBuild(options, part, on_progress);
}

std::vector<std::pair<py::str, py::str>> skippedOf(const BuildReport& report) {
  std::vector<std::pair<py::str, py::str>> skipped;
  for (const SkippedModel& one : report.skipped) skipped.emplace_back(textOf(one.model), textOf(one.reason));
  return skipped;
}

void merge(const std::vector<py::object>& indices, const py::object& out, bool replace) {
  std::vector<std::string> paths;
  for (const py::object& index : indices) paths.push_back(pathOf(index));
  const std::string to = pathOf(out);
  Status status;
  {
    const py::gil_scoped_release release;
    status = mergeIndices(paths, to, replace ? Clash::Replace : Clash::Refuse);
  }
  requireOk(status);
}

}  // namespace

void addBuild(py::module& module) {
  py::register_exception<DamagedError>(module, "DamagedError", PyExc_OSError);

  py::class_<BuildReport>(module, "BuildReport")
      .def_readonly("categories", &BuildReport::categories)
      .def_readonly("models", &BuildReport::models)
      .def_readonly("views", &BuildReport::views)
      .def_readonly("bytes", &BuildReport::bytes)
      .def_property_readonly("skipped", skippedOf);
  module.def("build", build, py::arg("models"), py::arg("out"), py::kw_only(), py::arg("part") = py::none(),
             py::arg("resume") = false, py::arg("jobs") = py::none(), py::arg("views_every") = 1,
             py::arg("keep_points") = false, py::arg("descriptor") = "default", py::arg("projection") = py::none(),
             py::arg("pairs") = py::none(), py::arg("code_bytes") = py::none(), py::arg("on_progress") = py::none());
  module.def("merge", merge, py::arg("indices"), py::arg("out"), py::kw_only(), py::arg("replace") = false);
}

}  // namespace voxid
