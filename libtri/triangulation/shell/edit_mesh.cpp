#include "libtri/triangulation/shell/edit_mesh.hpp"

#include <algorithm>

namespace tri {

void EditMesh::index_vertices() {
  vertex_triangle.assign(vertices.size(), -1);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (alive(static_cast<std::int32_t>(t)))
      for (std::uint32_t v : triangles[t]) vertex_triangle[v] = static_cast<std::int32_t>(t);
}

bool EditMesh::star(std::uint32_t v, Star& out, std::size_t limit) const {
  out.fan.clear();
  out.ring.clear();
  out.closed = false;
  const std::int32_t start = vertex_triangle[v];
  // Clockwise to the boundary, or once around.
  std::int32_t first = start;
  for (std::size_t steps = 0;; ++steps) {
    if (steps > limit) return false;
    const std::int32_t previous = neighbors[first][(corner(first, v) + 2) % 3];
    if (previous < 0) break;
    if (previous == start) {
      out.closed = true;
      first = start;
      break;
    }
    first = previous;
  }
  for (std::int32_t t = first; t >= 0;) {
    if (out.fan.size() >= limit) return false;
    const int c = corner(t, v);
    out.fan.push_back(t);
    out.ring.push_back(triangles[t][(c + 1) % 3]);
    const std::int32_t next = neighbors[t][(c + 1) % 3];
    if (next < 0) out.ring.push_back(triangles[t][(c + 2) % 3]);
    if (next == first) break;
    t = next;
  }
  return true;
}

bool EditMesh::has_edge(std::uint32_t a, std::uint32_t b) const {
  const std::int32_t start = vertex_triangle[a];
  std::int32_t t = start;
  do {
    const int c = corner(t, a);
    if (triangles[t][(c + 1) % 3] == b || triangles[t][(c + 2) % 3] == b) return true;
    t = neighbors[t][(c + 1) % 3];
  } while (t >= 0 && t != start);
  if (t == start) return false;
  t = start;
  while (true) {
    const int c = corner(t, a);
    if (triangles[t][(c + 1) % 3] == b || triangles[t][(c + 2) % 3] == b) return true;
    t = neighbors[t][(c + 2) % 3];
    if (t < 0) return false;
  }
}

bool EditMesh::on_boundary(std::uint32_t v) const {
  const std::int32_t start = vertex_triangle[v];
  std::int32_t t = start;
  do {
    t = neighbors[t][(corner(t, v) + 1) % 3];
  } while (t >= 0 && t != start);
  return t < 0;
}

void EditMesh::flip(std::int32_t t, int k) {
  const std::int32_t n = neighbors[t][k];
  Triangle& q = triangles[t];
  const int m = side(n, q[(k + 2) % 3], q[(k + 1) % 3]);
  Triangle& r = triangles[n];
  const std::uint32_t a = q[k], b = q[(k + 1) % 3], c = q[(k + 2) % 3], d = r[m];
  // t = (a,b,c) and n = (d,c,b) become t = (a,b,d) and n = (a,d,c).
  const std::int32_t ab = neighbors[t][(k + 2) % 3], ca = neighbors[t][(k + 1) % 3];
  const std::int32_t bd = neighbors[n][(m + 1) % 3], dc = neighbors[n][(m + 2) % 3];
  const auto bit = [&](std::int32_t x, int i) { return static_cast<std::uint8_t>(creases[x] >> i & 1); };
  const std::uint8_t crease_ab = bit(t, (k + 2) % 3), crease_ca = bit(t, (k + 1) % 3);
  const std::uint8_t crease_bd = bit(n, (m + 1) % 3), crease_dc = bit(n, (m + 2) % 3);
  const int bd_side = bd >= 0 ? side(bd, d, b) : 0, ca_side = ca >= 0 ? side(ca, a, c) : 0;
  q = {a, b, d};
  r = {a, d, c};
  neighbors[t] = {bd, n, ab};
  neighbors[n] = {dc, ca, t};
  creases[t] = static_cast<std::uint8_t>(crease_bd | crease_ab << 2);
  creases[n] = static_cast<std::uint8_t>(crease_dc | crease_ca << 1);
  if (bd >= 0 && bd != t) neighbors[bd][bd_side] = t;
  if (ca >= 0 && ca != n) neighbors[ca][ca_side] = n;
  vertex_triangle[a] = vertex_triangle[b] = vertex_triangle[d] = t;
  vertex_triangle[c] = n;
}

std::uint32_t EditMesh::split_edge(std::int32_t t, int k, const Vertex& vertex) {
  const std::uint32_t m = static_cast<std::uint32_t>(vertices.size());
  vertices.push_back(vertex);
  const std::int32_t n = neighbors[t][k];
  const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3], c = triangles[t][(k + 2) % 3];
  const bool crease = creases[t] >> k & 1;
  const auto bit = [&](std::int32_t x, int i) { return static_cast<std::uint8_t>(creases[x] >> i & 1); };
  // t = (a,b,c) keeps (a,b,m); t2 = (a,m,c).
  const std::int32_t t2 = static_cast<std::int32_t>(triangles.size());
  const std::int32_t ab = neighbors[t][(k + 2) % 3], ca = neighbors[t][(k + 1) % 3];
  const std::uint8_t crease_ab = bit(t, (k + 2) % 3), crease_ca = bit(t, (k + 1) % 3);
  triangles.push_back({a, m, c});
  neighbors.push_back({-1, ca, t});
  creases.push_back(static_cast<std::uint8_t>(crease | crease_ca << 1));
  triangles[t] = {a, b, m};
  neighbors[t] = {-1, t2, ab};
  creases[t] = static_cast<std::uint8_t>(crease | crease_ab << 2);
  if (ca >= 0) neighbors[ca][side(ca, a, c)] = t2;
  vertex_triangle.push_back(t);
  vertex_triangle[c] = t2;
  if (n >= 0) {
    const int j = side(n, c, b);
    const std::uint32_t d = triangles[n][j];
    // n = (d,c,b) keeps (d,m,b); n2 = (d,c,m).
    const std::int32_t n2 = static_cast<std::int32_t>(triangles.size());
    const std::int32_t dc = neighbors[n][(j + 2) % 3], bd = neighbors[n][(j + 1) % 3];
    const std::uint8_t crease_dc = bit(n, (j + 2) % 3), crease_bd = bit(n, (j + 1) % 3);
    triangles.push_back({d, c, m});
    neighbors.push_back({t2, n, dc});
    creases.push_back(static_cast<std::uint8_t>(crease | crease_dc << 2));
    triangles[n] = {d, m, b};
    neighbors[n] = {t, bd, n2};
    creases[n] = static_cast<std::uint8_t>(crease | crease_bd << 1);
    if (dc >= 0) neighbors[dc][side(dc, c, d)] = n2;
    neighbors[t][0] = n;
    neighbors[t2][0] = n2;
    vertex_triangle[d] = n;
    vertex_triangle[c] = t2;
  }
  vertex_triangle[b] = t;
  vertex_triangle[a] = t;
  return m;
}

void EditMesh::replace_star(std::uint32_t v, const Star& star, std::span<const Triangle> patch) {
  replace(star.fan, patch);
  vertex_triangle[v] = -1;
}

void EditMesh::replace(std::span<const std::int32_t> old, std::span<const Triangle> patch) {
  // What lies outside each side of the region, to be linked again.
  struct Outer {
    std::uint32_t a, b;
    std::int32_t triangle;
    bool crease;
  };
  std::vector<Outer> outer;
  outer.reserve(old.size() + 2);
  for (std::int32_t t : old)
    for (int k = 0; k < 3; ++k) {
      const std::int32_t n = neighbors[t][k];
      if (n >= 0 && std::find(old.begin(), old.end(), n) != old.end()) continue;
      outer.push_back({triangles[t][(k + 1) % 3], triangles[t][(k + 2) % 3], n, (creases[t] >> k & 1) != 0});
    }
  for (std::size_t i = 0; i < old.size(); ++i) {
    const std::int32_t t = old[i];
    triangles[t] = i < patch.size() ? patch[i] : Triangle{0, 0, 0};
    neighbors[t] = {-1, -1, -1};
    creases[t] = 0;
  }
  for (std::size_t i = 0; i < patch.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const std::int32_t t = old[i];
      const std::uint32_t a = patch[i][(k + 1) % 3], b = patch[i][(k + 2) % 3];
      for (const Outer& o : outer)
        if (o.a == a && o.b == b) {
          neighbors[t][k] = o.triangle;
          if (o.crease) creases[t] |= static_cast<std::uint8_t>(1u << k);
          if (o.triangle >= 0) {
            const Triangle& q = triangles[o.triangle];
            for (int j = 0; j < 3; ++j)
              if (q[(j + 1) % 3] == b && q[(j + 2) % 3] == a) neighbors[o.triangle][j] = t;
          }
        }
      for (std::size_t j = 0; j < patch.size(); ++j)
        if (j != i)
          for (int m = 0; m < 3; ++m)
            if (patch[j][(m + 1) % 3] == b && patch[j][(m + 2) % 3] == a) neighbors[t][k] = old[j];
    }
  // Sides that the patch leaves out become boundary of what lies outside them.
  for (const Outer& o : outer) {
    if (o.triangle < 0) continue;
    bool used = false;
    for (const Triangle& q : patch)
      for (int k = 0; k < 3; ++k) used |= q[(k + 1) % 3] == o.a && q[(k + 2) % 3] == o.b;
    if (used) continue;
    const Triangle& q = triangles[o.triangle];
    for (int j = 0; j < 3; ++j)
      if (q[(j + 1) % 3] == o.b && q[(j + 2) % 3] == o.a) neighbors[o.triangle][j] = -1;
  }
  for (const Outer& o : outer)
    if (o.triangle >= 0) vertex_triangle[o.a] = vertex_triangle[o.b] = o.triangle;
  for (std::size_t i = 0; i < patch.size(); ++i)
    for (std::uint32_t w : patch[i]) vertex_triangle[w] = old[i];
}

}  // namespace tri
