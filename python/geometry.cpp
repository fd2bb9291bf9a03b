#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <optional>

#include "meshops/build_mesh.hpp"
#include "meshops/editing/number_properties.hpp"
#include "meshops/holes/boundary_loops.hpp"
#include "meshops/to_soup.hpp"
#include "python/call.hpp"
#include "python/change.hpp"
#include "python/convert.hpp"
#include "python/held.hpp"
#include "python/module.hpp"

namespace tri::python {
namespace {

using Scalars = std::map<std::string, std::vector<double>>;

template <class T>
py::dict scalar_views(const std::shared_ptr<T>& owner, const Scalars& scalars) {
  py::dict views;
  for (const auto& [name, values] : scalars)
    views[py::str(name)] = view_of_rows<double>(owner, values.data(), values.size(), 0);
  return views;
}

/// None where a column was not measured.
template <class Element, class T, class Row>
py::object column(const std::shared_ptr<T>& owner, const std::vector<Row>& rows, std::size_t columns) {
  if (rows.empty()) return py::none();
  return view_of_rows<Element>(owner, rows.data(), rows.size(), columns);
}

std::shared_ptr<HeldPoints> make_points(const py::object& array, const std::optional<py::object>& normals,
                                        const std::optional<py::dict>& scalars) {
  auto set = std::make_shared<PointSet>();
  set->points = to_points(array, "points");
  if (normals && !normals->is_none()) set->normals = to_points(*normals, "normals");
  if (scalars)
    for (const auto& [name, values] : *scalars) set->scalars[name.cast<std::string>()] = to_numbers(values, "scalars");
  validate(*set);
  return std::make_shared<HeldPoints>(std::move(set));
}

std::shared_ptr<HeldSoup> make_soup(const py::object& points, const py::object& triangles) {
  auto soup = std::make_shared<Soup>();
  soup->points = to_points(points, "points");
  soup->triangles = to_triangles(triangles, soup->points.size());
  return std::make_shared<HeldSoup>(std::move(soup));
}

std::shared_ptr<HeldMesh> mesh_of(const Soup& soup) {
  Call call(py::none(), 0);
  // In place: meshes copy where others move.
  auto built =
      call.run([&](Context& context) { return std::shared_ptr<BuiltMesh>(new BuiltMesh(build_mesh(soup, context))); });
  built->triangle_of_face = {};
  built->repairs = {};
  auto held = std::make_shared<HeldMesh>(std::shared_ptr<Mesh>(built, &built->mesh));
  built->report.operation = "build-mesh";
  held->build_report = tri::to_json(built->report);
  return held;
}

/// Views of the numbers and vectors of a property, under a name; a copy of bools, which are packed.
void add_view(py::dict& views, const std::string& name, const std::shared_ptr<Mesh>& owner,
              const OpenMesh::BaseProperty& property) {
  const py::str key(name);
  if (const auto* flags = dynamic_cast<const OpenMesh::PropertyT<bool>*>(&property)) {
    py::array_t<bool> copy(static_cast<py::ssize_t>(flags->n_elements()));
    for (std::size_t i = 0; i < flags->n_elements(); ++i)
      copy.mutable_at(static_cast<py::ssize_t>(i)) = (*flags)[static_cast<int>(i)];
    views[key] = copy;
    return;
  }
  visit_numbers(property, [&](const auto& rows) {
    using Number = std::remove_cvref_t<decltype(rows(0))>;
    views[key] = view_of_rows<Number>(owner, rows.numbers.data(), rows.elements(), rows.vector ? rows.size : 0);
  });
}

/// The properties "v:NAME" (or with another prefix) of numbers and vectors, by NAME.
template <class Iterator>
py::dict property_views(const std::shared_ptr<Mesh>& owner, Iterator begin, Iterator end, const std::string& prefix) {
  py::dict views;
  for (Iterator it = begin; it != end; ++it) {
    const OpenMesh::BaseProperty* property = *it;
    if (!property || !property->name().starts_with(prefix)) continue;
    const std::string name = property->name().substr(prefix.size());
    if (name == "points" || name == "status" || name == "connectivity") continue;
    add_view(views, name, owner, *property);
  }
  return views;
}

std::size_t alive_vertices(const Mesh& mesh) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i)
    count += !mesh.status(VertexHandle(static_cast<int>(i))).deleted();
  return count;
}

py::array_t<std::uint32_t> faces_of(const Mesh& mesh) {
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * mesh.n_faces());
  for (std::size_t i = 0; i < mesh.n_faces(); ++i) {
    const FaceHandle f(static_cast<int>(i));
    if (mesh.status(f).deleted()) continue;
    HalfedgeHandle h = mesh.halfedge_handle(f);
    for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h))
      corners.push_back(static_cast<std::uint32_t>(mesh.to_vertex_handle(h).idx()));
  }
  return copy_of_rows<std::uint32_t>(corners, 3);
}

/// Indices of the elements of a kind that are deleted, or of the others.
template <class Handle>
py::array_t<std::uint32_t> indices_of(const Mesh& mesh, std::size_t count, bool deleted) {
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < count; ++i)
    if (mesh.status(Handle(static_cast<int>(i))).deleted() == deleted) indices.push_back(static_cast<std::uint32_t>(i));
  return copy_of_rows<std::uint32_t>(indices, 0);
}

py::array_t<std::uint32_t> halfedges_of(const Mesh& mesh) {
  std::vector<std::uint32_t> ends;
  ends.reserve(2 * mesh.n_halfedges());
  for (std::size_t i = 0; i < mesh.n_halfedges(); ++i) {
    const HalfedgeHandle h(static_cast<int>(i));
    ends.push_back(static_cast<std::uint32_t>(mesh.from_vertex_handle(h).idx()));
    ends.push_back(static_cast<std::uint32_t>(mesh.to_vertex_handle(h).idx()));
  }
  return copy_of_rows<std::uint32_t>(ends, 2);
}

py::list loops_of(const HeldMesh& held) {
  const HeldMesh::Reading mesh(held);
  py::list loops;
  for (const auto& cycle : boundary_cycles(view_of(const_cast<Mesh&>(*mesh)))) {  // reads
    std::vector<std::uint32_t> indices;
    for (const HalfedgeHandle h : cycle) indices.push_back(static_cast<std::uint32_t>(h.idx()));
    loops.append(copy_of_rows<std::uint32_t>(indices, 0));
  }
  return loops;
}

template <class H, class T, class Class>
void add_copy(Class& type) {
  const auto copy = [](const H& held) { return std::make_shared<H>(std::make_shared<T>(*typename H::Reading(held))); };
  type.def("copy", copy, "An independent copy.");
  type.def("__copy__", copy);
  type.def(
      "__deepcopy__", [copy](const H& held, const py::dict&) { return copy(held); }, py::arg("memo"));
}

void add_points(py::module_& module) {
  py::class_<HeldPoints, std::shared_ptr<HeldPoints>> type(
      module, "Points",
      "Measured points, each with what was measured beside its place. Arrays look into the object without a copy.");
  type.def(py::init(&make_points), py::arg("points"), py::kw_only(), py::arg("normals") = py::none(),
           py::arg("scalars") = py::none(),
           "Copies arrays: points and normals (n, 3), scalars a dict of (n,). Coordinates must be finite.");
  type.def_property_readonly(
      "points",
      [](const HeldPoints& p) {
        const auto s = p.share();
        return view_of_rows<double>(s, s->points.data(), s->size(), 3);
      },
      "(n, 3) float64, no copy: writing into it moves the points.");
  type.def_property_readonly(
      "normals",
      [](const HeldPoints& p) {
        const auto s = p.share();
        return column<double>(s, s->normals, 3);
      },
      "(n, 3) float64, no copy; None if there are none.");
  type.def_property_readonly(
      "intensity",
      [](const HeldPoints& p) {
        const auto s = p.share();
        return column<double>(s, s->intensity, 0);
      },
      "(n,) float64, no copy; None if there is none.");
  type.def_property_readonly(
      "colors",
      [](const HeldPoints& p) {
        const auto s = p.share();
        return column<std::uint8_t>(s, s->colors, 3);
      },
      "(n, 3) uint8, no copy; None if there are none.");
  type.def_property_readonly(
      "scalars",
      [](const HeldPoints& p) {
        const auto s = p.share();
        return scalar_views(s, s->scalars);
      },
      "Further columns by name, each (n,) float64, no copy.");
  type.def("__len__", [](const HeldPoints& p) { return p.share()->size(); });
  type.def("__repr__",
           [](const HeldPoints& p) { return "<tri.Points: " + std::to_string(p.share()->size()) + " points>"; });
  add_copy<HeldPoints, PointSet>(type);
}

void add_soup(py::module_& module) {
  py::class_<HeldSoup, std::shared_ptr<HeldSoup>> type(
      module, "Soup",
      "Points and triangles with any topology, as files hold them. Arrays look into the object without a copy.");
  type.def(py::init(&make_soup), py::arg("points"), py::arg("triangles"),
           "Copies arrays: points (n, 3), triangles (m, 3) of whole numbers.");
  type.def_property_readonly(
      "points",
      [](const HeldSoup& p) {
        const auto s = p.share();
        return view_of_rows<double>(s, s->points.data(), s->points.size(), 3);
      },
      "(n, 3) float64, no copy: writing into it moves the points.");
  type.def_property_readonly(
      "triangles",
      [](const HeldSoup& p) {
        const auto s = p.share();
        return view_of_rows<std::uint32_t>(s, s->triangles.data(), s->triangles.size(), 3);
      },
      "(m, 3) uint32, no copy. Indices must stay below len(points).");
  type.def_property_readonly(
      "vertex_normals",
      [](const HeldSoup& p) {
        const auto s = p.share();
        return column<double>(s, s->vertex_normals, 3);
      },
      "(n, 3) float64, no copy; None if there are none.");
  type.def_property_readonly(
      "vertex_colors",
      [](const HeldSoup& p) {
        const auto s = p.share();
        return column<std::uint8_t>(s, s->vertex_colors, 3);
      },
      "(n, 3) uint8, no copy; None if there are none.");
  type.def_property_readonly(
      "vertex_scalars",
      [](const HeldSoup& p) {
        const auto s = p.share();
        return scalar_views(s, s->vertex_scalars);
      },
      "Values of vertices by name, each (n,) float64, no copy.");
  type.def_property_readonly(
      "face_scalars",
      [](const HeldSoup& p) {
        const auto s = p.share();
        return scalar_views(s, s->face_scalars);
      },
      "Values of triangles by name, each (m,) float64, no copy.");
  type.def_property_readonly(
      "corner_scalars",
      [](const HeldSoup& p) {
        const auto s = p.share();
        py::dict views;
        for (const auto& [name, values] : s->corner_scalars)
          views[py::str(name)] = view_of_rows<double>(s, values.data(), values.size() / 3, 3);
        return views;
      },
      "Values of the corners of triangles by name, say texture coordinates \"s\" and \"t\", each (m, 3) float64, no copy.");
  type.def_property_readonly(
      "face_labels", [](const HeldSoup& p) { return p.share()->face_labels; },
      "What the whole values of the face scalar of a name stand for: {\"group\": [\"lid\", \"base\"]}. A copy.");
  type.def(
      "to_mesh", [](const HeldSoup& soup) { return mesh_of(*HeldSoup::Reading(soup)); },
      "A Mesh of the triangles: oriented, split where they are not manifold; its build_report says what was done.");
  type.def("__repr__", [](const HeldSoup& p) {
    const auto s = p.share();
    return "<tri.Soup: " + std::to_string(s->points.size()) + " points, " + std::to_string(s->triangles.size()) +
           " triangles>";
  });
  add_copy<HeldSoup, Soup>(type);
}

void add_mesh(py::module_& module) {
  py::class_<HeldMesh, std::shared_ptr<HeldMesh>> type(
      module, "Mesh",
      "A half-edge mesh. Operators change it in place and only mark elements as deleted; tri.ops.compact drops those.");
  type.def(py::init([](const py::object& points, const py::object& faces) {
             return mesh_of(*HeldSoup::Reading(*make_soup(points, faces)));
           }),
           py::arg("points"), py::arg("faces"),
           "Copies arrays: points (n, 3), faces (m, 3) of whole numbers; the same as Soup(points, faces).to_mesh().");
  type.def_property_readonly(
      "build_report", [](const HeldMesh& m) { return to_python(m.build_report); },
      "What was reversed and split to build the mesh; None for one that was not built from triangles.");
  type.def_property_readonly(
      "points",
      [](const HeldMesh& m) {
        const auto s = m.share();
        return view_of_rows<double>(s, s->points(), s->n_vertices(), 3);
      },
      "(n, 3) float64, no copy, deleted vertices included: writing into it moves the vertices.");
  type.def_property_readonly(
      "faces", [](const HeldMesh& m) { return faces_of(*m.share()); },
      "(m, 3) uint32: a copy, since half-edges hold no such list; without deleted faces.");
  type.def_property_readonly(
      "vertex_properties",
      [](const HeldMesh& m) {
        const auto s = m.share();
        return property_views(s, s->vprops_begin(), s->vprops_end(), "v:");
      },
      "Properties of vertices by name, say \"deviation\": (n,) or (n, k) arrays, no copy.");
  type.def_property_readonly(
      "face_properties",
      [](const HeldMesh& m) {
        const auto s = m.share();
        return property_views(s, s->fprops_begin(), s->fprops_end(), "f:");
      },
      "Properties of faces by name, deleted faces included, no copy.");
  type.def_property_readonly(
      "face_indices",
      [](const HeldMesh& m) {
        const auto s = m.share();
        return indices_of<FaceHandle>(*s, s->n_faces(), false);
      },
      "(m,) uint32: the index of the face in each row of faces, as selections and notes of changes name it.");
  type.def_property_readonly(
      "halfedges", [](const HeldMesh& m) { return halfedges_of(*m.share()); },
      "(h, 2) uint32: the vertices from which and to which each half-edge goes, deleted ones included: a copy.");
  type.def_property_readonly("boundary_loops", &loops_of,
                             "A list with an array for each boundary loop: the indices of its half-edges, in order.");
  type.def_property_readonly(
      "deleted_vertices",
      [](const HeldMesh& m) {
        const auto s = m.share();
        return indices_of<VertexHandle>(*s, s->n_vertices(), true);
      },
      "Indices of vertices that are marked as deleted.");
  type.def_property_readonly(
      "deleted_faces",
      [](const HeldMesh& m) {
        const auto s = m.share();
        return indices_of<FaceHandle>(*s, s->n_faces(), true);
      },
      "Indices of faces that are marked as deleted.");
  type.def(
      "to_soup",
      [](const HeldMesh& mesh) {
        // The view is not written to: `to_soup` reads.
        auto soup = std::make_shared<Soup>(to_soup(view_of(const_cast<Mesh&>(*HeldMesh::Reading(mesh)))));
        return std::make_shared<HeldSoup>(std::move(soup));
      },
      "The points and triangles that are not deleted, with their properties: numbers as scalars, vectors as one scalar\n"
      "for each number (force_0, force_1, …), colours, normals and texture coordinates as those of the Soup.");
  add_recording(type);
  type.def("__repr__", [](const HeldMesh& m) {
    const auto s = m.share();
    std::size_t faces = 0;
    for (std::size_t i = 0; i < s->n_faces(); ++i) faces += !s->status(FaceHandle(static_cast<int>(i))).deleted();
    return "<tri.Mesh: " + std::to_string(alive_vertices(*s)) + " vertices, " + std::to_string(faces) + " faces>";
  });
  add_copy<HeldMesh, Mesh>(type);
}

}  // namespace

void add_geometry(py::module_& module) {
  add_points(module);
  add_soup(module);
  add_mesh(module);
}

}  // namespace tri::python
