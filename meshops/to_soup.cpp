#include "meshops/to_soup.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "meshops/editing/label_property.hpp"

namespace tri {
namespace {

using OpenMesh::PropertyT;
using Indices = std::span<const std::uint32_t>;

constexpr const char* normals_name = "v:normals";
constexpr const char* colors_name = "v:colors";

template <class Visit>
void for_all(std::size_t n, const Visit& visit) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) visit(i);
  });
}

/// One number per element that stays, if `property` holds numbers.
std::optional<std::vector<double>> numbers(const OpenMesh::BaseProperty& property, Indices elements) {
  const auto gather = [&](const auto& typed) {
    std::vector<double> values(elements.size());
    for_all(elements.size(), [&](std::size_t k) { values[k] = static_cast<double>(typed[static_cast<int>(elements[k])]); });
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
      u.resize(vertices.size());
      v.resize(vertices.size());
      for_all(vertices.size(), [&](std::size_t k) {
        const Vec2& place = (*uv)[static_cast<int>(vertices[k])];
        u[k] = place[0];
        v[k] = place[1];
      });
    }
  } else if (name.starts_with("v:")) {
    if (auto values = numbers(property, vertices)) soup.vertex_scalars[name.substr(2)] = std::move(*values);
  }
}

}  // namespace

Soup to_soup(const MeshView& view) {
  const OpenMesh::TriConnectivity& mesh = view.mesh;
  const bool vertex_status = mesh.has_vertex_status(), face_status = mesh.has_face_status();
  Soup soup;
  std::vector<std::uint32_t> vertices, faces, number(mesh.n_vertices());
  vertices.reserve(mesh.n_vertices());
  for (std::uint32_t i = 0; i < mesh.n_vertices(); ++i) {
    if (vertex_status && mesh.status(VertexHandle(static_cast<int>(i))).deleted()) continue;
    number[i] = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back(i);
  }
  faces.reserve(mesh.n_faces());
  for (std::uint32_t i = 0; i < mesh.n_faces(); ++i)
    if (!face_status || !mesh.status(FaceHandle(static_cast<int>(i))).deleted()) faces.push_back(i);
  soup.points.resize(vertices.size());
  for_all(vertices.size(),
          [&](std::size_t k) { soup.points[k] = view.point(VertexHandle(static_cast<int>(vertices[k]))); });
  soup.triangles.resize(faces.size());
  for_all(faces.size(), [&](std::size_t k) {
    // `build_mesh` stores the side from a triangle's first corner, so triples come back as they were.
    const HalfedgeHandle a = mesh.halfedge_handle(FaceHandle(static_cast<int>(faces[k]))), b = mesh.next_halfedge_handle(a);
    const auto corner = [&](HalfedgeHandle h) { return number[mesh.from_vertex_handle(h).idx()]; };
    soup.triangles[k] = {corner(a), corner(b), corner(mesh.next_halfedge_handle(b))};
  });
  for (auto it = mesh.vprops_begin(); it != mesh.vprops_end(); ++it)
    if (*it) gather_vertex_property(**it, vertices, soup);
  for (auto it = mesh.fprops_begin(); it != mesh.fprops_end(); ++it) {
    if (!*it || !(*it)->name().starts_with("f:")) continue;
    if (auto values = numbers(**it, faces)) soup.face_scalars[(*it)->name().substr(2)] = std::move(*values);
  }
  std::vector<std::uint32_t> corners;  // half-edges
  for (auto it = mesh.hprops_begin(); it != mesh.hprops_end(); ++it) {
    if (!*it || !(*it)->name().starts_with("h:")) continue;
    for (std::size_t i = corners.size() / 3; i < faces.size(); ++i) {
      const HalfedgeHandle first = mesh.halfedge_handle(FaceHandle(static_cast<int>(faces[i])));
      HalfedgeHandle h = mesh.prev_halfedge_handle(first);  // ends in the first corner
      for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h)) corners.push_back(static_cast<std::uint32_t>(h.idx()));
    }
    if (auto values = numbers(**it, corners)) soup.corner_scalars[(*it)->name().substr(2)] = std::move(*values);
  }
  for (auto it = mesh.mprops_begin(); it != mesh.mprops_end(); ++it) {
    if (!*it || !(*it)->name().starts_with(property::labels)) continue;
    if (const auto* labels = dynamic_cast<const PropertyT<std::vector<std::string>>*>(*it))
      soup.face_labels[(*it)->name().substr(std::string_view(property::labels).size())] = (*labels)[0];
  }
  return soup;
}

}  // namespace tri
