#include "meshops/shape/features.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "meshops/for_each_block.hpp"
#include "meshops/search/disjoint_sets.hpp"

namespace tri {
namespace {

constexpr std::size_t features_block = 4096;
constexpr double sliver_height = 1e-6;  ///< of the diagonal
constexpr int noise_depth = 2;
constexpr int slivers_crossed = 32;  ///< more in a row have no normal

using Connectivity = OpenMesh::TriConnectivity;

template <class Handle>
Handle handle(std::size_t i) {
  return Handle(static_cast<int>(i));
}

/// Diagonal of the box around all finite points of faces.
double mesh_diagonal(MeshView view, const Context& context) {
  const Connectivity& mesh = view.mesh;
  const std::size_t count = mesh.n_vertices();
  const double inf = std::numeric_limits<double>::infinity();
  struct Box {
    Vec3 low, high;
  };
  std::vector<Box> boxes((count + features_block - 1) / features_block, {Vec3(inf, inf, inf), Vec3(-inf, -inf, -inf)});
  for_each_block(context, "", count, features_block, [&](std::size_t block, std::size_t begin, std::size_t end) {
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

/// Mean normals of what lies on one side of an edge.
class SideNormals {
 public:
  SideNormals(MeshView view, const std::vector<Vec3>& normals, const Context& context)
      : mesh_(view.mesh), normals_(normals), areas_(normals.size(), 0) {
    for_each_block(context, "", areas_.size(), features_block, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const auto f = handle<FaceHandle>(i);
        if (mesh_.status(f).deleted()) continue;
        const HalfedgeHandle h = mesh_.halfedge_handle(f), next = mesh_.next_halfedge_handle(h);
        const Vec3 &a = view.point(mesh_.from_vertex_handle(h)), &b = view.point(mesh_.to_vertex_handle(h)),
                   &c = view.point(mesh_.to_vertex_handle(next));
        const double area = ((b - a) % (c - a)).norm();
        if (std::isfinite(area)) areas_[i] = area;
      }
    });
  }

  /// Of the triangles within `depth` steps of that of `h`, but not across `h`; not normalised.
  Vec3 mean(HalfedgeHandle h, int depth) const { return sum(h, depth, areas_[index(mesh_.face_handle(h))]); }

 private:
  static std::size_t index(FaceHandle f) { return static_cast<std::size_t>(f.idx()); }

  Vec3 sum(HalfedgeHandle h, int depth, double most) const {
    const std::size_t f = index(mesh_.face_handle(h));
    Vec3 result = normals_[f] * std::min(areas_[f], most);
    if (depth == 0) return result;
    for (const HalfedgeHandle side : {mesh_.next_halfedge_handle(h), mesh_.prev_halfedge_handle(h)}) {
      const HalfedgeHandle beyond = mesh_.opposite_halfedge_handle(side);
      if (!mesh_.is_boundary(beyond)) result += sum(beyond, depth - 1, most);
    }
    return result;
  }

  const Connectivity& mesh_;
  const std::vector<Vec3>& normals_;
  std::vector<double> areas_;
};

/// Of two zero vectors it is 0, so a triangle without a normal makes no crease.
double angle_between(const Vec3& m, const Vec3& n) {
  return std::atan2((m % n).norm(), m | n);
}

/// Creases that are none between the mean normals of their sides become smooth, as `rules.noise` says.
void drop_noise(MeshView view, const std::vector<Vec3>& normals, const FeatureRules& rules, const Context& context,
                std::vector<EdgeClass>& edges) {
  const SideNormals sides(view, normals, context);
  std::vector<std::size_t> noise((edges.size() + features_block - 1) / features_block, 0);
  std::vector<char> weak(edges.size(), 0);
  for_each_block(context, "", edges.size(), features_block, [&](std::size_t block, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (edges[i] != EdgeClass::crease) continue;
      const auto e = handle<EdgeHandle>(i);
      const Vec3 left = sides.mean(view.mesh.halfedge_handle(e, 0), noise_depth);
      const Vec3 right = sides.mean(view.mesh.halfedge_handle(e, 1), noise_depth);
      weak[i] = !(angle_between(left, right) > rules.angle);
      noise[block] += weak[i];
    }
  });
  const std::size_t found = std::accumulate(noise.begin(), noise.end(), std::size_t{0});
  const auto creases = static_cast<std::size_t>(std::ranges::count(edges, EdgeClass::crease));
  if (rules.noise == Noise::unknown && 2 * found <= creases) return;
  for (std::size_t i = 0; i < edges.size(); ++i)
    if (weak[i]) edges[i] = EdgeClass::smooth;
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
    if (e % features_block == 0) context.checkpoint();
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
  const double least_height = sliver_height * mesh_diagonal(view, context);
  std::vector<Vec3> normals(mesh.n_faces(), Vec3(0, 0, 0));
  for_each_block(context, "", mesh.n_faces(), features_block, [&](std::size_t, std::size_t begin, std::size_t end) {
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
  for_each_block(context, "", mesh.n_edges(), features_block, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto e = handle<EdgeHandle>(i);
      if (mesh.status(e).deleted()) continue;
      if (mesh.is_boundary(e)) {
        features.edges[i] = EdgeClass::boundary;
        continue;
      }
      const HalfedgeHandle left = mesh.halfedge_handle(e, 0), right = mesh.halfedge_handle(e, 1);
      const auto normal = [&](HalfedgeHandle h) {
        return normals[static_cast<std::size_t>(mesh.face_handle(h).idx())];
      };
      if (!any_crease || !(angle_between(normal(left), normal(right)) > rules.angle)) continue;
      features.edges[i] = EdgeClass::crease;
    }
  });
  if (any_crease && rules.noise != Noise::none) drop_noise(view, normals, rules, context, features.edges);
  if (rules.min_crease_edges > 1)
    drop_short_creases(mesh, static_cast<std::size_t>(rules.min_crease_edges), context, features.edges);
  const double corner_cosine = rules.corner_angle < std::numbers::pi ? std::cos(rules.corner_angle) : -2;
  for_each_block(context, "", mesh.n_vertices(), features_block, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      features.vertices[i] = class_of(view, features.edges, handle<VertexHandle>(i), corner_cosine);
  });
  features.creases = static_cast<std::size_t>(std::ranges::count(features.edges, EdgeClass::crease));
  features.corners = static_cast<std::size_t>(std::ranges::count(features.vertices, VertexClass::corner));
  return features;
}

}  // namespace tri
