// SPDX-License-Identifier: BSD-3-Clause
// The compiled part of the Python module `voxid`; python/voxid/__init__.pyi says what each function takes and gives.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "build.h"
#include "paths_and_errors.h"
#include "voxid/core/descriptor.h"
#include "voxid/core/encoder.h"
#include "voxid/core/index.h"
#include "voxid/core/search.h"
#include "voxid/library/mesh_reader.h"
#include "voxid/library/model_view.h"
#include "voxid/library/sensor_model.h"
#include "voxid/library/shipped_projection.h"
#include "voxid/library/surface_points.h"
#include "voxid/library/views.h"

namespace py = pybind11;

namespace voxid {
namespace {

template <typename T>
using Array = py::array_t<T, py::array::c_style>;
using Converted = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Of metres; points that are no numbers, or too far for micrometres in an int32, are left out.
std::vector<PointUm> fromMetres(const double* metres, std::size_t count) {
  constexpr double kFarthest_m = 2147;
  std::vector<PointUm> points;
  points.reserve(count);
  const auto um = [](double m) { return static_cast<std::int32_t>(std::lround(m * 1e6)); };
  for (std::size_t i = 0; i < count; ++i) {
    const double* const p = metres + 3 * i;
    const bool near = std::abs(p[0]) <= kFarthest_m && std::abs(p[1]) <= kFarthest_m && std::abs(p[2]) <= kFarthest_m;
    if (near) points.push_back({um(p[0]), um(p[1]), um(p[2])});
  }
  return points;
}

py::array_t<std::uint8_t> describePoints(const py::array& points, std::uint32_t pairs, std::uint32_t seed) {
  require(points.ndim() == 2 && points.shape(1) == 3, "points: expected an array of shape (n, 3)");
  require(pairs >= 1 && pairs <= kMaxPairs, "pairs: expected 1 to 1000000");
  py::array_t<std::uint8_t> bins(kDescriptorBytes);
  const bool in_um = py::isinstance<Array<std::int32_t>>(points);
  const auto as_um = in_um ? Array<std::int32_t>(points) : Array<std::int32_t>();
  const auto as_m = in_um ? Converted() : Converted::ensure(points);
  if (!in_um && !as_m) throw py::error_already_set();
  const auto count = static_cast<std::size_t>(points.shape(0));
  std::uint8_t* const out = bins.mutable_data();
  const void* const data = in_um ? static_cast<const void*>(as_um.data()) : as_m.data();
  DescribeStatus status{};
  {
    py::gil_scoped_release release;
    Describer describer({pairs, seed});
    std::vector<PointUm> converted;
    Span<const PointUm> span{static_cast<const PointUm*>(data), count};
    if (!in_um) {
      converted = fromMetres(static_cast<const double*>(data), count);
      span = {converted.data(), converted.size()};
    }
    const Described described = describer.describe(span);
    std::copy(described.bins.begin(), described.bins.end(), out);
    status = described.status;
  }
  require(status == DescribeStatus::Ok, "points: at least two that differ are needed");
  return bins;
}
static_assert(sizeof(PointUm) == 12, "rows of int32 are points");

using Intrinsics = std::array<double, 4>;

/// A depth image that Python owns, and the pixels of its object; both stay as long as this does.
struct Seen {
  py::array pixels;
  py::object mask;
  DepthView view;
  std::vector<std::uint32_t> numbers;
};

DepthUnit unitOf(const py::array& depth) {
  if (py::isinstance<py::array_t<std::uint16_t>>(depth)) return DepthUnit::MillimetreU16;
  if (py::isinstance<py::array_t<float>>(depth)) return DepthUnit::MetreF32;
  throw py::type_error("depth: expected uint16 (millimetres) or float32 (metres)");
}

/// No copy of the image, unless its rows have gaps between pixels.
Seen seenOf(const py::array& depth, const py::object& mask, const Intrinsics& camera) {
  require(depth.ndim() == 2 && depth.shape(0) >= 1 && depth.shape(1) >= 1 && depth.shape(0) <= 32767 &&
              depth.shape(1) <= 32767,
          "depth: expected an image of shape (rows, columns), at most 32767 each");
  Seen seen;
  seen.view.unit = unitOf(depth);
  const bool dense = depth.strides(1) == depth.itemsize() && depth.strides(0) >= depth.shape(1) * depth.itemsize();
  seen.pixels = dense ? depth : py::array(py::module_::import("numpy").attr("ascontiguousarray")(depth));
  seen.view.data = seen.pixels.data();
  seen.view.width_px = static_cast<int>(depth.shape(1));
  seen.view.height_px = static_cast<int>(depth.shape(0));
  seen.view.row_bytes = static_cast<std::size_t>(seen.pixels.strides(0));
  seen.view.camera = Camera::fromPixels(camera[0], camera[1], camera[2], camera[3]);
  require(seen.view.camera.valid(), "camera: expected (fx, fy, cx, cy) in pixels, fx and fy positive");
  if (!mask.is_none()) {
    const auto flags = Array<bool>::ensure(mask);
    require(flags && flags.ndim() == 2 && flags.shape(0) == depth.shape(0) && flags.shape(1) == depth.shape(1),
            "mask: expected booleans in the shape of depth, or None");
    seen.mask = flags;
  }
  return seen;
}

/// Without a mask, every pixel with depth.
void findPixels(Seen& seen, const bool* mask) {
  const DepthView& view = seen.view;
  for (int v = 0; v < view.height_px; ++v) {
    for (int u = 0; u < view.width_px; ++u) {
      const auto number = static_cast<std::uint32_t>(v * view.width_px + u);
      if ((mask == nullptr || mask[number]) && view.depthUm(u, v) > 0) seen.numbers.push_back(number);
    }
  }
}

/// Raises if there is nothing to describe.
py::array codeOf(const Profile& profile, Seen seen) {
  std::vector<std::uint8_t> code(profile.codeBytes());
  const bool* const mask = seen.mask ? Array<bool>(seen.mask).data() : nullptr;
  DescribeStatus status{};
  {
    py::gil_scoped_release release;
    findPixels(seen, mask);
    const auto encoder = makeEncoder(profile);
    status = encoder->encode(seen.view, {seen.numbers.data(), seen.numbers.size()}, code.data());
  }
  require(status == DescribeStatus::Ok,
          "depth: nothing to describe; at least two pixels with depth are needed inside the mask");
  return py::array_t<std::uint8_t>(static_cast<py::ssize_t>(code.size()), code.data());
}

const Profile& shippedProfile() {
  static const Profile profile{{}, valueOf(shippedProjection())};
  return profile;
}

py::array describeDepth(const py::array& depth, const py::object& mask, const Intrinsics& camera) {
  return codeOf(shippedProfile(), seenOf(depth, mask, camera));
}

struct Found {
  py::array_t<std::uint32_t> views, distances;
};

class PyIndex {
 public:
  explicit PyIndex(std::shared_ptr<const Index> index) : index_(std::move(index)) {}

  static std::shared_ptr<PyIndex> open(const py::object& path) {
    return std::make_shared<PyIndex>(valueOf(Index::open(pathOf(path))));
  }
  const Index& index() const { return *index_; }

  Found nearest(const py::array& code, int count, bool exact, int lists) {
    const auto bytes = static_cast<std::size_t>(index_->parameters().code_bytes);
    require(code.ndim() == 1 && code.itemsize() == 1 && static_cast<std::size_t>(code.size()) == bytes &&
                code.strides(0) == 1,
            "code: expected a row of as many bytes as describe() of this index gives");
    require(count >= 1 && count <= kNearestViews, "count: expected 1 to " + std::to_string(kNearestViews));
    std::vector<std::uint8_t> query(static_cast<const std::uint8_t*>(code.data()),
                                    static_cast<const std::uint8_t*>(code.data()) + bytes);
    std::vector<Neighbour> found;
    {
      py::gil_scoped_release release;
      const SearchParams params{exact, kPaperRadiusBits, lists};
      auto search = take(params);
      const Nearest& nearest = search->find(query.data());
      const std::size_t most = std::min<std::size_t>(nearest.views.size, static_cast<std::size_t>(count));
      found.assign(nearest.views.begin(), nearest.views.begin() + most);
      give(params, std::move(search));
    }
    return arraysOf(found);
  }

  py::array describe(const py::array& depth, const py::object& mask, const Intrinsics& camera) const {
    return codeOf(index_->profile(), seenOf(depth, mask, camera));
  }

 private:
  static Found arraysOf(const std::vector<Neighbour>& found) {
    const auto size = static_cast<py::ssize_t>(found.size());
    Found arrays{py::array_t<std::uint32_t>(size), py::array_t<std::uint32_t>(size)};
    for (py::ssize_t i = 0; i < size; ++i) {
      arrays.views.mutable_at(i) = found[static_cast<std::size_t>(i)].view;
      arrays.distances.mutable_at(i) = found[static_cast<std::size_t>(i)].distance;
    }
    return arrays;
  }

  /// One search a thread at a time; those of the last parameters are kept.
  std::unique_ptr<Search> take(const SearchParams& params) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (params == params_ && !idle_.empty()) {
        auto search = std::move(idle_.back());
        idle_.pop_back();
        return search;
      }
    }
    return makeSearch(index_, params);
  }
  void give(const SearchParams& params, std::unique_ptr<Search> search) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!(params == params_)) idle_.clear();
    params_ = params;
    idle_.push_back(std::move(search));
  }

  std::shared_ptr<const Index> index_;
  std::mutex mutex_;
  SearchParams params_;
  std::vector<std::unique_ptr<Search>> idle_;
};

/// The mapped bytes themselves, read-only; they live as long as the array.
py::array codesOf(const std::shared_ptr<PyIndex>& self) {
  const Index& index = self->index();
  const py::ssize_t rows = index.viewCount(), bytes = index.parameters().code_bytes;
  py::array_t<std::uint8_t> codes({rows, bytes}, index.code(0), py::cast(self));
  codes.attr("setflags")(py::arg("write") = false);
  return codes;
}

std::vector<py::str> categoriesOf(const PyIndex& self) {
  std::vector<py::str> names;
  for (std::uint32_t i = 0; i < self.index().categories().size; ++i)
    names.push_back(textOf(std::string(self.index().categoryName(i))));
  return names;
}

std::vector<py::str> modelsOf(const PyIndex& self) {
  std::vector<py::str> names;
  for (std::uint32_t i = 0; i < self.index().models().size; ++i)
    names.push_back(textOf(std::string(self.index().modelName(i))));
  return names;
}

/// (category, model, direction): numbers into `categories` and `models`, and 0 to 79.
py::tuple placeOf(const PyIndex& self, std::uint32_t view) {
  if (view >= self.index().viewCount()) throw py::index_error("the index has no such view");
  const format::View entry = self.index().view(view);
  if (entry.model >= self.index().models().size)
    throw py::index_error("the index is damaged; `voxid verify` says where");
  return py::make_tuple(self.index().models()[entry.model].category, entry.model, entry.direction);
}

Mesh meshOf(const py::object& vertices, const py::object& triangles) {
  const auto corners = py::array_t<float, py::array::c_style | py::array::forcecast>::ensure(vertices);
  const auto faces = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(triangles);
  require(corners && corners.ndim() == 2 && corners.shape(1) == 3, "mesh: expected vertices of shape (n, 3)");
  require(faces && faces.ndim() == 2 && faces.shape(1) == 3, "mesh: expected triangles of shape (n, 3)");
  Mesh mesh;
  for (py::ssize_t i = 0; i < corners.shape(0); ++i)
    mesh.vertices.push_back({corners.at(i, 0), corners.at(i, 1), corners.at(i, 2)});
  for (py::ssize_t i = 0; i < faces.shape(0); ++i) {
    Mesh::Triangle triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t corner = faces.at(i, static_cast<py::ssize_t>(k));
      require(corner >= 0 && corner < corners.shape(0), "mesh: a triangle names a vertex that is not there");
      triangle[k] = static_cast<std::uint32_t>(corner);
    }
    mesh.triangles.push_back(triangle);
  }
  const Status status = keepRenderable(mesh);
  require(status.ok(), "mesh: no triangle with an area is in it");
  return mesh;
}

py::array_t<std::uint16_t> imageOf(const DepthImage& image) {
  py::array_t<std::uint16_t> pixels({image.imager.height_px, image.imager.width_px});
  std::copy(image.depth_mm.begin(), image.depth_mm.end(), pixels.mutable_data());
  return pixels;
}

py::tuple draw(const Mesh& mesh, int view, bool clean, std::uint64_t seed) {
  require(view >= 0 && view < kDirections, "view: expected 0 to 79");
  const Imager imager;
  DepthImage image;
  {
    py::gil_scoped_release release;
    RayScene scene;
    scene.add(mesh, unitPlacement(mesh));
    scene.commit();
    const std::uint64_t pose_seed = seed * 1000003 + 2 * static_cast<std::uint64_t>(view);  // as `voxid render`
    const Placement pose = drawPose(viewDirections()[static_cast<std::size_t>(view)], imager, ViewRange(), pose_seed);
    image = clean ? observeClean(scene, imager, pose) : observe(scene, imager, pose, SensorParams(), pose_seed + 1);
  }
  const double q16 = 65536;
  const Camera& camera = imager.camera;
  return py::make_tuple(imageOf(image), py::make_tuple(camera.fx_q16 / q16, camera.fy_q16 / q16, camera.cx_q16 / q16,
                                                       camera.cy_q16 / q16));
}

Mesh readWithoutLock(const std::string& path) {
  Result<Mesh> mesh = Status::cannotDo("");
  {
    py::gil_scoped_release release;
    mesh = readMeshFile(path);
  }
  return valueOf(std::move(mesh));
}

py::tuple arraysOfFile(const py::object& path) {
  const Mesh mesh = readWithoutLock(pathOf(path));
  py::array_t<float> vertices({static_cast<py::ssize_t>(mesh.vertices.size()), py::ssize_t{3}});
  py::array_t<std::uint32_t> triangles({static_cast<py::ssize_t>(mesh.triangles.size()), py::ssize_t{3}});
  static_assert(sizeof(Mesh::Vertex) == 12 && sizeof(Mesh::Triangle) == 12, "rows of three");
  std::memcpy(vertices.mutable_data(), mesh.vertices.data(), mesh.vertices.size() * sizeof(Mesh::Vertex));
  std::memcpy(triangles.mutable_data(), mesh.triangles.data(), mesh.triangles.size() * sizeof(Mesh::Triangle));
  return py::make_tuple(vertices, triangles);
}

/// A file's name, or (vertices, triangles).
Mesh meshOf(const py::object& mesh) {
  const bool named =
      py::isinstance<py::str>(mesh) || py::isinstance<py::bytes>(mesh) || py::hasattr(mesh, "__fspath__");
  if (named) return readWithoutLock(pathOf(mesh));
  const bool two = py::isinstance<py::sequence>(mesh) && py::len(mesh) == 2;
  if (!two) throw py::type_error("mesh: expected a file's name, or (vertices, triangles)");
  const auto parts = py::reinterpret_borrow<py::sequence>(mesh);
  return meshOf(parts[0], parts[1]);
}

py::array_t<std::uint8_t> describeWhole(const py::object& argument, std::uint32_t pairs, std::uint32_t seed) {
  const Mesh mesh = meshOf(argument);
  std::vector<PointUm> points;
  {
    py::gil_scoped_release release;
    points = surfacePoints(mesh);
  }
  const auto rows = static_cast<py::ssize_t>(points.size());
  return describePoints(Array<std::int32_t>({rows, py::ssize_t{3}}, &points.data()->x), pairs, seed);
}

/// The codes one after another. Seeded alike for every mesh.
std::vector<std::uint8_t> codesOfViews(const Mesh& mesh, int every) {
  const auto encoder = makeEncoder(shippedProfile());
  std::vector<std::uint8_t> code(shippedProfile().codeBytes()), codes;
  RayScene scene;
  scene.add(mesh, unitPlacement(mesh));
  scene.commit();
  for (int direction = 0; direction < kDirections; direction += every) {
    const ModelView view = drawModelView(scene, "describe", direction);
    const Span<const std::uint32_t> pixels{view.pixels.data(), view.pixels.size()};
    if (encoder->encode(view.image.view(), pixels, code.data()) != DescribeStatus::Ok) continue;
    codes.insert(codes.end(), code.begin(), code.end());
  }
  return codes;
}

py::array_t<std::uint8_t> describeViews(const py::object& argument, int every) {
  require(every >= 1 && every <= kDirections, "every: expected 1 to 80");
  const Mesh mesh = meshOf(argument);
  const auto bytes = static_cast<py::ssize_t>(shippedProfile().codeBytes());
  std::vector<std::uint8_t> codes;
  {
    py::gil_scoped_release release;
    codes = codesOfViews(mesh, every);
  }
  const auto rows = static_cast<py::ssize_t>(codes.size()) / bytes;
  return py::array_t<std::uint8_t>({rows, bytes}, codes.data());
}

py::array_t<std::int8_t> numbersOfCodes(const py::array_t<std::uint8_t, py::array::c_style>& codes) {
  require(codes.ndim() >= 1, "codes: expected an array of one axis at least");
  const py::ssize_t bytes = codes.shape(codes.ndim() - 1);
  require(bytes == kCodeBytes || bytes == kSmallCodeBytes, "codes: expected 48 or 32 bytes in the last axis");
  std::vector<py::ssize_t> shape(codes.shape(), codes.shape() + codes.ndim());
  shape.back() = static_cast<py::ssize_t>(numbersIn(static_cast<std::size_t>(bytes)));
  py::array_t<std::int8_t> numbers(shape);
  std::int8_t* out = numbers.mutable_data();
  for (py::ssize_t at = 0; at < codes.size(); at += bytes) {
    const CodeNumbers held = numbersOf(codes.data() + at, static_cast<std::size_t>(bytes));
    out = std::copy_n(held.begin(), numbersIn(static_cast<std::size_t>(bytes)), out);
  }
  return numbers;
}

py::tuple drawMesh(const py::object& mesh, int view, bool clean, std::uint64_t seed) {
  return draw(meshOf(mesh), view, clean, seed);
}

}  // namespace
}  // namespace voxid

PYBIND11_MODULE(_native, module) {
  using namespace voxid;
  module.def("describe", describePoints, py::arg("points"), py::kw_only(), py::arg("pairs") = DescriptorParams{}.pairs,
             py::arg("seed") = DescriptorParams{}.seed);
  module.def("describe", describeDepth, py::arg("depth"), py::arg("mask"), py::arg("camera"));
  module.def("describe", describeWhole, py::arg("mesh"), py::kw_only(), py::arg("pairs") = DescriptorParams{}.pairs,
             py::arg("seed") = DescriptorParams{}.seed);
  module.def("numbers", numbersOfCodes, py::arg("codes"));
  module.def("describe_views", describeViews, py::arg("mesh"), py::arg("every") = 1);
  module.def("read_mesh", arraysOfFile, py::arg("path"));
  module.def("render", drawMesh, py::arg("mesh"), py::arg("view") = 0, py::kw_only(), py::arg("clean") = false,
             py::arg("seed") = 1);
  addBuild(module);

  py::class_<PyIndex, std::shared_ptr<PyIndex>>(module, "Index")
      .def_static("open", &PyIndex::open, py::arg("path"))
      .def("describe", &PyIndex::describe, py::arg("depth"), py::arg("mask"), py::arg("camera"))
      .def(
          "nearest",
          [](PyIndex& self, const py::array& code, int count, bool exact, int lists) {
            const Found found = self.nearest(code, count, exact, lists);
            return py::make_tuple(found.views, found.distances);
          },
          py::arg("code"), py::arg("count") = 20, py::kw_only(), py::arg("exact") = true,
          py::arg("lists") = SearchParams{}.lists)
      .def("place_of", placeOf, py::arg("view"))
      .def_property_readonly("codes", codesOf)
      .def_property_readonly("categories", categoriesOf)
      .def_property_readonly("models", modelsOf)
      .def("__len__", [](const PyIndex& self) { return self.index().viewCount(); });
}
