#include "meshops/to_soup.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace tri {
namespace {

using OpenMesh::PropertyT;
using Indices = std::span<const std::uint32_t>;

constexpr const char* normals_name = "v:normals";
constexpr const char* colors_name = "v:colors";

bool whole_numbers(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double v) {
    return v == std::floor(v) && std::abs(v) <= static_cast<double>(std::numeric_limits<int>::max());
  });
}

template <class T, class Value>
void add_vertex_property(Mesh& mesh, const std::string& name, Indices source, const Value& value) {
  OpenMesh::VPropHandleT<T> handle;
  mesh.add_property(handle, name);
  for (std::size_t i = 0; i < source.size(); ++i)
    mesh.property(handle, VertexHandle(static_cast<int>(i))) = value(source[i]);
}

/// One number per element that stays, if `property` holds numbers.
std::optional<std::vector<double>> numbers(const OpenMesh::BaseProperty& property, Indices elements) {
  const auto gather = [&](const auto& typed) {
    std::vector<double> values;
    for (const std::uint32_t i : elements) values.push_back(static_cast<double>(typed[static_cast<int>(i)]));
    return values;
  };
  if (const auto* p = dynamic_cast<const PropertyT<double>*>(&property)) return gather(*p);
  if (const auto* p = dynamic_cast<const PropertyT<float>*>(&property)) return gather(*p);
  if (const auto* p = dynamic_cast<const PropertyT<int>*>(&property)) return gather(*p);
  return std::nullopt;
}

template <class Vector>
bool gather_normals(const OpenMesh::BaseProperty& property, Indices vertices, Soup& soup) {
  const auto* typed = dynamic_cast<const PropertyT<Vector>*>(&property);
  if (!typed) return false;
  for (const std::uint32_t i : vertices) {
    const Vector& n = (*typed)[static_cast<int>(i)];
    soup.vertex_normals.emplace_back(static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2]));
  }
  return true;
}

void gather_vertex_property(const OpenMesh::BaseProperty& property, Indices vertices, Soup& soup) {
  const std::string& name = property.name();
  if (name == normals_name) {
    if (!gather_normals<Vec3>(property, vertices, soup)) gather_normals<OpenMesh::Vec3f>(property, vertices, soup);
  } else if (name == colors_name) {
    if (const auto* colors = dynamic_cast<const PropertyT<OpenMesh::Vec3uc>*>(&property)) {
      for (const std::uint32_t i : vertices) {
        const OpenMesh::Vec3uc& c = (*colors)[static_cast<int>(i)];
        soup.vertex_colors.push_back({c[0], c[1], c[2]});
      }
    }
  } else if (name == property::uv) {
    if (const auto* uv = dynamic_cast<const PropertyT<Vec2>*>(&property)) {
      std::vector<double>&u = soup.vertex_scalars["u"], &v = soup.vertex_scalars["v"];
      for (const std::uint32_t i : vertices) {
        u.push_back((*uv)[static_cast<int>(i)][0]);
        v.push_back((*uv)[static_cast<int>(i)][1]);
      }
    }
  } else if (name.starts_with("v:")) {
    if (auto values = numbers(property, vertices)) soup.vertex_scalars[name.substr(2)] = std::move(*values);
  }
}

}  // namespace

void set_attributes(const Soup& soup, Indices point_of_vertex, Indices triangle_of_face, Mesh& mesh) {
  const bool has_uv = soup.vertex_scalars.contains("u") && soup.vertex_scalars.contains("v");
  for (const auto& scalar : soup.vertex_scalars) {
    const std::string& name = scalar.first;
    const std::vector<double>& values = scalar.second;  // no binding: lambdas capture none before Clang 16
    const std::string full = "v:" + name;
    if (has_uv && name == "v") continue;
    if (has_uv && name == "u") {
      const std::vector<double>& v = soup.vertex_scalars.at("v");
      add_vertex_property<Vec2>(mesh, property::uv, point_of_vertex,
                                [&](std::uint32_t i) { return Vec2(values[i], v[i]); });
    } else if ((full == property::point_index || full == property::cad_face) && whole_numbers(values)) {
      add_vertex_property<int>(mesh, full, point_of_vertex,
                               [&](std::uint32_t i) { return static_cast<int>(values[i]); });
    } else {
      add_vertex_property<double>(mesh, full, point_of_vertex, [&](std::uint32_t i) { return values[i]; });
    }
  }
  for (const auto& [name, values] : soup.face_scalars) {
    OpenMesh::FPropHandleT<double> handle;
    mesh.add_property(handle, "f:" + name);
    for (std::size_t i = 0; i < triangle_of_face.size(); ++i)
      mesh.property(handle, FaceHandle(static_cast<int>(i))) = values[triangle_of_face[i]];
  }
  if (!soup.vertex_normals.empty()) {
    mesh.request_vertex_normals();
    for (std::size_t i = 0; i < point_of_vertex.size(); ++i)
      mesh.set_normal(VertexHandle(static_cast<int>(i)), soup.vertex_normals[point_of_vertex[i]]);
  }
  if (!soup.vertex_colors.empty()) {
    mesh.request_vertex_colors();
    for (std::size_t i = 0; i < point_of_vertex.size(); ++i) {
      const auto [r, g, b] = soup.vertex_colors[point_of_vertex[i]];
      mesh.set_color(VertexHandle(static_cast<int>(i)), {r, g, b});
    }
  }
}

Soup to_soup(const MeshView& view) {
  const OpenMesh::TriConnectivity& mesh = view.mesh;
  const bool vertex_status = mesh.has_vertex_status(), face_status = mesh.has_face_status();
  Soup soup;
  std::vector<std::uint32_t> vertices, faces, number(mesh.n_vertices());
  for (std::uint32_t i = 0; i < mesh.n_vertices(); ++i) {
    const VertexHandle v(static_cast<int>(i));
    if (vertex_status && mesh.status(v).deleted()) continue;
    number[i] = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back(i);
    soup.points.push_back(view.point(v));
  }
  for (std::uint32_t i = 0; i < mesh.n_faces(); ++i) {
    const FaceHandle f(static_cast<int>(i));
    if (face_status && mesh.status(f).deleted()) continue;
    faces.push_back(i);
    // `build_mesh` stores the side from a triangle's first corner, so triples come back as they were.
    const HalfedgeHandle a = mesh.halfedge_handle(f), b = mesh.next_halfedge_handle(a);
    const auto corner = [&](HalfedgeHandle h) { return number[mesh.from_vertex_handle(h).idx()]; };
    soup.triangles.push_back({corner(a), corner(b), corner(mesh.next_halfedge_handle(b))});
  }
  for (auto it = mesh.vprops_begin(); it != mesh.vprops_end(); ++it)
    if (*it) gather_vertex_property(**it, vertices, soup);
  for (auto it = mesh.fprops_begin(); it != mesh.fprops_end(); ++it) {
    if (!*it || !(*it)->name().starts_with("f:")) continue;
    if (auto values = numbers(**it, faces)) soup.face_scalars[(*it)->name().substr(2)] = std::move(*values);
  }
  return soup;
}

}  // namespace tri
