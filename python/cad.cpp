#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <filesystem>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>

#include "io/cad/cad_file.hpp"
#include "io/result_json.hpp"
#include "libtri/alignment/align.hpp"
#include "libtri/deviation.hpp"
#include "libtri/example_parts.hpp"
#include "libtri/model/cad_model.hpp"
#include "libtri/registration.hpp"
#include "libtri/sampling/virtual_measurement.hpp"
#include "libtri/triangulation/triangulate.hpp"
#include "python/call.hpp"
#include "python/choices.hpp"
#include "python/convert.hpp"
#include "python/held.hpp"
#include "python/module.hpp"

namespace tri::python {
namespace {

/// A CAD model, with what is made of it once. Never changes but for that.
class ModelObject {
 public:
  ModelObject(const Shape& read, double sew, Context& context)
      : shape(read), model(make_cad_model(read, sew, context)) {}

  const Registration& registration(Context& context) const {
    const std::lock_guard lock(mutex_);
    if (!registration_) registration_ = std::make_unique<Registration>(model, context);
    return *registration_;
  }

  const Shape shape;
  const CadModel model;

 private:
  mutable std::mutex mutex_;
  mutable std::unique_ptr<Registration> registration_;
};

using Model = std::shared_ptr<ModelObject>;

/// Measured points to read: of a Points object, or a copy of an array.
class MeasuredPoints {
 public:
  explicit MeasuredPoints(const py::object& object) {
    if (py::isinstance<HeldPoints>(object))
      reading_.emplace(object.cast<const HeldPoints&>());
    else
      copy_.points = to_points(object, "points");
  }
  const PointSet& operator*() const { return reading_ ? **reading_ : copy_; }
  const PointSet* operator->() const { return &**this; }

 private:
  std::optional<HeldPoints::Reading> reading_;
  PointSet copy_;
};

Model read_model(const std::filesystem::path& path, double sew, const py::object& progress, int threads) {
  Call call(progress, threads);
  return call.run([&](Context& context) {
    return std::make_shared<ModelObject>(read_cad(path.string(), context).shape, sew, context);
  });
}

Model make_example(const std::string& name) {
  Call call(py::none(), 0);
  return call.run([&](Context& context) { return std::make_shared<ModelObject>(example_part(name), 0.01, context); });
}

py::list faces_of(const ModelObject& m) {
  py::list faces;
  for (const CadFace& f : m.model.faces) {
    py::dict face;
    face["face"] = f.index;
    face["name"] = py::reinterpret_steal<py::object>(
        PyUnicode_DecodeUTF8(f.name.data(), static_cast<py::ssize_t>(f.name.size()), "replace"));
    face["surface"] = f.surface_type;
    face["area"] = f.area;
    faces.append(face);
  }
  return faces;
}

py::dict measure_model(const Model& model, std::uint64_t points, const std::string& pattern, double noise,
                       double outliers, double line_ratio, bool move, bool shuffle, std::uint64_t seed,
                       const py::object& progress, int threads) {
  MeasurementOptions options;
  options.points = points;
  options.pattern = sampling_pattern(pattern);
  options.noise = noise;
  options.outliers = outliers;
  options.line_ratio = line_ratio;
  options.move = move;
  options.shuffle = shuffle;
  options.seed = seed;
  Call call(progress, threads);
  VirtualMeasurement result = call.run([&](Context& context) { return measure(model->shape, options, context); });
  std::vector<int> faces;
  std::vector<Vec3> places, normals;
  std::vector<std::uint8_t> moved;
  for (const TruePoint& t : result.truth) {
    faces.push_back(t.face);
    places.push_back(t.point);
    normals.push_back(t.normal);
    moved.push_back(t.outlier);
  }
  auto set = std::make_shared<PointSet>();
  set->points = std::move(result.points);
  py::dict dict, truth;
  truth["face"] = copy_of_rows<int>(faces, 0);
  truth["point"] = copy_of_points(places);
  truth["normal"] = copy_of_points(normals);
  truth["outlier"] = copy_of_rows<std::uint8_t>(moved, 0).attr("astype")("bool");
  dict["points"] = std::make_shared<HeldPoints>(std::move(set));
  dict["truth"] = truth;
  dict["to_model"] = py::array_t<double>({4, 4}, &result.to_model[0][0]);
  dict["spacing"] = result.spacing;
  return dict;
}

py::tuple triangulate_points(const Model& model, const py::object& points, const std::string& method,
                             const std::string& unmeasured, double hole_size, std::optional<double> outlier_distance,
                             bool patches, const py::object& progress, int threads) {
  TriangulateOptions options;
  options.method = choice<Method>(
      "method", method, {{"auto", Method::automatic}, {"patches", Method::patches}, {"shell", Method::shell}});
  options.unmeasured =
      choice<Unmeasured>("unmeasured", unmeasured, {{"hole", Unmeasured::hole}, {"span", Unmeasured::span}});
  options.hole_size = hole_size;
  options.outlier_distance = outlier_distance;
  options.keep_patches = patches;
  const MeasuredPoints measured(points);
  Call call(progress, threads);
  // Shared, so that the mesh in it is not copied.
  const auto result = call.run([&](Context& context) {
    return std::shared_ptr<TriangulateResult>(
        new TriangulateResult(triangulate(model->model, measured->points, options, context)));
  });
  py::object patch_mesh = py::none();
  if (result->patches) patch_mesh = py::cast(std::make_shared<HeldMesh>(std::make_shared<Mesh>(*result->patches)));
  const py::object report = to_python(tri::to_json(*result, model->model));
  return py::make_tuple(std::make_shared<HeldMesh>(std::shared_ptr<Mesh>(result, &result->mesh)), report, patch_mesh);
}

py::tuple align_points(const Model& model, const py::object& points, const std::string& mode, const py::object& start,
                       const std::string& metric, double keep, double probe_radius, std::uint64_t seed,
                       const py::object& progress, int threads) {
  AlignOptions options;
  options.mode = align_mode(mode);
  if (!start.is_none()) options.start = pose_of(to_matrix(start));
  options.metric = choice<Metric>("metric", metric, {{"plane", Metric::plane}, {"point", Metric::point}});
  options.keep = keep;
  options.probe_radius = probe_radius;
  options.seed = seed;
  const MeasuredPoints measured(points);
  Call call(progress, threads);
  const AlignResult result = call.run([&](Context& context) {
    return align(model->model, model->registration(context), measured->points, measured->normals, options, context);
  });
  auto moved = std::make_shared<PointSet>(*measured);
  if (!result.pose.is_identity()) {
    for (Vec3& p : moved->points) p = result.pose(p);
    for (Vec3& n : moved->normals) n = result.pose.turn(n);
  }
  const auto matrix = result.pose.matrix();
  return py::make_tuple(std::make_shared<HeldPoints>(std::move(moved)), py::array_t<double>({4, 4}, &matrix[0][0]),
                        to_python(tri::to_json(result)));
}

py::dict feet_dict(const std::vector<Foot>& feet, const CadModel& model) {
  std::vector<int> faces;
  std::vector<std::uint8_t> on_edge;
  std::vector<double> uv, deviation;
  std::vector<Vec3> places;
  for (const Foot& f : feet) {
    faces.push_back(f.face < 0 ? 0 : model.faces[static_cast<std::size_t>(f.face)].index);
    on_edge.push_back(f.edge >= 0);
    uv.insert(uv.end(), {f.uv[0], f.uv[1]});
    deviation.push_back(f.deviation);
    places.push_back(f.point);
  }
  py::dict dict;
  dict["face"] = copy_of_rows<int>(faces, 0);
  dict["uv"] = copy_of_rows<double>(uv, 2);
  dict["foot"] = copy_of_points(places);
  dict["deviation"] = copy_of_rows<double>(deviation, 0);
  dict["on_edge"] = copy_of_rows<std::uint8_t>(on_edge, 0).attr("astype")("bool");
  return dict;
}

py::dict register_on(const Model& model, const py::object& points, const py::object& progress, int threads) {
  const MeasuredPoints measured(points);
  Call call(progress, threads);
  const std::vector<Foot> feet = call.run(
      [&](Context& context) { return model->registration(context).register_points(measured->points, context); });
  return feet_dict(feet, model->model);
}

py::tuple compare_points(const Model& model, const py::object& points,
                         const std::optional<std::pair<double, double>>& tolerance, std::optional<double> max_distance,
                         std::size_t spots, const py::object& progress, int threads) {
  DeviationOptions options;
  if (tolerance) options.tolerance = Tolerance{tolerance->first, tolerance->second};
  options.max_distance = max_distance;
  options.spots = spots;
  const MeasuredPoints measured(points);
  Call call(progress, threads);
  const Deviations result = call.run([&](Context& context) {
    const std::vector<Foot> feet = model->registration(context).register_points(measured->points, context);
    return deviations(model->model, measured->points, feet, options, context);
  });
  return py::make_tuple(copy_of_rows<double>(result.values, 0), copy_of_rows<int>(result.faces, 0),
                        to_python(tri::to_json(result, model->model, options)));
}

}  // namespace

void add_cad(py::module_& module) {
  py::class_<ModelObject, Model>(module, "Model",
                                 "A CAD model: trimmed faces of any surface type, in millimetres. Never changes.")
      .def_property_readonly("faces", &faces_of,
                             "A list with a dict for each face: face (1-based), name, surface, area (mm^2).")
      .def_property_readonly(
          "diagonal", [](const ModelObject& m) { return m.model.diagonal; }, "Of the bounding box, mm.")
      .def_property_readonly(
          "box",
          [](const ModelObject& m) {
            return copy_of_points(std::array{m.model.box_min, m.model.box_max});
          },
          "(2, 3) float64: least and greatest coordinates, mm.")
      .def_property_readonly(
          "warnings", [](const ModelObject& m) { return m.model.warnings; },
          "What was repaired or is odd, one sentence each.")
      .def("__repr__",
           [](const ModelObject& m) { return "<tri.Model: " + std::to_string(m.model.faces.size()) + " faces>"; });
  module.def("read_cad", &read_model, py::arg("path"), py::kw_only(), py::arg("sew") = 0.01,
             py::arg("progress") = py::none(), py::arg("threads") = 0,
             "Reads an IGES, STEP or BREP file; loose faces are joined at `sew` mm.");
  module.def(
      "write_cad",
      [](const std::filesystem::path& path, const Model& model) { write_cad(path.string(), model->shape); },
      py::arg("path"), py::arg("model"), "Writes .igs, .step or .brep, in millimetres.");
  module.def("example_part", &make_example, py::arg("name"), "Builds an example part: see example_parts().");
  module.def(
      "example_parts",
      [] {
        py::dict parts;
        for (const ExamplePart& part : example_parts()) parts[py::str(part.name)] = part.description;
        return parts;
      },
      "The example parts, each with one line of description.");
  module.def(
      "measure", &measure_model, py::arg("model"), py::arg("points") = 10000, py::kw_only(),
      py::arg("pattern") = "random", py::arg("noise") = 0.0, py::arg("outliers") = 0.0, py::arg("line_ratio") = 10.0,
      py::arg("move") = false, py::arg("shuffle") = false, py::arg("seed") = 1, py::arg("progress") = py::none(),
      py::arg("threads") = 0,
      "Measures a model virtually. pattern: random, scan or grid; noise: standard deviation along the normal, mm;\n"
      "outliers: their share. Returns a dict: points (Points), truth (face, point, normal, outlier), to_model (4x4), spacing.");
  module.def("triangulate_points", &triangulate_points, py::arg("model"), py::arg("points"), py::arg("method"),
             py::arg("unmeasured"), py::arg("hole_size"), py::arg("outlier_distance"), py::arg("patches"),
             py::arg("progress"), py::arg("threads"),
             "Returns the mesh, the report, and the mesh before stitching or None.");
  module.def("align_points", &align_points, py::arg("model"), py::arg("points"), py::arg("mode"), py::arg("start"),
             py::arg("metric"), py::arg("keep"), py::arg("probe_radius"), py::arg("seed"), py::arg("progress"),
             py::arg("threads"), "Returns the moved points, the pose and the report.");
  module.def(
      "register", &register_on, py::arg("model"), py::arg("points"), py::kw_only(), py::arg("progress") = py::none(),
      py::arg("threads") = 0,
      "The closest point on the model for each point, as a dict of arrays: face (1-based; 0 for a point that is not\n"
      "finite), uv, foot, deviation (mm, positive outside), on_edge.");
  module.def("compare_points", &compare_points, py::arg("model"), py::arg("points"), py::arg("tolerance"),
             py::arg("max_distance"), py::arg("spots"), py::arg("progress"), py::arg("threads"),
             "Returns the deviation and the face of every point, and the report.");
}

}  // namespace tri::python
