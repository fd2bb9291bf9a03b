#include "libtri/triangulation/shell/delaunay_flips.hpp"

#include <cmath>
#include <numeric>

#include "libtri/triangulation/shell/triangle_cost.hpp"
#include "libtri/triangulation/shell/triangle_geometry.hpp"
#include "meshops/pace.hpp"

namespace tri {
namespace {

/// Squared edge lengths over twice the area. Beyond the bound rounding would decide, and the same triangle taken from
/// another corner could count as better for ever.
double harmonic_index(const Vec3& a, const Vec3& b, const Vec3& c) {
  constexpr double bound = 1e4;
  const Vec3 ab = b - a, ac = c - a;
  const double squares = ab.sqrnorm() + ac.sqrnorm() + (c - b).sqrnorm(), twice_area = (ab % ac).norm();
  return squares < bound * twice_area ? squares / twice_area : bound;
}

Vec3 model_normal(const EditMesh& mesh, std::uint32_t v) {
  const auto& n = mesh.vertices[v].normal;
  return {n[0], n[1], n[2]};
}

bool lowers_harmonic_index(const EditMesh& mesh, std::int32_t t, int k) {
  const Triangle& q = mesh.triangles[t];
  const std::uint32_t ia = q[k], ib = q[(k + 1) % 3], ic = q[(k + 2) % 3], id = mesh.opposite(t, k);
  if (ia == id) return false;
  const Vec3 &a = mesh.vertices[ia].p, &b = mesh.vertices[ib].p, &c = mesh.vertices[ic].p, &d = mesh.vertices[id].p;
  const double before = harmonic_index(a, b, c) + harmonic_index(d, c, b);
  const double after = harmonic_index(a, b, d) + harmonic_index(a, d, c);
  if (!(after < before * (1 - 1e-8))) return false;
  // Where the model is smooth its normals judge the new triangles (a needle between scan lines has no normal worth
  // comparing with); elsewhere they must face as the old ones did.
  const Vec3 normal = model_normal(mesh, ia) + model_normal(mesh, ib) + model_normal(mesh, ic) + model_normal(mesh, id);
  if (normal.norm() > 3.6) {
    const double least = 0.5 * normal.norm();
    if ((unit_normal(a, b, d) | normal) <= least || (unit_normal(a, d, c) | normal) <= least) {
      const auto turned = [&](const Vec3& p, const Vec3& u, const Vec3& v) {
        return (((u - p) % (v - p)) | normal) <= 0;
      };
      if (turned(a, b, d) + turned(a, d, c) > 0 || turned(a, b, c) + turned(d, c, b) == 0) return false;
    }
  } else {
    const Vec3 old_normal = unit_normal(a, b, c) + unit_normal(d, c, b);
    const double least = 0.5 * old_normal.norm();
    if ((unit_normal(a, b, d) | old_normal) <= least || (unit_normal(a, d, c) | old_normal) <= least) return false;
  }
  return !mesh.has_edge(ia, id);
}

bool lowers_cost(const EditMesh& mesh, std::int32_t t, int k) {
  const Triangle& q = mesh.triangles[t];
  const std::uint32_t a = q[k], b = q[(k + 1) % 3], c = q[(k + 2) % 3], d = mesh.opposite(t, k);
  if (a == d) return false;
  const TriangleCost cost(mesh);
  if (!(cost(a, b, d) + cost(a, d, c) < (cost(a, b, c) + cost(d, c, b)) * (1 - 1e-7))) return false;
  return !mesh.has_edge(a, d);
}

/// Flips every edge that `improves` until none is left; its measure must fall with each flip.
template <class Improves>
std::size_t flip_all(EditMesh& mesh, std::vector<std::int32_t> seeds, const Context& context, Improves improves) {
  if (seeds.empty()) {
    seeds.reserve(mesh.triangles.size());
    for (std::size_t t = mesh.triangles.size(); t-- > 0;)
      if (mesh.alive(static_cast<std::int32_t>(t))) seeds.push_back(static_cast<std::int32_t>(t));
  }
  std::size_t flips = 0;
  for (std::size_t steps = 1; !seeds.empty(); ++steps) {
    if (steps % 8192 == 0) context.checkpoint();
    const std::int32_t t = seeds.back();
    seeds.pop_back();
    if (!mesh.alive(t)) continue;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t n = mesh.neighbors[t][k];
      if (n < 0 || (mesh.creases[t] >> k & 1) || !improves(mesh, t, k)) continue;
      mesh.flip(t, k);
      ++flips;
      seeds.push_back(t);
      seeds.push_back(n);
      break;
    }
  }
  return flips;
}

}  // namespace

std::size_t delaunay_flips(EditMesh& mesh, std::vector<std::int32_t> seeds, const Context& context) {
  return flip_all(mesh, std::move(seeds), context, lowers_harmonic_index);
}

void measure_vertex_areas(EditMesh& mesh) {
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  measure_vertex_areas(mesh, all);
}

void measure_vertex_areas(EditMesh& mesh, std::span<const std::uint32_t> triangles) {
  for (EditMesh::Vertex& v : mesh.vertices) v.area = 0;
  for (const std::uint32_t i : triangles) {
    const Triangle& t = mesh.triangles[i];
    const Vec3& a = mesh.vertices[t[0]].p;
    const double area = 0.5 * ((mesh.vertices[t[1]].p - a) % (mesh.vertices[t[2]].p - a)).norm();
    for (std::uint32_t v : t) mesh.vertices[v].area += static_cast<float>(area / 3);
  }
}

std::size_t cost_flips(EditMesh& mesh, std::vector<std::int32_t> seeds, const Context& context) {
  return flip_all(mesh, std::move(seeds), context, lowers_cost);
}

std::size_t split_encroached_edges(EditMesh& mesh, std::vector<float>& shortest, const Context& context) {
  std::size_t splits = 0;
  std::vector<std::int32_t> queue;
  const auto fixed = [&](std::int32_t t, int k) { return mesh.neighbors[t][k] < 0 || (mesh.creases[t] >> k & 1); };
  for (std::size_t t = mesh.triangles.size(); t-- > 0;) {
    const auto id = static_cast<std::int32_t>(t);
    if (mesh.alive(id) && (fixed(id, 0) || fixed(id, 1) || fixed(id, 2))) queue.push_back(id);
  }
  const auto obtuse = [&](std::int32_t t, int k) {
    const Triangle& q = mesh.triangles[t];
    const Vec3& apex = mesh.vertices[q[k]].p;
    return ((mesh.vertices[q[(k + 1) % 3]].p - apex) | (mesh.vertices[q[(k + 2) % 3]].p - apex)) < 0;
  };
  Pace pace(context, 256);
  while (!queue.empty()) {
    pace();
    const std::int32_t t = queue.back();
    queue.pop_back();
    for (int k = 0; k < 3; ++k) {
      if (!fixed(t, k) || !obtuse(t, k)) continue;
      const std::uint32_t b = mesh.triangles[t][(k + 1) % 3], c = mesh.triangles[t][(k + 2) % 3];
      const Vec3 edge = mesh.vertices[c].p - mesh.vertices[b].p;
      const float limit = std::min(shortest[b], shortest[c]);
      if (edge.norm() < 2 * limit) continue;
      EditMesh::Vertex middle;
      middle.p = mesh.vertices[b].p + edge * 0.5;
      const std::uint32_t m = mesh.split_edge(t, k, middle);
      shortest.push_back(limit);
      ++splits;
      std::vector<std::int32_t> touched;
      EditMesh::Star star;
      mesh.star(m, star, 8);
      touched = star.fan;
      delaunay_flips(mesh, touched, context);
      // Flips move triangles about: look at every triangle around the two halves again.
      for (std::uint32_t v : {m, b, c}) {
        if (mesh.star(v, star, 256)) queue.insert(queue.end(), star.fan.begin(), star.fan.end());
      }
      break;
    }
  }
  return splits;
}

}  // namespace tri
