#include "libtri/triangulation/patches/glue.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <span>
#include <utility>

#include "meshops/select_indices.hpp"

namespace tri {
namespace {

struct SideUse {
  std::int32_t triangle = -1;
  int corner = 0;
};

// Opens the sides of degenerate triangles onto each other and takes the triangles out.
void drop_degenerate(EditMesh& mesh) {
  const std::vector<std::uint32_t> degenerate = select_indices(mesh.triangles.size(), [&](std::uint32_t t) {
    const Triangle& q = mesh.triangles[t];
    return q[0] == q[1] || q[1] == q[2] || q[2] == q[0];
  });
  if (degenerate.empty()) return;
  for (const std::uint32_t i : degenerate) {
    const auto t = static_cast<std::int32_t>(i);
    const Triangle q = mesh.triangles[i];
    int same = -1;  // corner opposite the edge without length
    for (int k = 0; k < 3; ++k)
      if (q[(k + 1) % 3] == q[(k + 2) % 3]) same = k;
    const std::int32_t a = mesh.neighbors[i][(same + 1) % 3], b = mesh.neighbors[i][(same + 2) % 3];
    const auto redirect = [&](std::int32_t who, std::int32_t to) {
      if (who < 0) return;
      for (auto& n : mesh.neighbors[static_cast<std::size_t>(who)])
        if (n == t) {
          n = to;
          return;
        }
    };
    redirect(a, b);
    redirect(b, a);
    mesh.triangles[i] = {0, 0, 0};
    mesh.neighbors[i] = {-1, -1, -1};
  }
  std::vector<std::int32_t> number(mesh.triangles.size(), -1);
  std::int32_t count = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (mesh.alive(static_cast<std::int32_t>(i))) number[i] = count++;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (number[i] < 0) continue;
    const auto to = static_cast<std::size_t>(number[i]);
    mesh.triangles[to] = mesh.triangles[i];
    mesh.creases[to] = mesh.creases[i];
    for (int k = 0; k < 3; ++k) {
      const std::int32_t n = mesh.neighbors[i][k];
      mesh.neighbors[to][k] = n < 0 ? -1 : number[static_cast<std::size_t>(n)];
    }
  }
  mesh.triangles.resize(static_cast<std::size_t>(count));
  mesh.neighbors.resize(static_cast<std::size_t>(count));
  mesh.creases.resize(static_cast<std::size_t>(count));
}

// @param chained  the triangles with a vertex on a chain, ascending; others have no such vertex
void split_fans(EditMesh& mesh, const std::vector<std::uint8_t>& on_chain, std::span<const std::uint32_t> chained) {
  std::vector<std::uint8_t> seen(mesh.triangles.size(), 0);  // bit k: corner k
  std::vector<std::uint8_t> taken(mesh.vertices.size(), 0);
  for (const std::uint32_t i : chained)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[i][k];
      if (v >= on_chain.size() || !on_chain[v] || (seen[i] >> k & 1)) continue;
      std::vector<SideUse> fan;
      bool closed = false;
      const auto walk = [&](int turn) {  // 1 counter-clockwise, 2 clockwise
        auto t = static_cast<std::int32_t>(i);
        int c = k;
        for (;;) {
          const std::int32_t n = mesh.neighbors[static_cast<std::size_t>(t)][(c + turn) % 3];
          if (n < 0) return;
          if (n == static_cast<std::int32_t>(i)) {
            closed = true;
            return;
          }
          t = n;
          c = mesh.corner(t, v);
          fan.push_back({t, c});
        }
      };
      fan.push_back({static_cast<std::int32_t>(i), k});
      walk(1);
      if (!closed) walk(2);
      std::uint32_t use = v;
      if (taken[v]) {
        use = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(mesh.vertices[v]);
        mesh.vertices.back().point = -1;
      }
      taken[v] = 1;
      for (const SideUse& u : fan) {
        seen[static_cast<std::size_t>(u.triangle)] |= static_cast<std::uint8_t>(1 << u.corner);
        mesh.triangles[static_cast<std::size_t>(u.triangle)][u.corner] = use;
      }
    }
}

// Corner of triangle t opposite its directed edge (a, b).
int corner_opposite(const EditMesh& mesh, std::int32_t t, std::uint32_t a, std::uint32_t b) {
  const Triangle& q = mesh.triangles[static_cast<std::size_t>(t)];
  for (int k = 0; k < 3; ++k)
    if (q[(k + 1) % 3] == a && q[(k + 2) % 3] == b) return k;
  return 0;
}

// Halves the triangle (a, b, c) from c to m on its edge (a, b): it keeps (a, m, c). Returns the new one, (m, b, c).
// Unlike EditMesh::split_edge it tells edges by their vertices, for two triangles may share two edges here.
std::int32_t halve(EditMesh& mesh, std::int32_t t, std::uint32_t a, std::uint32_t b, std::uint32_t m) {
  const int k = corner_opposite(mesh, t, a, b);
  const auto i = static_cast<std::size_t>(t);
  const std::uint32_t c = mesh.triangles[i][k];
  const std::int32_t beyond = mesh.neighbors[i][(k + 1) % 3];  // across (b, c)
  const auto half = static_cast<std::int32_t>(mesh.triangles.size());
  mesh.triangles.push_back({m, b, c});
  mesh.neighbors.push_back({beyond, t, -1});
  const auto crease = [&](int corner) { return static_cast<std::uint8_t>(mesh.creases[i] >> (corner % 3) & 1); };
  mesh.creases.push_back(static_cast<std::uint8_t>(crease(k + 1) | crease(k) << 2));  // across (b, c) and (m, b)
  mesh.creases[i] &= static_cast<std::uint8_t>(~(1 << ((k + 1) % 3)));
  if (beyond >= 0) mesh.neighbors[static_cast<std::size_t>(beyond)][corner_opposite(mesh, beyond, c, b)] = half;
  mesh.triangles[i][(k + 2) % 3] = m;
  mesh.neighbors[i][(k + 1) % 3] = half;
  for (const std::uint32_t v : {m, b, c}) mesh.vertex_triangle[v] = half;
  mesh.vertex_triangle[a] = t;
  return half;
}

void split_edge(EditMesh& mesh, std::int32_t t, int k) {
  const std::uint32_t a = mesh.triangles[static_cast<std::size_t>(t)][(k + 1) % 3];
  const std::uint32_t b = mesh.triangles[static_cast<std::size_t>(t)][(k + 2) % 3];
  const std::int32_t n = mesh.neighbors[static_cast<std::size_t>(t)][k];
  const auto m = static_cast<std::uint32_t>(mesh.vertices.size());
  EditMesh::Vertex middle;
  middle.p = 0.5 * (mesh.vertices[a].p + mesh.vertices[b].p);
  mesh.vertices.push_back(middle);
  mesh.vertex_triangle.push_back(t);
  const std::int32_t half = halve(mesh, t, a, b, m);  // t = (a, m, c), half = (m, b, c)
  if (n < 0) {
    mesh.neighbors[static_cast<std::size_t>(half)][2] = -1;
    return;
  }
  const std::int32_t other = halve(mesh, n, b, a, m);  // n = (b, m, d), other = (m, a, d)
  mesh.neighbors[static_cast<std::size_t>(t)][corner_opposite(mesh, t, a, m)] = other;
  mesh.neighbors[static_cast<std::size_t>(other)][2] = t;
  mesh.neighbors[static_cast<std::size_t>(half)][2] = n;
  mesh.neighbors[static_cast<std::size_t>(n)][corner_opposite(mesh, n, b, m)] = half;
}

// Around a pole or a narrow closed face two edges may join the same two vertices: all but one get a vertex in the
// middle.
// Inside a face no edge is double.
void split_double_seam_edges(EditMesh& mesh, const std::vector<std::uint8_t>& on_chain,
                             std::span<const std::uint32_t> chained_triangles) {
  struct Edge {
    std::uint32_t a, b;
    SideUse use;
  };
  std::vector<Edge> edges;
  const auto chained = [&](std::uint32_t v) { return v >= on_chain.size() || on_chain[v]; };
  for (const std::uint32_t i : chained_triangles)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[i][(k + 1) % 3], b = mesh.triangles[i][(k + 2) % 3];
      if (!chained(a) && !chained(b)) continue;
      const std::int32_t n = mesh.neighbors[i][k];
      if (n >= 0 && a > b) continue;  // seen from the other side
      edges.push_back({std::min(a, b), std::max(a, b), {static_cast<std::int32_t>(i), k}});
    }
  std::stable_sort(edges.begin(), edges.end(),
                   [](const Edge& x, const Edge& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const Edge& e = edges[i];
    if (e.a != edges[i - 1].a || e.b != edges[i - 1].b) continue;
    // An earlier split may have handed the edge to the triangle's other half.
    std::vector<std::int32_t> around{e.use.triangle};
    for (const std::int32_t n : mesh.neighbors[static_cast<std::size_t>(e.use.triangle)])
      if (n >= 0) around.push_back(n);
    for (const std::int32_t t : around) {
      const Triangle& q = mesh.triangles[static_cast<std::size_t>(t)];
      const int k = corner_opposite(mesh, t, e.a, e.b), back = corner_opposite(mesh, t, e.b, e.a);
      const auto is = [&](int c, std::uint32_t x, std::uint32_t y) {
        return q[(c + 1) % 3] == x && q[(c + 2) % 3] == y;
      };
      if (is(k, e.a, e.b)) {
        split_edge(mesh, t, k);
      } else if (is(back, e.b, e.a)) {
        split_edge(mesh, t, back);
      } else {
        continue;
      }
      break;
    }
  }
}

}  // namespace

EditMesh glue_patches(const CadModel& model, const std::vector<FacePatch>& patches,
                      const std::vector<std::size_t>& chain_sizes, std::vector<EditMesh::Vertex> vertices,
                      const std::vector<std::uint8_t>& on_chain, bool join_faces) {
  EditMesh mesh;
  mesh.vertices = std::move(vertices);
  std::vector<std::int32_t> first;  // triangle of each face
  const auto face_of = [&](std::int32_t t) { return std::upper_bound(first.begin(), first.end(), t) - first.begin(); };
  std::size_t total = 0;
  for (const FacePatch& patch : patches) total += patch.triangles.size();
  mesh.triangles.resize(total);
  mesh.neighbors.resize(total);
  std::vector<std::vector<std::vector<SideUse>>> uses(model.edges.size());
  std::size_t begin = 0;
  for (std::size_t f = 0; f < patches.size(); ++f) {
    const FacePatch& patch = patches[f];
    const auto base = static_cast<std::int32_t>(begin);
    first.push_back(base);
    const bool turned = model.faces[f].reversed;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, patch.triangles.size(), 1 << 14), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        Triangle t = patch.triangles[i];
        std::array<std::int32_t, 3> n = patch.neighbors[i];
        for (auto& x : n)
          if (x >= 0) x += base;
        if (turned) {
          std::swap(t[1], t[2]);
          std::swap(n[1], n[2]);
        }
        mesh.triangles[begin + i] = t;
        mesh.neighbors[begin + i] = n;
      }
    });
    begin += patch.triangles.size();
    for (const ChainSide& side : patch.sides) {
      auto& chain = uses[static_cast<std::size_t>(side.edge)];
      if (chain.empty()) chain.resize(chain_sizes[static_cast<std::size_t>(side.edge)]);
      const int corner = turned && side.corner > 0 ? 3 - side.corner : side.corner;
      chain[static_cast<std::size_t>(side.segment)].push_back({side.triangle + base, corner});
    }
  }
  mesh.creases.assign(mesh.triangles.size(), 0);
  for (const auto& chain : uses)
    for (const auto& pair : chain) {
      if (pair.size() != 2) continue;
      const auto [t, k] = pair[0];
      const auto [u, j] = pair[1];
      if (!join_faces && face_of(t) != face_of(u)) continue;
      const Triangle &a = mesh.triangles[static_cast<std::size_t>(t)], &b = mesh.triangles[static_cast<std::size_t>(u)];
      if (a[(k + 1) % 3] != b[(j + 2) % 3] || a[(k + 2) % 3] != b[(j + 1) % 3]) continue;
      mesh.neighbors[static_cast<std::size_t>(t)][k] = u;
      mesh.neighbors[static_cast<std::size_t>(u)][j] = t;
      mesh.creases[static_cast<std::size_t>(t)] |= static_cast<std::uint8_t>(1 << k);
      mesh.creases[static_cast<std::size_t>(u)] |= static_cast<std::uint8_t>(1 << j);
    }
  drop_degenerate(mesh);
  const std::vector<std::uint32_t> chained = select_indices(mesh.triangles.size(), [&](std::uint32_t t) {
    const Triangle& q = mesh.triangles[t];
    return (on_chain[q[0]] | on_chain[q[1]] | on_chain[q[2]]) != 0;
  });
  split_fans(mesh, on_chain, chained);
  mesh.index_vertices();
  split_double_seam_edges(mesh, on_chain, chained);
  return mesh;
}

}  // namespace tri
