#include "meshops/features.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "meshops/disjoint_sets.hpp"
#include "meshops/for_each_block.hpp"

namespace tri {
namespace {

constexpr std::size_t block_size = 4096;
constexpr double sliver_height = 1e-6;  ///< of the diagonal
constexpr int slivers_crossed = 32;     ///< more in a row have no normal

using Connectivity = OpenMesh::TriConnectivity;

template <class Handle>
Handle handle(std::size_t i) {
  return Handle(static_cast<int>(i));
}

/// Diagonal of the box around all finite points of faces.
double diagonal(MeshView view, const Context& context) {
  const Connectivity& mesh = view.mesh;
  const std::size_t count = mesh.n_vertices();
  const double inf = std::numeric_limits<double>::infinity();
  struct Box {
    Vec3 low, high;
  };
  std::vector<Box> boxes((count + block_size - 1) / block_size, {Vec3(inf, inf, inf), Vec3(-inf, -inf, -inf)});
  for_each_block(context, "", count, block_size, [&](std::size_t block, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto v = handle<VertexHandle>(i);
      const Vec3& p = view.point(v);
      if (mesh.status(v).deleted() || mesh.is_isolated(v) || !std::isfinite(p[0] + p[1] + p[2])) continue;
      boxes[block].low.minimize(p);
      boxes[block].high.maximize(p);
    }
  });
  Box all{Vec3(inf, inf, inf), Vec3(-inf, -inf, -inf)};
  for (const Box& box : boxes) {
    all.low.minimize(box.low);
    all.high.maximize(box.high);
  }
  return all.low[0] <= all.high[0] ? (all.high - all.low).norm() : 0;
}

/// A triangle's own normal, or across which half-edge to look for another.
struct OwnNormal {
  Vec3 unit{0, 0, 0};
  HalfedgeHandle longest = HalfedgeHandle();  ///< of a sliver
};

OwnNormal own_normal(MeshView view, FaceHandle f, double least_height) {
  const Connectivity& mesh = view.mesh;
  std::array<HalfedgeHandle, 3> h;
  std::array<Vec3, 3> p;  // p[k] is where h[k] starts
  h[0] = mesh.halfedge_handle(f);
  h[1] = mesh.next_halfedge_handle(h[0]);
  h[2] = mesh.next_halfedge_handle(h[1]);
  for (int k = 0; k < 3; ++k) p[k] = view.point(mesh.to_vertex_handle(h[(k + 2) % 3]));
  const Vec3 normal = (p[1] - p[0]) % (p[2] - p[0]);
  const double twice_area = normal.norm();
  int longest = 0;
  double length = -1;
  for (int k = 0; k < 3; ++k) {
    const double l = (p[(k + 1) % 3] - p[k]).norm();
    if (l > length) {
      length = l;
      longest = k;
    }
  }
  if (!std::isfinite(twice_area)) return OwnNormal();
  if (twice_area > least_height * length) return {normal / twice_area, HalfedgeHandle()};
  return {{0, 0, 0}, h[longest]};
}

VertexClass class_of(MeshView view, const std::vector<EdgeClass>& edges, VertexHandle v, double corner_cosine) {
  const Connectivity& mesh = view.mesh;
  if (mesh.status(v).deleted() || mesh.is_isolated(v)) return VertexClass::smooth;
  int found = 0, creases = 0;
  std::array<Vec3, 2> along;
  for (HalfedgeHandle h = mesh.halfedge_handle(v), first = h;;) {
    const EdgeClass c = edges[static_cast<std::size_t>(mesh.edge_handle(h).idx())];
    if (c != EdgeClass::smooth) {
      if (found < 2) along[found] = view.point(mesh.to_vertex_handle(h)) - view.point(v);
      ++found;
      creases += c == EdgeClass::crease;
    }
    h = mesh.next_halfedge_handle(mesh.opposite_halfedge_handle(h));
    if (h == first) break;
  }
  if (found == 0) return VertexClass::smooth;
  if (found == 1) return VertexClass::dart;
  if (found > 2 || creases == 1) return VertexClass::corner;
  const double lengths = along[0].norm() * along[1].norm();
  if (-(along[0] | along[1]) < corner_cosine * lengths) return VertexClass::corner;
  return creases == 2 ? VertexClass::crease : VertexClass::boundary;
}

/// Creases of fewer than `least` connected edges become smooth.
void drop_short_creases(const Connectivity& mesh, std::size_t least, const Context& context,
                        std::vector<EdgeClass>& edges) {
  DisjointSets sets(mesh.n_vertices());
  const auto ends = [&](std::size_t e) {
    const HalfedgeHandle h = mesh.halfedge_handle(handle<EdgeHandle>(e), 0);
    return std::array{static_cast<std::uint32_t>(mesh.from_vertex_handle(h).idx()),
                      static_cast<std::uint32_t>(mesh.to_vertex_handle(h).idx())};
  };
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (e % block_size == 0) context.checkpoint();
    if (edges[e] == EdgeClass::crease) sets.join(ends(e)[0], ends(e)[1]);
  }
  std::vector<std::size_t> size(mesh.n_vertices(), 0);
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (edges[e] == EdgeClass::crease) ++size[sets.find(ends(e)[0])];
  context.checkpoint();
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (edges[e] == EdgeClass::crease && size[sets.find(ends(e)[0])] < least) edges[e] = EdgeClass::smooth;
}

}  // namespace

std::vector<Vec3> robust_face_normals(MeshView view, const Context& context) {
  const Connectivity& mesh = view.mesh;
  const double least_height = sliver_height * diagonal(view, context);
  std::vector<Vec3> normals(mesh.n_faces(), Vec3(0, 0, 0));
  for_each_block(context, "", mesh.n_faces(), block_size, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      FaceHandle f = handle<FaceHandle>(i);
      if (mesh.status(f).deleted()) continue;
      for (int step = 0; step <= slivers_crossed && f.is_valid(); ++step) {
        const OwnNormal own = own_normal(view, f, least_height);
        normals[i] = own.unit;
        if (!own.longest.is_valid()) break;
        f = mesh.face_handle(mesh.opposite_halfedge_handle(own.longest));
      }
    }
  });
  return normals;
}

Features find_features(MeshView view, const FeatureRules& rules, const Context& context) {
  const Connectivity& mesh = view.mesh;
  const std::vector<Vec3> normals = robust_face_normals(view, context);
  Features features;
  features.edges.assign(mesh.n_edges(), EdgeClass::smooth);
  features.vertices.assign(mesh.n_vertices(), VertexClass::smooth);
  const bool any_crease = rules.angle < std::numbers::pi;
  for_each_block(context, "", mesh.n_edges(), block_size, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto e = handle<EdgeHandle>(i);
      if (mesh.status(e).deleted()) continue;
      if (mesh.is_boundary(e)) {
        features.edges[i] = EdgeClass::boundary;
        continue;
      }
      const Vec3& m = normals[static_cast<std::size_t>(mesh.face_handle(mesh.halfedge_handle(e, 0)).idx())];
      const Vec3& n = normals[static_cast<std::size_t>(mesh.face_handle(mesh.halfedge_handle(e, 1)).idx())];
      // Of two zero vectors atan2 gives 0, so a triangle without a normal makes no crease.
      if (any_crease && std::atan2((m % n).norm(), m | n) > rules.angle) features.edges[i] = EdgeClass::crease;
    }
  });
  if (rules.min_crease_edges > 1)
    drop_short_creases(mesh, static_cast<std::size_t>(rules.min_crease_edges), context, features.edges);
  const double corner_cosine = rules.corner_angle < std::numbers::pi ? std::cos(rules.corner_angle) : -2;
  for_each_block(context, "", mesh.n_vertices(), block_size, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      features.vertices[i] = class_of(view, features.edges, handle<VertexHandle>(i), corner_cosine);
  });
  features.creases = static_cast<std::size_t>(std::ranges::count(features.edges, EdgeClass::crease));
  features.corners = static_cast<std::size_t>(std::ranges::count(features.vertices, VertexClass::corner));
  return features;
}

}  // namespace tri
