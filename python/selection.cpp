#include "python/selection.hpp"

#include <string>
#include <vector>

#include "meshops/error.hpp"
#include "python/convert.hpp"
#include "python/module.hpp"

namespace tri::python {
namespace {

using Kind = SelectionObject::Kind;

constexpr const char* name_of(Kind kind) {
  return kind == Kind::faces ? "faces" : kind == Kind::vertices ? "vertices" : "half-edges";
}

/// An array of indices or a mask, of shape (n,).
py::array checked(const py::handle& object, Kind kind) {
  const std::string what = std::string("selection of ") + name_of(kind);
  py::array array = py::array::ensure(object);
  if (!array) throw InvalidInput(what + ": not an array of indices or bools");
  const char type = array.dtype().kind();
  if (type != 'b' && type != 'i' && type != 'u' && array.size() > 0)
    throw InvalidInput(what + ": not an array of indices or bools");
  if (array.ndim() != 1) throw InvalidInput(what + ": an array of shape (n,) is needed");
  return array;
}

/// A mask passes over what is deleted; an index of it is refused by the selection itself.
template <class Handle, class Deleted>
std::vector<Handle> handles_of(const SelectionObject& object, std::size_t count, const Deleted& deleted) {
  std::vector<Handle> handles;
  if (object.array.size() == 0 && object.array.dtype().kind() != 'b') return handles;
  if (object.array.dtype().kind() == 'b') {
    const auto mask = py::array_t<bool>::ensure(object.array);
    if (static_cast<std::size_t>(mask.size()) != count)
      throw InvalidInput(std::string("selection of ") + name_of(object.kind) + ": the mask has " +
                         std::to_string(mask.size()) + " entries, and the mesh " + std::to_string(count) + " " +
                         name_of(object.kind) + " (deleted ones included)");
    for (std::size_t i = 0; i < count; ++i)
      if (const Handle handle(static_cast<int>(i)); mask.at(i) && !deleted(handle)) handles.push_back(handle);
    return handles;
  }
  const auto indices = py::array_t<std::int64_t, py::array::forcecast>::ensure(object.array);
  for (py::ssize_t k = 0; k < indices.size(); ++k) {
    const std::int64_t i = indices.at(k);
    if (i < 0 || static_cast<std::uint64_t>(i) >= count)
      throw InvalidInput(std::string("selection of ") + name_of(object.kind) + ": " + std::to_string(i) +
                         " is not of this mesh, which has " + std::to_string(count));
    handles.emplace_back(static_cast<int>(i));
  }
  return handles;
}

SelectionObject make_selection(const py::object& faces, const py::object& vertices, const py::object& loops) {
  const int given = !faces.is_none() + !vertices.is_none() + !loops.is_none();
  if (given != 1) throw InvalidInput("a selection is of faces, vertices or loops: give one of the three");
  if (!faces.is_none()) return {Kind::faces, checked(faces, Kind::faces)};
  if (!vertices.is_none()) return {Kind::vertices, checked(vertices, Kind::vertices)};
  return {Kind::loops, checked(loops, Kind::loops)};
}

}  // namespace

std::optional<Selection> selection_of(const Mesh& mesh, const py::object& object) {
  if (object.is_none()) return std::nullopt;
  const SelectionObject wanted = py::isinstance<SelectionObject>(object)
                                     ? object.cast<SelectionObject>()
                                     : SelectionObject{Kind::faces, checked(object, Kind::faces)};
  switch (wanted.kind) {
    case Kind::faces:
      return Selection::of_faces(
          mesh, handles_of<FaceHandle>(wanted, mesh.n_faces(), [&](FaceHandle f) { return mesh.status(f).deleted(); }));
    case Kind::vertices:
      return Selection::of_vertices(mesh, handles_of<VertexHandle>(wanted, mesh.n_vertices(), [&](VertexHandle v) {
                                      return mesh.status(v).deleted();
                                    }));
    default:
      return Selection::of_loops(mesh, handles_of<HalfedgeHandle>(wanted, mesh.n_halfedges(), [&](HalfedgeHandle h) {
                                   return mesh.status(mesh.edge_handle(h)).deleted();
                                 }));
  }
}

void add_selection(py::module_& module) {
  py::class_<SelectionObject>(
      module, "Selection",
      "The part of a mesh that an operator may change: faces, vertices or boundary loops, as indices or as a mask with a bool for\n"
      "each (deleted ones included). Looked up in the mesh that an operator gets.")
      .def(
          py::init(&make_selection), py::kw_only(), py::arg("faces") = py::none(), py::arg("vertices") = py::none(),
          py::arg("loops") = py::none(),
          "faces: they, and the vertices all of whose faces are among them. vertices: they, and the faces all of whose corners are\n"
          "among them. loops: half-edges of boundary loops, one of each is enough. One of the three.");
}

}  // namespace tri::python
