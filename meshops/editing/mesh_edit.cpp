#include "meshops/editing/mesh_edit.hpp"

#include <vector>

#include "meshops/editing/new_values.hpp"

namespace tri {
namespace {

using Connectivity = OpenMesh::TriConnectivity;
using OpenMesh::Attributes::StatusInfo;

constexpr unsigned inherited_bits =
    OpenMesh::Attributes::SELECTED | OpenMesh::Attributes::LOCKED | OpenMesh::Attributes::FEATURE;

/// The status of a piece of an element.
StatusInfo piece_status(const StatusInfo& whole) {
  StatusInfo status;
  status.set_bits(whole.bits() & inherited_bits);
  return status;
}

void copy_face(MeshView view, FaceHandle from, FaceHandle to) {
  inherit_values(view, ElementKind::face, from, to);
  view.mesh.status(to) = piece_status(view.mesh.status(from));
}

void copy_edge(MeshView view, EdgeHandle from, EdgeHandle to) {
  inherit_values(view, ElementKind::edge, from, to);
  view.mesh.status(to) = piece_status(view.mesh.status(from));
  for (const unsigned side : {0u, 1u}) {
    const HalfedgeHandle h = view.mesh.halfedge_handle(from, side), piece = view.mesh.halfedge_handle(to, side);
    inherit_values(view, ElementKind::halfedge, h, piece);
    view.mesh.status(piece) = piece_status(view.mesh.status(h));
  }
}

/// Sets the corner values where a half-edge ends to a mean of those of other corners.
void blend_corner(MeshView view, std::span<const WeightedIndex> sources, HalfedgeHandle to) {
  for_each_corner_property(
      view.mesh, [&](OpenMesh::BaseProperty& property) { view.policy->inherit(property, sources, index_of(to)); });
}

void inherit_vertex(MeshView view, VertexHandle v, std::span<const VertexSource> sources) {
  Connectivity& mesh = view.mesh;
  std::array<WeightedIndex, 8> few;
  std::vector<WeightedIndex> many(sources.size() > few.size() ? sources.size() : 0);
  const std::span<WeightedIndex> indices = many.empty() ? std::span(few).first(sources.size()) : std::span(many);
  for (std::size_t i = 0; i < sources.size(); ++i) indices[i] = {index_of(sources[i].vertex), sources[i].weight};
  const OpenMesh::BaseProperty* const position = &mesh.property(view.position_property);
  const OpenMesh::BaseProperty* const status = &mesh.property(mesh.vertex_status_pph());
  for (OpenMesh::BaseProperty* property : property_slots(mesh, ElementKind::vertex))
    if (property && property != position && property != status && property->name() != "v:points")
      view.policy->inherit(*property, indices, index_of(v));
}

VertexHandle new_vertex(MeshView view, const Vec3& point, std::span<const VertexSource> sources, std::size_t edges,
                        std::size_t faces) {
  Connectivity& mesh = view.mesh;
  const VertexHandle v(static_cast<int>(mesh.n_vertices()));
  mesh.resize(mesh.n_vertices() + 1, mesh.n_edges() + edges, mesh.n_faces() + faces);
  inherit_vertex(view, v, sources);
  view.point(v) = point;
  return v;
}

/// Announces the links of a half-edge, of those before and after it, and of its face.
void announce_side(MeshView view, HalfedgeHandle h) {
  const Connectivity& mesh = view.mesh;
  for (const HalfedgeHandle side : {h, mesh.next_halfedge_handle(h), mesh.prev_halfedge_handle(h)})
    view.recorder->links(mesh.edge_handle(side));
  if (!mesh.is_boundary(h)) view.recorder->links(mesh.face_handle(h));
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

/// The corners of the vertex in which `h` begins take over what the corners where it ends have in the triangles beside
/// it, on either side as far as there is no seam.
void move_corners(MeshView view, HalfedgeHandle h) {
  const Connectivity& mesh = view.mesh;
  const HalfedgeHandle o = mesh.opposite_halfedge_handle(h);
  std::vector<HalfedgeHandle> left, right;  // in the order in which the triangles follow
  for_each_corner_property(view.mesh, [&](OpenMesh::BaseProperty& property) {
    const PropertyType* type = view.policy->types().find(property);
    const auto joined = [&](HalfedgeHandle a, HalfedgeHandle b) {
      return !mesh.is_boundary(b) && (!type || type->equal(property, index_of(a), index_of(b)));
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
    for (const HalfedgeHandle c : left) property.copy(index_of(h), index_of(c));
    for (const HalfedgeHandle c : right) property.copy(index_of(mesh.prev_halfedge_handle(o)), index_of(c));
  });
}

void announce_collapse(MeshView view, HalfedgeHandle h) {
  const Connectivity& mesh = view.mesh;
  ChangeRecorder& r = *view.recorder;
  const VertexHandle from = mesh.from_vertex_handle(h);
  r.links(from);
  r.links(mesh.to_vertex_handle(h));
  r.status(from);
  for (auto it = mesh.cvih_iter(from); it.is_valid(); ++it) {
    r.links(mesh.edge_handle(*it));
    r.corner(*it);
    if (!mesh.is_boundary(*it)) r.links(mesh.face_handle(*it));
  }
  r.status(mesh.edge_handle(h));
  for (const HalfedgeHandle half : {h, mesh.opposite_halfedge_handle(h)}) {
    announce_side(view, half);
    if (mesh.is_boundary(half)) continue;
    r.status(mesh.face_handle(half));
    for (const HalfedgeHandle side : {mesh.next_halfedge_handle(half), mesh.prev_halfedge_handle(half)}) {
      r.status(mesh.edge_handle(side));
      r.corner(side);
      r.links(mesh.to_vertex_handle(side));
      announce_side(view, mesh.opposite_halfedge_handle(side));
    }
  }
}

}  // namespace

void set_point(MeshView view, VertexHandle v, const Vec3& point) {
  if (view.recorder) view.recorder->point(v);
  view.point(v) = point;
}

void flip_edge(MeshView view, EdgeHandle edge) {
  Connectivity& mesh = view.mesh;
  const std::array<HalfedgeHandle, 2> half{mesh.halfedge_handle(edge, 0), mesh.halfedge_handle(edge, 1)};
  if (view.recorder)
    for (const HalfedgeHandle h : half) {
      announce_side(view, h);
      view.recorder->links(mesh.to_vertex_handle(h));
      view.recorder->corner(h);
    }
  for (const HalfedgeHandle h : half) copy_corner_values(mesh, mesh.next_halfedge_handle(h), h);
  mesh.flip(edge);
}

VertexHandle split_edge(MeshView view, EdgeHandle edge, const Vec3& point, double share) {
  Connectivity& mesh = view.mesh;
  const std::array<HalfedgeHandle, 2> half{mesh.halfedge_handle(edge, 0), mesh.halfedge_handle(edge, 1)};
  const VertexHandle a = mesh.to_vertex_handle(half[1]), b = mesh.to_vertex_handle(half[0]);
  const std::array<FaceHandle, 2> face{mesh.face_handle(half[0]), mesh.face_handle(half[1])};
  const std::size_t sides = static_cast<std::size_t>(face[0].is_valid()) + face[1].is_valid();
  if (view.recorder) {
    for (const HalfedgeHandle h : half) announce_side(view, h);
    view.recorder->links(a);
    view.recorder->corner(half[1]);
  }

  int next_edge = static_cast<int>(mesh.n_edges()), next_face = static_cast<int>(mesh.n_faces());
  const VertexHandle m =
      new_vertex(view, point, std::array{VertexSource{a, 1 - share}, VertexSource{b, share}}, 1 + sides, sides);
  const EdgeHandle new_half(next_edge++);
  copy_edge(view, edge, new_half);
  const HalfedgeHandle a_m = mesh.halfedge_handle(new_half, 0), m_a = mesh.halfedge_handle(new_half, 1);
  set_ends(mesh, a_m, a, m);
  mesh.set_vertex_handle(half[1], m);
  mesh.set_halfedge_handle(m, half[0]);
  if (mesh.halfedge_handle(a) == half[0]) mesh.set_halfedge_handle(a, a_m);

  if (face[0].is_valid()) {  // (a, b, c): the face keeps (m, b, c)
    const HalfedgeHandle b_c = mesh.next_halfedge_handle(half[0]), c_a = mesh.next_halfedge_handle(b_c);
    const HalfedgeHandle m_c = mesh.halfedge_handle(EdgeHandle(next_edge++), 0),
                         c_m = mesh.opposite_halfedge_handle(m_c);
    const FaceHandle piece(next_face++);
    initialise_edge(view, mesh.edge_handle(m_c));
    set_ends(mesh, m_c, m, mesh.to_vertex_handle(b_c));
    const std::array corners{WeightedIndex{index_of(c_a), 1 - share}, WeightedIndex{index_of(half[0]), share}};
    blend_corner(view, corners, c_m);
    copy_corner_values(mesh, c_m, a_m);
    copy_corner_values(mesh, b_c, m_c);
    set_triangle(mesh, face[0], half[0], b_c, c_m);
    set_triangle(mesh, piece, a_m, m_c, c_a);
    copy_face(view, face[0], piece);
  } else {
    mesh.set_next_halfedge_handle(mesh.prev_halfedge_handle(half[0]), a_m);
    mesh.set_next_halfedge_handle(a_m, half[0]);
  }
  if (face[1].is_valid()) {  // (b, a, d): the face keeps (b, m, d)
    const HalfedgeHandle a_d = mesh.next_halfedge_handle(half[1]), d_b = mesh.next_halfedge_handle(a_d);
    const HalfedgeHandle m_d = mesh.halfedge_handle(EdgeHandle(next_edge++), 0),
                         d_m = mesh.opposite_halfedge_handle(m_d);
    const FaceHandle piece(next_face++);
    initialise_edge(view, mesh.edge_handle(m_d));
    set_ends(mesh, m_d, m, mesh.to_vertex_handle(a_d));
    // The new half already has the values at a; the old one, which ends at m now, changes last.
    const std::array corners{WeightedIndex{index_of(half[1]), 1 - share}, WeightedIndex{index_of(d_b), share}};
    blend_corner(view, corners, d_m);
    copy_corner_values(mesh, d_m, half[1]);
    copy_corner_values(mesh, a_d, m_d);
    set_triangle(mesh, face[1], half[1], m_d, d_b);
    set_triangle(mesh, piece, m_a, a_d, d_m);
    copy_face(view, face[1], piece);
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
  if (view.recorder) announce_side(view, side[0]);

  const int first_edge = static_cast<int>(mesh.n_edges()), first_face = static_cast<int>(mesh.n_faces());
  std::array<VertexSource, 3> sources;
  std::array<WeightedIndex, 3> corners;
  for (int k = 0; k < 3; ++k) {
    sources[k] = {corner[k], weights[k]};
    corners[k] = {index_of(side[k]), weights[k]};
  }
  const VertexHandle m = new_vertex(view, point, sources, 3, 2);
  std::array<HalfedgeHandle, 3> in, out;
  for (int k = 0; k < 3; ++k) {
    in[k] = mesh.halfedge_handle(EdgeHandle(first_edge + k), 0);
    out[k] = mesh.opposite_halfedge_handle(in[k]);
    initialise_edge(view, mesh.edge_handle(in[k]));
    set_ends(mesh, in[k], corner[k], m);
    blend_corner(view, corners, in[k]);
    copy_corner_values(mesh, side[k], out[k]);
  }
  const std::array<FaceHandle, 3> piece{face, FaceHandle(first_face), FaceHandle(first_face + 1)};
  for (int k = 0; k < 3; ++k) set_triangle(mesh, piece[k], side[k], in[k], out[(k + 2) % 3]);
  for (int k = 1; k < 3; ++k) copy_face(view, face, piece[k]);
  mesh.set_halfedge_handle(m, out[0]);
  return m;
}

bool is_collapse_ok(const OpenMesh::TriConnectivity& mesh, HalfedgeHandle h) {
  const HalfedgeHandle o = mesh.opposite_halfedge_handle(h);
  const VertexHandle from = mesh.from_vertex_handle(h), to = mesh.to_vertex_handle(h);
  if (mesh.status(mesh.edge_handle(h)).deleted()) return false;
  std::array<VertexHandle, 2> apex;
  for (const int k : {0, 1}) {
    const HalfedgeHandle half = k == 0 ? h : o;
    if (mesh.is_boundary(half)) continue;
    const HalfedgeHandle next = mesh.next_halfedge_handle(half), last = mesh.next_halfedge_handle(next);
    apex[k] = mesh.to_vertex_handle(next);
    // A triangle that hangs on this edge alone would leave an edge without a face.
    if (mesh.is_boundary(mesh.opposite_halfedge_handle(next)) && mesh.is_boundary(mesh.opposite_halfedge_handle(last)))
      return false;
  }
  if (apex[0] == apex[1]) return false;
  if (apex[0].is_valid() && apex[1].is_valid() && mesh.is_boundary(from) && mesh.is_boundary(to)) return false;
  // The two may share no neighbours but those of their triangles.
  for (auto a = mesh.cvv_iter(from); a.is_valid(); ++a) {
    if (*a == apex[0] || *a == apex[1]) continue;
    for (auto b = mesh.cvv_iter(to); b.is_valid(); ++b)
      if (*a == *b) return false;
  }
  return true;
}

void collapse(MeshView view, HalfedgeHandle h) {
  Connectivity& mesh = view.mesh;
  const HalfedgeHandle o = mesh.opposite_halfedge_handle(h);
  if (view.recorder) announce_collapse(view, h);
  // Of the triangles (from, to, x) and (to, from, y) the edges at `to` stay, and take the place of those at `from`.
  move_corners(view, h);
  const auto merge = [&](HalfedgeHandle goes, HalfedgeHandle stays) {
    copy_corner_values(mesh, goes, stays);
    const EdgeHandle from = mesh.edge_handle(goes), to = mesh.edge_handle(stays);
    if (mesh.status(from).feature()) mesh.status(to).set_feature(true);
  };
  if (!mesh.is_boundary(h))
    merge(mesh.opposite_halfedge_handle(mesh.prev_halfedge_handle(h)), mesh.next_halfedge_handle(h));
  if (!mesh.is_boundary(o))
    merge(mesh.opposite_halfedge_handle(mesh.next_halfedge_handle(o)), mesh.prev_halfedge_handle(o));
  mesh.collapse(h);
}

void delete_face(MeshView view, FaceHandle face) {
  Connectivity& mesh = view.mesh;
  if (ChangeRecorder* r = view.recorder) {
    r->status(face);
    for (auto it = mesh.cfh_iter(face); it.is_valid(); ++it) {
      const HalfedgeHandle o = mesh.opposite_halfedge_handle(*it);
      r->links(mesh.edge_handle(*it));
      r->links(mesh.to_vertex_handle(*it));
      if (!mesh.is_boundary(o)) continue;
      r->status(mesh.edge_handle(*it));
      r->links(mesh.edge_handle(mesh.next_halfedge_handle(o)));
      r->links(mesh.edge_handle(mesh.prev_halfedge_handle(o)));
    }
  }
  mesh.delete_face(face, false);
}

void delete_vertex(MeshView view, VertexHandle v) {
  Connectivity& mesh = view.mesh;
  std::vector<FaceHandle> faces;
  if (!mesh.is_isolated(v))
    for (auto it = mesh.cvf_iter(v); it.is_valid(); ++it) faces.push_back(*it);
  for (const FaceHandle f : faces) delete_face(view, f);
  if (view.recorder) view.recorder->status(v);
  mesh.status(v).set_deleted(true);
}

VertexHandle add_vertex(MeshView view, const Vec3& point, std::span<const VertexSource> sources) {
  return new_vertex(view, point, sources, 0, 0);
}

void blend_vertex(MeshView view, VertexHandle v, std::span<const VertexSource> sources) {
  if (sources.empty()) return;
  if (view.recorder) view.recorder->values(ElementKind::vertex, v.idx());
  inherit_vertex(view, v, sources);
}

void about_to_set(MeshView view, VertexHandle v) {
  if (!view.recorder) return;
  view.recorder->status(v);
  view.recorder->values(ElementKind::vertex, v.idx());
}

void about_to_set(MeshView view, EdgeHandle e) {
  if (!view.recorder) return;
  view.recorder->status(e);
  view.recorder->values(ElementKind::edge, e.idx());
}

void about_to_set(MeshView view, HalfedgeHandle h) {
  if (!view.recorder) return;
  view.recorder->status(view.mesh.edge_handle(h));
  view.recorder->values(ElementKind::halfedge, h.idx());
}

void about_to_set(MeshView view, FaceHandle f) {
  if (!view.recorder) return;
  view.recorder->status(f);
  view.recorder->values(ElementKind::face, f.idx());
}

void blend_corners(MeshView view, HalfedgeHandle h, double share) {
  Connectivity& mesh = view.mesh;
  const HalfedgeHandle o = mesh.opposite_halfedge_handle(h);
  if (view.recorder)
    for (auto it = mesh.cvih_iter(mesh.to_vertex_handle(h)); it.is_valid(); ++it) view.recorder->corner(*it);
  std::vector<HalfedgeHandle> left, right;  // corners at the end of `h`, in the order in which the triangles follow
  for_each_corner_property(mesh, [&](OpenMesh::BaseProperty& property) {
    const PropertyType* type = view.policy->types().find(property);
    if (!type) return;
    const auto joined = [&](HalfedgeHandle a, HalfedgeHandle b) {
      return !mesh.is_boundary(b) && type->equal(property, index_of(a), index_of(b));
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
      const std::array sources{WeightedIndex{index_of(at_start), 1 - share},
                               WeightedIndex{index_of(corners.front()), share}};
      view.policy->inherit(property, sources, index_of(corners.front()));
      for (const HalfedgeHandle c : corners)
        if (c != corners.front()) property.copy(index_of(corners.front()), index_of(c));
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
  std::vector<Link> links;  // of the half-edges of the faces, and of those outside along their boundaries
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
    if (mesh.halfedge_handle(l.from) == l.halfedge) outgoing.push_back({l.from, mesh.prev_halfedge_handle(l.halfedge)});
  if (ChangeRecorder* r = view.recorder) {
    for (const FaceHandle f : faces) r->links(f);
    for (const Link& l : links) {
      r->links(mesh.edge_handle(l.halfedge));
      r->corner(l.halfedge);
    }
    for (const auto& [v, h] : outgoing) r->links(v);
  }
  // The corner where a half-edge ended is where the one after it ends now.
  for (const FaceHandle f : faces) {
    const HalfedgeHandle a = mesh.halfedge_handle(f), b = mesh.next_halfedge_handle(a),
                         c = mesh.next_halfedge_handle(b);
    for_each_corner_property(mesh, [&](OpenMesh::BaseProperty& property) {
      property.swap(index_of(c), index_of(b));
      property.swap(index_of(b), index_of(a));
    });
  }
  for (const Link& l : links) {
    mesh.set_vertex_handle(l.halfedge, l.from);
    mesh.set_next_halfedge_handle(l.next, l.halfedge);
  }
  for (const auto& [v, h] : outgoing) mesh.set_halfedge_handle(v, h);
}

}  // namespace tri
