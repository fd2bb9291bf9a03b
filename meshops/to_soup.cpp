#include "meshops/to_soup.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "meshops/editing/label_property.hpp"
#include "meshops/editing/number_properties.hpp"
#include "meshops/pace.hpp"

namespace tri {
namespace {

using OpenMesh::PropertyT;
/// Of elements that stay.
struct Indices {
  std::span<const std::uint32_t> list;
  const Context* context = nullptr;  ///< null: cannot be cancelled

  std::size_t size() const { return list.size(); }
  std::uint32_t operator[](std::size_t i) const { return list[i]; }
  auto begin() const { return list.begin(); }
  auto end() const { return list.end(); }
};

template <class Visit>
void for_all(std::size_t n, const Context* context, const Visit& visit) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 4096), [&](const auto& range) {
    if (context) context->checkpoint();
    for (std::size_t i = range.begin(); i < range.end(); ++i) visit(i);
  });
}

using Scalars = std::map<std::string, std::vector<double>>;

/// One number per element that stays. @param number  of the element with an index
std::vector<double> gather(Indices elements, const auto& number) {
  std::vector<double> values(elements.size());
  for_all(elements.size(), elements.context,
          [&](std::size_t k) { values[k] = static_cast<double>(number(elements[k])); });
  return values;
}

/// Bools and numbers become the scalar `name`, vectors a scalar for each of their numbers. @return whether the property
/// holds such
bool add_scalars(const OpenMesh::BaseProperty& property, const std::string& name, Indices elements, Scalars& scalars,
                 std::span<const char* const> columns = {}) {
  if (const auto* flags = dynamic_cast<const PropertyT<bool>*>(&property)) {
    scalars[name] = gather(elements, [&](std::uint32_t i) { return (*flags)[static_cast<int>(i)]; });
    return true;
  }
  return visit_numbers(property, [&](const auto& rows) {
    const bool named = rows.vector && static_cast<int>(columns.size()) == rows.size;
    for (int k = 0; k < rows.size; ++k)
      scalars[!rows.vector ? name
              : named      ? columns[static_cast<std::size_t>(k)]
                      : name + "_" + std::to_string(k)] = gather(elements, [&](std::uint32_t i) { return rows(i, k); });
  });
}

constexpr std::array uv_columns{"u", "v"}, texture_columns{"s", "t"};

/// The names of the columns of vectors that have a meaning; none for others.
std::span<const char* const> columns_of(std::string_view name) {
  if (name == "uv") return uv_columns;
  if (name == "texcoords2D") return texture_columns;
  return {};
}

/// Red, green, blue, and alpha if anything is not opaque, in [0,255]; nothing if that is not what the property holds.
std::vector<std::vector<double>> color_columns(const OpenMesh::BaseProperty& property, Indices elements) {
  std::vector<std::vector<double>> columns;
  visit_numbers(property, [&](const auto& rows) {
    if (rows.size != 3 && rows.size != 4) return;
    using Number = std::remove_cvref_t<decltype(rows(0))>;
    constexpr double top = std::is_floating_point_v<Number> ? 1 : 255;
    for (int k = 0; k < rows.size; ++k) {
      auto& column = columns.emplace_back(gather(elements, [&](std::uint32_t i) { return rows(i, k); }));
      if (!std::ranges::all_of(column, [](double c) { return c >= 0 && c <= top; })) return columns.clear();
      for (double& c : column) c = std::round(c * (255 / top));
    }
  });
  if (columns.size() == 4 && std::ranges::all_of(columns[3], [](double a) { return a == 255; })) columns.pop_back();
  return columns;
}

bool gather_normals(const OpenMesh::BaseProperty& property, Indices vertices, Soup& soup) {
  bool gathered = false;
  visit_numbers(property, [&](const auto& rows) {
    if (rows.size != 3) return;
    gathered = true;
    for (const std::uint32_t i : vertices)
      soup.vertex_normals.emplace_back(static_cast<double>(rows(i, 0)), static_cast<double>(rows(i, 1)),
                                       static_cast<double>(rows(i, 2)));
  });
  return gathered;
}

void gather_vertex_property(const OpenMesh::BaseProperty& property, Indices vertices, Soup& soup) {
  if (!property.name().starts_with("v:")) return;
  const std::string name = property.name().substr(2);
  if (name == "points" || (name == "normals" && gather_normals(property, vertices, soup))) return;
  if (name == "colors") {
    if (auto c = color_columns(property, vertices); !c.empty()) {
      soup.vertex_colors.resize(vertices.size());
      for (std::size_t i = 0; i < vertices.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) soup.vertex_colors[i][k] = static_cast<std::uint8_t>(c[k][i]);
      if (c.size() == 4) soup.vertex_scalars["alpha"] = std::move(c[3]);
      return;
    }
  }
  add_scalars(property, name, vertices, soup.vertex_scalars, columns_of(name));
}

void gather_face_property(const OpenMesh::BaseProperty& property, Indices faces, Soup& soup) {
  if (!property.name().starts_with("f:")) return;
  const std::string name = property.name().substr(2);
  if (name == "normals") return;
  if (name == "colors") {
    if (auto c = color_columns(property, faces); !c.empty()) {
      constexpr std::array channels{"red", "green", "blue", "alpha"};
      for (std::size_t k = 0; k < c.size(); ++k) soup.face_scalars[channels[k]] = std::move(c[k]);
      return;
    }
  }
  add_scalars(property, name, faces, soup.face_scalars, columns_of(name));
}

}  // namespace

Soup to_soup(const MeshView& view, const Context* context) {
  Pace pace(context);
  const OpenMesh::TriConnectivity& mesh = view.mesh;
  const bool vertex_status = mesh.has_vertex_status(), face_status = mesh.has_face_status();
  Soup soup;
  std::vector<std::uint32_t> vertices, faces, number(mesh.n_vertices());
  vertices.reserve(mesh.n_vertices());
  for (std::uint32_t i = 0; i < mesh.n_vertices(); ++i, pace()) {
    if (vertex_status && mesh.status(VertexHandle(static_cast<int>(i))).deleted()) continue;
    number[i] = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back(i);
  }
  faces.reserve(mesh.n_faces());
  for (std::uint32_t i = 0; i < mesh.n_faces(); ++i, pace())
    if (!face_status || !mesh.status(FaceHandle(static_cast<int>(i))).deleted()) faces.push_back(i);
  soup.points.resize(vertices.size());
  for_all(vertices.size(), context,
          [&](std::size_t k) { soup.points[k] = view.point(VertexHandle(static_cast<int>(vertices[k]))); });
  soup.triangles.resize(faces.size());
  for_all(faces.size(), context, [&](std::size_t k) {
    // `build_mesh` stores the side from a triangle's first corner, so triples come back as they were.
    const HalfedgeHandle a = mesh.halfedge_handle(FaceHandle(static_cast<int>(faces[k]))),
                         b = mesh.next_halfedge_handle(a);
    const auto corner = [&](HalfedgeHandle h) { return number[mesh.from_vertex_handle(h).idx()]; };
    soup.triangles[k] = {corner(a), corner(b), corner(mesh.next_halfedge_handle(b))};
  });
  for (auto it = mesh.vprops_begin(); it != mesh.vprops_end(); ++it)
    if (*it) gather_vertex_property(**it, {vertices, context}, soup);
  for (auto it = mesh.fprops_begin(); it != mesh.fprops_end(); ++it)
    if (*it) gather_face_property(**it, {faces, context}, soup);
  std::vector<std::uint32_t> corners;  // half-edges
  for (auto it = mesh.hprops_begin(); it != mesh.hprops_end(); ++it) {
    if (!*it || !(*it)->name().starts_with("h:")) continue;
    for (std::size_t i = corners.size() / 3; i < faces.size(); ++i, pace()) {
      const HalfedgeHandle first = mesh.halfedge_handle(FaceHandle(static_cast<int>(faces[i])));
      HalfedgeHandle h = mesh.prev_halfedge_handle(first);  // ends in the first corner
      for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h))
        corners.push_back(static_cast<std::uint32_t>(h.idx()));
    }
    const std::string name = (*it)->name().substr(2);
    add_scalars(**it, name, {corners, context}, soup.corner_scalars, columns_of(name));
  }
  for (auto it = mesh.mprops_begin(); it != mesh.mprops_end(); ++it) {
    if (!*it || !(*it)->name().starts_with(property::labels)) continue;
    if (const auto* labels = dynamic_cast<const PropertyT<std::vector<std::string>>*>(*it))
      soup.face_labels[(*it)->name().substr(std::string_view(property::labels).size())] = (*labels)[0];
  }
  return soup;
}

}  // namespace tri
