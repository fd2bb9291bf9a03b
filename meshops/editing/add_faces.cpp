#include "meshops/editing/add_faces.hpp"

#include <algorithm>
#include <limits>

#include "meshops/editing/change_recorder.hpp"
#include "meshops/editing/new_values.hpp"
#include "meshops/pace.hpp"

namespace tri {
namespace {

/// One side of a triangle of the batch.
struct NewSide {
  int low = 0, high = 0;  ///< vertex indices
  bool forward = true;    ///< runs low -> high
  int triangle = 0, corner = 0;

  bool same_edge(const NewSide& o) const { return low == o.low && high == o.high; }
  bool operator<(const NewSide& o) const {
    if (low != o.low) return low < o.low;
    if (high != o.high) return high < o.high;
    return forward && !o.forward;
  }
};

/// A face seen from one of its corners: it lies between the edges to `from` and `to`, counter-clockwise.
struct Wedge {
  int from = 0, to = 0;
};

std::vector<NewSide> sides_of(std::span<const VertexTriple> triangles, Pace& pace) {
  std::vector<NewSide> sides;
  sides.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = triangles[t][k].idx(), b = triangles[t][(k + 1) % 3].idx();
      sides.push_back({std::min(a, b), std::max(a, b), a < b, static_cast<int>(t), k});
    }
  std::sort(sides.begin(), sides.end(), [&](const NewSide& a, const NewSide& b) {
    pace();
    return a < b;
  });
  return sides;
}

/// The number of fans that the wedges of one vertex make; a huge number if one of several is closed, since no
/// circulator could reach the others. Every edge is the start of at most one wedge and the end of at most one.
int count_fans(std::vector<Wedge>& wedges) {
  int fans = 0;
  bool closed = false;
  while (!wedges.empty()) {
    Wedge fan = wedges.back();
    wedges.pop_back();
    for (bool grown = true; grown && fan.from != fan.to;) {
      grown = false;
      for (std::size_t i = 0; i < wedges.size(); ++i) {
        if (wedges[i].from != fan.to && wedges[i].to != fan.from) continue;
        if (wedges[i].from == fan.to)
          fan.to = wedges[i].to;
        else
          fan.from = wedges[i].from;
        wedges[i] = wedges.back();
        wedges.pop_back();
        grown = true;
        break;
      }
    }
    ++fans;
    closed = closed || fan.from == fan.to;
  }
  return closed && fans > 1 ? std::numeric_limits<int>::max() : fans;
}

/// (vertex, wedge) for every corner of the batch, sorted by vertex.
std::vector<std::pair<int, Wedge>> wedges_of(std::span<const VertexTriple> triangles, Pace& pace) {
  std::vector<std::pair<int, Wedge>> corners;
  corners.reserve(3 * triangles.size());
  for (const VertexTriple& t : triangles)
    for (int k = 0; k < 3; ++k) corners.push_back({t[k].idx(), {t[(k + 1) % 3].idx(), t[(k + 2) % 3].idx()}});
  std::stable_sort(corners.begin(), corners.end(), [&](const auto& a, const auto& b) {
    pace();
    return a.first < b.first;
  });
  return corners;
}

/// Links the boundary half-edges around a vertex so that a circulator meets all of its `outgoing` half-edges.
void link_boundary(OpenMesh::TriConnectivity& mesh, VertexHandle v, const std::vector<HalfedgeHandle>& outgoing) {
  // A fan runs counter-clockwise from its incoming boundary half-edge to its outgoing one.
  std::vector<HalfedgeHandle> in, out;
  for (const HalfedgeHandle h : outgoing) {
    const HalfedgeHandle back = mesh.opposite_halfedge_handle(h);
    if (mesh.face_handle(back).is_valid() || !mesh.face_handle(h).is_valid()) continue;
    HalfedgeHandle end = h;  // across the faces of the fan
    while (mesh.face_handle(end).is_valid())
      end = mesh.opposite_halfedge_handle(mesh.next_halfedge_handle(mesh.next_halfedge_handle(end)));
    in.push_back(back);
    out.push_back(end);
  }
  if (in.empty()) {
    mesh.set_halfedge_handle(v, outgoing.front());
    return;
  }
  // Gaps that were there keep where that leaves a single cycle.
  std::vector<char> visited(in.size(), 0);
  std::size_t fan = 0;
  visited[0] = 1;
  for (std::size_t step = 1; step < in.size(); ++step) {
    std::size_t chosen = in.size();
    for (std::size_t j = 0; j < in.size(); ++j) {
      if (visited[j]) continue;
      if (chosen == in.size()) chosen = j;
      if (mesh.next_halfedge_handle(in[fan]) == out[j]) chosen = j;
    }
    mesh.set_next_halfedge_handle(in[fan], out[chosen]);
    fan = chosen;
    visited[fan] = 1;
  }
  mesh.set_next_halfedge_handle(in[fan], out[0]);
  mesh.set_halfedge_handle(v, out[0]);
}

/// Gives every new face the properties of a face beside it: of the mesh, else of a new one that has them already.
/// @param halfedge  of the new faces, three each
void inherit_face_values(MeshView view, const std::vector<HalfedgeHandle>& halfedge, int first_face, Pace& pace) {
  const auto& mesh = view.mesh;
  const std::size_t count = halfedge.size() / 3;
  std::vector<char> has(count, 0);
  std::vector<int> ready;  // new faces that have theirs
  const auto inherit = [&](FaceHandle from, int to) {
    inherit_values(view, ElementKind::face, from, FaceHandle(first_face + to));
    has[static_cast<std::size_t>(to)] = 1;
    ready.push_back(to);
  };
  const auto beside = [&](int t, int k) {
    return mesh.face_handle(mesh.opposite_halfedge_handle(halfedge[static_cast<std::size_t>(3 * t + k)]));
  };
  for (int t = 0; t < static_cast<int>(count); ++t) {
    pace();
    FaceHandle source;
    for (int k = 0; k < 3; ++k) {
      const FaceHandle f = beside(t, k);
      if (f.is_valid() && f.idx() < first_face && (!source.is_valid() || f.idx() < source.idx())) source = f;
    }
    if (source.is_valid()) inherit(source, t);
  }
  for (std::size_t i = 0; i < ready.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      pace();
      const FaceHandle f = beside(ready[i], k);
      if (f.is_valid() && f.idx() >= first_face && !has[static_cast<std::size_t>(f.idx() - first_face)])
        inherit(FaceHandle(first_face + ready[i]), f.idx() - first_face);
    }
  for (int t = 0; t < static_cast<int>(count); ++t)
    if (!has[static_cast<std::size_t>(t)]) inherit(FaceHandle(), t);
}

/// Gives the corners of new faces the values of the nearest corner of the mesh at the same vertex, counted in faces
/// around it; of two as near that beyond the next side.
void inherit_corner_values(OpenMesh::TriConnectivity& mesh, const std::vector<HalfedgeHandle>& halfedge, int first_face,
                           Pace& pace) {
  bool any = false;
  for_each_corner_property(mesh, [&](OpenMesh::BaseProperty&) { any = true; });
  if (!any) return;
  std::vector<int> vertices;
  for (const HalfedgeHandle h : halfedge) vertices.push_back(mesh.to_vertex_handle(h).idx());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<HalfedgeHandle> ring;  // the sides that end in a vertex, in their order around it
  std::vector<int> steps;            // from the corner of the mesh whose values it gets; none: far
  constexpr int far = std::numeric_limits<int>::max();
  for (const int v : vertices) {
    pace();
    ring.clear();
    for (const HalfedgeHandle h : mesh.vih_range(VertexHandle(v))) ring.push_back(h);
    const auto n = static_cast<int>(ring.size());
    const auto side = [&](int i) { return ring[static_cast<std::size_t>((i % n + n) % n)]; };
    std::vector<HalfedgeHandle> source(ring.size());
    steps.assign(ring.size(), far);
    // Around twice in each direction: a way may lead across where the ring begins, but never across a boundary.
    for (const int direction : {-1, 1}) {
      HalfedgeHandle last;
      int distance = 0;
      for (int i = 0; i < 2 * n; ++i) {
        const HalfedgeHandle h = side(direction * i);
        const auto at = static_cast<std::size_t>((direction * i % n + n) % n);
        const FaceHandle f = mesh.face_handle(h);
        if (!f.is_valid()) {
          last.invalidate();
        } else if (f.idx() < first_face) {
          last = h;
          distance = 0;
        } else if (last.is_valid() && ++distance < steps[at]) {
          steps[at] = distance;
          source[at] = last;
        }
      }
    }
    for (std::size_t i = 0; i < ring.size(); ++i)
      if (source[i].is_valid()) copy_corner_values(mesh, source[i], ring[i]);
  }
}

}  // namespace

std::string_view to_string(FitResult result) {
  switch (result) {
    case FitResult::fits:
      return "fits";
    case FitResult::degenerate:
      return "degenerate triangle";
    case FitResult::edge_in_use:
      return "edge in use";
    case FitResult::vertex_not_manifold:
      return "vertex not manifold";
  }
  return "";
}

FitResult check_faces(MeshView view, std::span<const VertexTriple> triangles, const Context* context) {
  Pace pace(context);
  const auto& mesh = view.mesh;
  for (const VertexTriple& t : triangles) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return FitResult::degenerate;
    for (const VertexHandle v : t)
      if (!mesh.is_valid_handle(v) || mesh.status(v).deleted()) return FitResult::degenerate;
  }
  const std::vector<NewSide> sides = sides_of(triangles, pace);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    pace();
    const NewSide& s = sides[i];
    if (i > 0 && sides[i - 1].same_edge(s) && sides[i - 1].forward == s.forward) return FitResult::edge_in_use;
    const HalfedgeHandle h =
        mesh.find_halfedge(VertexHandle(s.forward ? s.low : s.high), VertexHandle(s.forward ? s.high : s.low));
    if (h.is_valid() && mesh.face_handle(h).is_valid()) return FitResult::edge_in_use;
  }
  const auto corners = wedges_of(triangles, pace);
  std::vector<Wedge> wedges, before;
  for (std::size_t i = 0; i < corners.size();) {
    pace();
    const VertexHandle v(corners[i].first);
    wedges.clear();
    if (!mesh.is_isolated(v))
      for (auto it = mesh.cvoh_iter(v); it.is_valid(); ++it)
        if (mesh.face_handle(*it).is_valid())
          wedges.push_back(
              {mesh.to_vertex_handle(*it).idx(), mesh.to_vertex_handle(mesh.next_halfedge_handle(*it)).idx()});
    before = wedges;
    for (; i < corners.size() && corners[i].first == v.idx(); ++i) wedges.push_back(corners[i].second);
    const int fans = count_fans(wedges);
    if (fans > 1 && fans > count_fans(before)) return FitResult::vertex_not_manifold;
  }
  return FitResult::fits;
}

FitResult add_faces(MeshView view, std::span<const VertexTriple> triangles, std::vector<FaceHandle>* added,
                    const Context* context) {
  Pace pace(context);
  const FitResult result = check_faces(view, triangles, context);
  if (result != FitResult::fits || triangles.empty()) return result;
  auto& mesh = view.mesh;

  const std::vector<NewSide> sides = sides_of(triangles, pace);
  std::vector<HalfedgeHandle> halfedge(sides.size());  // by 3 * triangle + corner
  std::size_t new_edges = 0;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    pace();
    if (i > 0 && sides[i - 1].same_edge(sides[i])) continue;
    if (!mesh.find_halfedge(VertexHandle(sides[i].low), VertexHandle(sides[i].high)).is_valid()) ++new_edges;
  }

  // The half-edges that each touched vertex has now, before anything is linked anew.
  std::vector<std::pair<int, HalfedgeHandle>> outgoing;
  for (const auto& [v, wedge] : wedges_of(triangles, pace)) {
    pace();
    const VertexHandle vertex(v);
    if (!outgoing.empty() && outgoing.back().first == v) continue;
    const std::size_t first = outgoing.size();
    if (!mesh.is_isolated(vertex))
      for (auto it = mesh.cvoh_iter(vertex); it.is_valid(); ++it) outgoing.push_back({v, *it});
    if (outgoing.size() == first) outgoing.push_back({v, HalfedgeHandle()});
  }

  if (ChangeRecorder* r = view.recorder)
    for (const auto& [v, h] : outgoing) {
      pace();
      r->links(VertexHandle(v));
      if (!h.is_valid() || !mesh.is_boundary(mesh.edge_handle(h))) continue;
      r->links(mesh.edge_handle(h));
      r->corner(h);
      r->corner(mesh.opposite_halfedge_handle(h));
    }

  // All at once: growing one element at a time resizes every property every time.
  int edge = static_cast<int>(mesh.n_edges());
  const int first_face = static_cast<int>(mesh.n_faces());
  mesh.resize(mesh.n_vertices(), mesh.n_edges() + new_edges, mesh.n_faces() + triangles.size());

  for (std::size_t i = 0; i < sides.size(); ++i) {
    pace();
    const NewSide& s = sides[i];
    HalfedgeHandle forward;
    if (i > 0 && sides[i - 1].same_edge(s)) {
      forward = halfedge[3 * sides[i - 1].triangle + sides[i - 1].corner];
      if (!sides[i - 1].forward) forward = mesh.opposite_halfedge_handle(forward);
    } else {
      const VertexHandle low(s.low), high(s.high);
      forward = mesh.find_halfedge(low, high);
      if (!forward.is_valid()) {
        forward = mesh.halfedge_handle(EdgeHandle(edge), 0);
        initialise_edge(view, EdgeHandle(edge++));
        mesh.set_vertex_handle(forward, high);
        mesh.set_vertex_handle(mesh.opposite_halfedge_handle(forward), low);
        outgoing.push_back({s.low, forward});
        outgoing.push_back({s.high, mesh.opposite_halfedge_handle(forward)});
      }
    }
    halfedge[3 * s.triangle + s.corner] = s.forward ? forward : mesh.opposite_halfedge_handle(forward);
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    pace();
    const FaceHandle f(first_face + static_cast<int>(t));
    mesh.set_halfedge_handle(f, halfedge[3 * t]);
    for (int k = 0; k < 3; ++k) {
      const HalfedgeHandle h = halfedge[3 * t + k];
      mesh.set_face_handle(h, f);
      mesh.set_next_halfedge_handle(h, halfedge[3 * t + (k + 1) % 3]);
    }
    if (added) added->push_back(f);
  }

  std::stable_sort(outgoing.begin(), outgoing.end(), [&](const auto& a, const auto& b) {
    pace();
    return a.first < b.first;
  });
  std::vector<HalfedgeHandle> around;
  for (std::size_t i = 0; i < outgoing.size();) {
    pace();
    const int v = outgoing[i].first;
    around.clear();
    for (; i < outgoing.size() && outgoing[i].first == v; ++i)
      if (outgoing[i].second.is_valid()) around.push_back(outgoing[i].second);
    link_boundary(mesh, VertexHandle(v), around);
  }
  inherit_face_values(view, halfedge, first_face, pace);
  inherit_corner_values(mesh, halfedge, first_face, pace);
  return FitResult::fits;
}

}  // namespace tri
