#include "meshops/mesh_edit.hpp"

#include <vector>

#include "meshops/corner_values.hpp"
#include "meshops/property_types.hpp"

namespace tri {
namespace {

using Connectivity = OpenMesh::TriConnectivity;
using OpenMesh::Attributes::StatusInfo;

constexpr unsigned inherited_bits = OpenMesh::Attributes::SELECTED | OpenMesh::Attributes::LOCKED | OpenMesh::Attributes::FEATURE;

std::size_t index(OpenMesh::BaseHandle handle) { return static_cast<std::size_t>(handle.idx()); }

/// The status of a piece of an element.
StatusInfo piece_status(const StatusInfo& whole) {
  StatusInfo status;
  status.set_bits(whole.bits() & inherited_bits);
  return status;
}

void copy_face(Connectivity& mesh, FaceHandle from, FaceHandle to) {
  mesh.copy_all_properties(from, to, true);
  mesh.status(to) = piece_status(mesh.status(from));
}

void copy_edge(Connectivity& mesh, EdgeHandle from, EdgeHandle to) {
  mesh.copy_all_properties(from, to, true);
  mesh.status(to) = piece_status(mesh.status(from));
  for (const unsigned side : {0u, 1u}) {
    const HalfedgeHandle h = mesh.halfedge_handle(from, side), piece = mesh.halfedge_handle(to, side);
    mesh.copy_all_properties(h, piece, true);
    mesh.status(piece) = piece_status(mesh.status(h));
  }
}

/// Sets the corner values where a half-edge ends to a mean of those of other corners.
void blend_corner(Connectivity& mesh, std::span<const WeightedIndex> sources, HalfedgeHandle to) {
  const PropertyTypes& types = PropertyTypes::standard();
  for_each_corner_property(mesh, [&](OpenMesh::BaseProperty& property) {
    if (const PropertyType* type = types.find(property))
      type->blend(property, sources, index(to));
    else
      property.copy(greatest(sources), index(to));
  });
}

VertexHandle new_vertex(MeshView view, const Vec3& point, std::span<const VertexSource> sources, std::size_t edges,
                        std::size_t faces) {
  Connectivity& mesh = view.mesh;
  const VertexHandle v(static_cast<int>(mesh.n_vertices()));
  mesh.resize(mesh.n_vertices() + 1, mesh.n_edges() + edges, mesh.n_faces() + faces);
  blend_vertex(view, v, sources);
  view.point(v) = point;
  return v;
}

void set_ends(Connectivity& mesh, HalfedgeHandle h, VertexHandle from, VertexHandle to) {
  mesh.set_vertex_handle(h, to);
  mesh.set_vertex_handle(mesh.opposite_halfedge_handle(h), from);
}

void set_triangle(Connectivity& mesh, FaceHandle f, HalfedgeHandle a, HalfedgeHandle b, HalfedgeHandle c) {
  const std::array<HalfedgeHandle, 3> sides{a, b, c};
  for (int k = 0; k < 3; ++k) {
    mesh.set_face_handle(sides[k], f);
    mesh.set_next_halfedge_handle(sides[k], sides[(k + 1) % 3]);
  }
  mesh.set_halfedge_handle(f, a);
}

/// The corners of the vertex in which `h` begins take over what the corners where it ends have in the triangles beside it,
/// on either side as far as there is no seam.
void move_corners(Connectivity& mesh, HalfedgeHandle h) {
  const PropertyTypes& types = PropertyTypes::standard();
  const HalfedgeHandle o = mesh.opposite_halfedge_handle(h);
  std::vector<HalfedgeHandle> left, right;  // in the order in which the triangles follow
  for_each_corner_property(mesh, [&](OpenMesh::BaseProperty& property) {
    const PropertyType* type = types.find(property);
    const auto joined = [&](HalfedgeHandle a, HalfedgeHandle b) {
      return !mesh.is_boundary(b) && (!type || type->equal(property, index(a), index(b)));
    };
    left.clear();
    right.clear();
    if (!mesh.is_boundary(h)) {
      const HalfedgeHandle first = mesh.prev_halfedge_handle(h);
      for (HalfedgeHandle c = first; c != o && joined(first, c);
           c = mesh.prev_halfedge_handle(mesh.opposite_halfedge_handle(c)))
        left.push_back(c);
    }
    if (!mesh.is_boundary(o))
      for (HalfedgeHandle c = o; (left.empty() || c != left.back()) && joined(o, c);
           c = mesh.opposite_halfedge_handle(mesh.next_halfedge_handle(c)))
        right.push_back(c);
    for (const HalfedgeHandle c : left) property.copy(index(h), index(c));
    for (const HalfedgeHandle c : right) property.copy(index(mesh.prev_halfedge_handle(o)), index(c));
  });
}

}  // namespace

void set_point(MeshView view, VertexHandle v, const Vec3& point) { view.point(v) = point; }

void flip_edge(MeshView view, EdgeHandle edge) {
  Connectivity& mesh = view.mesh;
  for (const unsigned side : {0u, 1u}) {
    const HalfedgeHandle h = mesh.halfedge_handle(edge, side);
    copy_corner_values(mesh, mesh.next_halfedge_handle(h), h);
  }
  mesh.flip(edge);
}

VertexHandle split_edge(MeshView view, EdgeHandle edge, const Vec3& point, double share) {
  Connectivity& mesh = view.mesh;
  const std::array<HalfedgeHandle, 2> half{mesh.halfedge_handle(edge, 0), mesh.halfedge_handle(edge, 1)};
  const VertexHandle a = mesh.to_vertex_handle(half[1]), b = mesh.to_vertex_handle(half[0]);
  const std::array<FaceHandle, 2> face{mesh.face_handle(half[0]), mesh.face_handle(half[1])};
  const std::size_t sides = static_cast<std::size_t>(face[0].is_valid()) + face[1].is_valid();

  int next_edge = static_cast<int>(mesh.n_edges()), next_face = static_cast<int>(mesh.n_faces());
  const VertexHandle m = new_vertex(view, point, std::array{VertexSource{a, 1 - share}, VertexSource{b, share}}, 1 + sides, sides);
  const EdgeHandle new_half(next_edge++);
  copy_edge(mesh, edge, new_half);
  const HalfedgeHandle a_m = mesh.halfedge_handle(new_half, 0), m_a = mesh.halfedge_handle(new_half, 1);
  set_ends(mesh, a_m, a, m);
  mesh.set_vertex_handle(half[1], m);
  mesh.set_halfedge_handle(m, half[0]);
  if (mesh.halfedge_handle(a) == half[0]) mesh.set_halfedge_handle(a, a_m);

  if (face[0].is_valid()) {  // (a, b, c): the face keeps (m, b, c)
    const HalfedgeHandle b_c = mesh.next_halfedge_handle(half[0]), c_a = mesh.next_halfedge_handle(b_c);
    const HalfedgeHandle m_c = mesh.halfedge_handle(EdgeHandle(next_edge++), 0), c_m = mesh.opposite_halfedge_handle(m_c);
    const FaceHandle piece(next_face++);
    set_ends(mesh, m_c, m, mesh.to_vertex_handle(b_c));
    const std::array corners{WeightedIndex{index(c_a), 1 - share}, WeightedIndex{index(half[0]), share}};
    blend_corner(mesh, corners, c_m);
    copy_corner_values(mesh, c_m, a_m);
    copy_corner_values(mesh, b_c, m_c);
    set_triangle(mesh, face[0], half[0], b_c, c_m);
    set_triangle(mesh, piece, a_m, m_c, c_a);
    copy_face(mesh, face[0], piece);
  } else {
    mesh.set_next_halfedge_handle(mesh.prev_halfedge_handle(half[0]), a_m);
    mesh.set_next_halfedge_handle(a_m, half[0]);
  }
  if (face[1].is_valid()) {  // (b, a, d): the face keeps (b, m, d)
    const HalfedgeHandle a_d = mesh.next_halfedge_handle(half[1]), d_b = mesh.next_halfedge_handle(a_d);
    const HalfedgeHandle m_d = mesh.halfedge_handle(EdgeHandle(next_edge++), 0), d_m = mesh.opposite_halfedge_handle(m_d);
    const FaceHandle piece(next_face++);
    set_ends(mesh, m_d, m, mesh.to_vertex_handle(a_d));
    // The new half already has the values at a; the old one, which ends at m now, changes last.
    const std::array corners{WeightedIndex{index(half[1]), 1 - share}, WeightedIndex{index(d_b), share}};
    blend_corner(mesh, corners, d_m);
    copy_corner_values(mesh, d_m, half[1]);
    copy_corner_values(mesh, a_d, m_d);
    set_triangle(mesh, face[1], half[1], m_d, d_b);
    set_triangle(mesh, piece, m_a, a_d, d_m);
    copy_face(mesh, face[1], piece);
  } else {
    mesh.set_next_halfedge_handle(m_a, mesh.next_halfedge_handle(half[1]));
    mesh.set_next_halfedge_handle(half[1], m_a);
    mesh.set_halfedge_handle(m, m_a);
  }
  return m;
}

VertexHandle split_face(MeshView view, FaceHandle face, const Vec3& point, const std::array<double, 3>& weights) {
  Connectivity& mesh = view.mesh;
  std::array<HalfedgeHandle, 3> side;  // side[k] ends in corner[k]
  std::array<VertexHandle, 3> corner;
  side[0] = mesh.halfedge_handle(face);
  for (int k = 1; k < 3; ++k) side[k] = mesh.next_halfedge_handle(side[k - 1]);
  for (int k = 0; k < 3; ++k) corner[k] = mesh.to_vertex_handle(side[k]);

  const int first_edge = static_cast<int>(mesh.n_edges()), first_face = static_cast<int>(mesh.n_faces());
  std::array<VertexSource, 3> sources;
  std::array<WeightedIndex, 3> corners;
  for (int k = 0; k < 3; ++k) {
    sources[k] = {corner[k], weights[k]};
    corners[k] = {index(side[k]), weights[k]};
  }
  const VertexHandle m = new_vertex(view, point, sources, 3, 2);
  std::array<HalfedgeHandle, 3> in, out;
  for (int k = 0; k < 3; ++k) {
    in[k] = mesh.halfedge_handle(EdgeHandle(first_edge + k), 0);
    out[k] = mesh.opposite_halfedge_handle(in[k]);
    set_ends(mesh, in[k], corner[k], m);
    blend_corner(mesh, corners, in[k]);
    copy_corner_values(mesh, side[k], out[k]);
  }
  const std::array<FaceHandle, 3> piece{face, FaceHandle(first_face), FaceHandle(first_face + 1)};
  for (int k = 0; k < 3; ++k) set_triangle(mesh, piece[k], side[k], in[k], out[(k + 2) % 3]);
  for (int k = 1; k < 3; ++k) copy_face(mesh, face, piece[k]);
  mesh.set_halfedge_handle(m, out[0]);
  return m;
}

void collapse(MeshView view, HalfedgeHandle h) {
  Connectivity& mesh = view.mesh;
  const HalfedgeHandle o = mesh.opposite_halfedge_handle(h);
  // Of the triangles (from, to, x) and (to, from, y) the edges at `to` stay, and take the place of those at `from`.
  move_corners(mesh, h);
  const auto merge = [&](HalfedgeHandle goes, HalfedgeHandle stays) {
    copy_corner_values(mesh, goes, stays);
    const EdgeHandle from = mesh.edge_handle(goes), to = mesh.edge_handle(stays);
    if (mesh.status(from).feature()) mesh.status(to).set_feature(true);
  };
  if (!mesh.is_boundary(h)) merge(mesh.opposite_halfedge_handle(mesh.prev_halfedge_handle(h)), mesh.next_halfedge_handle(h));
  if (!mesh.is_boundary(o)) merge(mesh.opposite_halfedge_handle(mesh.next_halfedge_handle(o)), mesh.prev_halfedge_handle(o));
  mesh.collapse(h);
}

void delete_face(MeshView view, FaceHandle face) { view.mesh.delete_face(face, false); }

void delete_vertex(MeshView view, VertexHandle v) {
  Connectivity& mesh = view.mesh;
  std::vector<FaceHandle> faces;
  if (!mesh.is_isolated(v))
    for (auto it = mesh.cvf_iter(v); it.is_valid(); ++it) faces.push_back(*it);
  for (const FaceHandle f : faces) delete_face(view, f);
  mesh.status(v).set_deleted(true);
}

VertexHandle add_vertex(MeshView view, const Vec3& point, std::span<const VertexSource> sources) {
  return new_vertex(view, point, sources, 0, 0);
}

void blend_vertex(MeshView view, VertexHandle v, std::span<const VertexSource> sources) {
  if (sources.empty()) return;
  Connectivity& mesh = view.mesh;
  const PropertyTypes& types = PropertyTypes::standard();
  std::array<WeightedIndex, 8> few;
  std::vector<WeightedIndex> many(sources.size() > few.size() ? sources.size() : 0);
  const std::span<WeightedIndex> indices = many.empty() ? std::span(few).first(sources.size()) : std::span(many);
  for (std::size_t i = 0; i < sources.size(); ++i) indices[i] = {index(sources[i].vertex), sources[i].weight};

  const OpenMesh::BaseProperty* const position = &mesh.property(view.position_property);
  for (auto it = mesh.vprops_begin(); it != mesh.vprops_end(); ++it) {
    OpenMesh::BaseProperty* const property = *it;
    if (!property || property == position || property->name() == "v:status") continue;
    const PropertyType* type = property->name() == property::uv ? nullptr : types.find(*property);
    if (property->name() == property::point_index && dynamic_cast<OpenMesh::PropertyT<int>*>(property))
      (*static_cast<OpenMesh::PropertyT<int>*>(property))[v.idx()] = -1;
    else if (type)
      type->blend(*property, indices, index(v));
    else
      property->copy(greatest(indices), index(v));
  }
}

void blend_corners(MeshView view, HalfedgeHandle h, double share) {
  Connectivity& mesh = view.mesh;
  const PropertyTypes& types = PropertyTypes::standard();
  const HalfedgeHandle o = mesh.opposite_halfedge_handle(h);
  std::vector<HalfedgeHandle> left, right;  // corners at the end of `h`, in the order in which the triangles follow
  for_each_corner_property(mesh, [&](OpenMesh::BaseProperty& property) {
    const PropertyType* type = types.find(property);
    if (!type) return;
    const auto joined = [&](HalfedgeHandle a, HalfedgeHandle b) {
      return !mesh.is_boundary(b) && type->equal(property, index(a), index(b));
    };
    left.clear();
    right.clear();
    if (!mesh.is_boundary(h)) {
      HalfedgeHandle c = h;
      do {
        left.push_back(c);
        c = mesh.opposite_halfedge_handle(mesh.next_halfedge_handle(c));
      } while (c != h && joined(h, c));
    }
    if (!mesh.is_boundary(o)) {
      const HalfedgeHandle first = mesh.prev_halfedge_handle(o);
      for (HalfedgeHandle c = first; (left.empty() || c != left.back()) && joined(first, c);) {
        right.push_back(c);
        c = mesh.prev_halfedge_handle(mesh.opposite_halfedge_handle(c));
        if (c == first) break;
      }
    }
    const auto blend = [&](const std::vector<HalfedgeHandle>& corners, HalfedgeHandle at_start) {
      if (corners.empty()) return;
      const std::array sources{WeightedIndex{index(at_start), 1 - share}, WeightedIndex{index(corners.front()), share}};
      type->blend(property, sources, index(corners.front()));
      for (const HalfedgeHandle c : corners)
        if (c != corners.front()) property.copy(index(corners.front()), index(c));
    };
    blend(left, mesh.prev_halfedge_handle(h));
    blend(right, o);
  });
}

void reverse_faces(MeshView view, std::span<const FaceHandle> faces) {
  Connectivity& mesh = view.mesh;
  struct Link {
    HalfedgeHandle halfedge, next;
    VertexHandle from;
  };
  std::vector<Link> links;
  std::vector<std::pair<VertexHandle, HalfedgeHandle>> outgoing;
  for (const FaceHandle f : faces) {
    const HalfedgeHandle first = mesh.halfedge_handle(f);
    HalfedgeHandle h = first;
    do {
      const HalfedgeHandle o = mesh.opposite_halfedge_handle(h);
      links.push_back({h, mesh.next_halfedge_handle(h), mesh.from_vertex_handle(h)});
      if (mesh.is_boundary(o)) links.push_back({o, mesh.next_halfedge_handle(o), mesh.from_vertex_handle(o)});
      h = mesh.next_halfedge_handle(h);
    } while (h != first);
  }
  for (const Link& l : links)
    if (mesh.halfedge_handle(l.from) == l.halfedge)
      outgoing.push_back({l.from, mesh.prev_halfedge_handle(l.halfedge)});
  // The corner where a half-edge ended is where the one after it ends now.
  for (const FaceHandle f : faces) {
    const HalfedgeHandle a = mesh.halfedge_handle(f), b = mesh.next_halfedge_handle(a), c = mesh.next_halfedge_handle(b);
    for_each_corner_property(mesh, [&](OpenMesh::BaseProperty& property) {
      property.swap(index(c), index(b));
      property.swap(index(b), index(a));
    });
  }
  for (const Link& l : links) {
    mesh.set_vertex_handle(l.halfedge, l.from);
    mesh.set_next_halfedge_handle(l.next, l.halfedge);
  }
  for (const auto& [v, h] : outgoing) mesh.set_halfedge_handle(v, h);
}

}  // namespace tri
