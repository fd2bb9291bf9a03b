#include "libtri/patches/glue.hpp"

#include <algorithm>
#include <utility>

namespace tri {
namespace {

struct Use {
  std::int32_t triangle = -1;
  int corner = 0;
};

// Opens the sides of degenerate triangles onto each other and takes the triangles out.
void drop_degenerate(EditMesh& mesh) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto t = static_cast<std::int32_t>(i);
    const Triangle q = mesh.triangles[i];
    int same = -1;  // corner opposite the edge without length
    for (int k = 0; k < 3; ++k)
      if (q[(k + 1) % 3] == q[(k + 2) % 3]) same = k;
    if (same < 0) continue;
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
  if (static_cast<std::size_t>(count) == mesh.triangles.size()) return;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (number[i] < 0) continue;
    const auto to = static_cast<std::size_t>(number[i]);
    mesh.triangles[to] = mesh.triangles[i];
    for (int k = 0; k < 3; ++k) {
      const std::int32_t n = mesh.neighbors[i][k];
      mesh.neighbors[to][k] = n < 0 ? -1 : number[static_cast<std::size_t>(n)];
    }
  }
  mesh.triangles.resize(static_cast<std::size_t>(count));
  mesh.neighbors.resize(static_cast<std::size_t>(count));
}

void split_fans(EditMesh& mesh, const std::vector<std::uint8_t>& on_chain) {
  std::vector<std::uint8_t> seen(mesh.triangles.size(), 0);  // bit k: corner k
  std::vector<std::uint8_t> taken(mesh.vertices.size(), 0);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[i][k];
      if (v >= on_chain.size() || !on_chain[v] || (seen[i] >> k & 1)) continue;
      std::vector<Use> fan;
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
      for (const Use& u : fan) {
        seen[static_cast<std::size_t>(u.triangle)] |= static_cast<std::uint8_t>(1 << u.corner);
        mesh.triangles[static_cast<std::size_t>(u.triangle)][u.corner] = use;
      }
    }
}

}  // namespace

EditMesh glue_patches(const CadModel& model, const std::vector<FacePatch>& patches, const std::vector<std::size_t>& chain_sizes,
                      std::vector<EditMesh::Vertex> vertices, const std::vector<std::uint8_t>& on_chain) {
  EditMesh mesh;
  mesh.vertices = std::move(vertices);
  std::size_t total = 0;
  for (const FacePatch& patch : patches) total += patch.triangles.size();
  mesh.triangles.reserve(total);
  mesh.neighbors.reserve(total);
  std::vector<std::vector<std::vector<Use>>> uses(model.edges.size());
  for (std::size_t f = 0; f < patches.size(); ++f) {
    const FacePatch& patch = patches[f];
    const auto base = static_cast<std::int32_t>(mesh.triangles.size());
    const bool turned = model.faces[f].reversed;
    for (std::size_t i = 0; i < patch.triangles.size(); ++i) {
      Triangle t = patch.triangles[i];
      std::array<std::int32_t, 3> n = patch.neighbors[i];
      for (auto& x : n)
        if (x >= 0) x += base;
      if (turned) {
        std::swap(t[1], t[2]);
        std::swap(n[1], n[2]);
      }
      mesh.triangles.push_back(t);
      mesh.neighbors.push_back(n);
    }
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
      const Triangle &a = mesh.triangles[static_cast<std::size_t>(t)], &b = mesh.triangles[static_cast<std::size_t>(u)];
      if (a[(k + 1) % 3] != b[(j + 2) % 3] || a[(k + 2) % 3] != b[(j + 1) % 3]) continue;
      mesh.neighbors[static_cast<std::size_t>(t)][k] = u;
      mesh.neighbors[static_cast<std::size_t>(u)][j] = t;
    }
  drop_degenerate(mesh);
  mesh.creases.assign(mesh.triangles.size(), 0);
  split_fans(mesh, on_chain);
  mesh.index_vertices();
  return mesh;
}

}  // namespace tri
