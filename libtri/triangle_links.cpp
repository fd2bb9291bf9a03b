#include "libtri/triangle_links.hpp"

namespace tri {

TriangleNeighbors link_triangles(const std::vector<Triangle>& triangles, std::size_t vertices) {
  struct Side {
    std::uint32_t to;
    std::uint32_t triangle;
    std::uint8_t corner;
    bool forward;
  };
  // Counting sort of the edges by their lower vertex; pairs are then found within short lists.
  std::vector<std::uint32_t> start(vertices + 1, 0);
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) ++start[std::min(t[(k + 1) % 3], t[(k + 2) % 3]) + 1];
  for (std::size_t v = 0; v < vertices; ++v) start[v + 1] += start[v];
  std::vector<Side> sides(triangles.size() * 3);
  std::vector<std::uint32_t> fill(start.begin(), start.end() - 1);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[i][(k + 1) % 3], b = triangles[i][(k + 2) % 3];
      sides[fill[std::min(a, b)]++] = {std::max(a, b), static_cast<std::uint32_t>(i), static_cast<std::uint8_t>(k), a < b};
    }
  TriangleNeighbors neighbors(triangles.size(), {-1, -1, -1});
  for (std::size_t v = 0; v < vertices; ++v)
    for (std::uint32_t i = start[v]; i < start[v + 1]; ++i) {
      std::uint32_t partner = i;
      int uses = 0;
      for (std::uint32_t j = start[v]; j < start[v + 1]; ++j)
        if (sides[j].to == sides[i].to) {
          ++uses;
          if (j != i) partner = j;
        }
      if (uses != 2 || sides[partner].forward == sides[i].forward) continue;
      neighbors[sides[i].triangle][sides[i].corner] = static_cast<std::int32_t>(sides[partner].triangle);
    }
  return neighbors;
}

std::vector<std::uint32_t> split_fans(std::vector<Triangle>& triangles, const TriangleNeighbors& neighbors, std::size_t vertices) {
  std::vector<std::uint32_t> copied_from;
  std::vector<bool> seen_vertex(vertices, false);
  std::vector<std::array<bool, 3>> seen_corner(triangles.size(), {false, false, false});
  const auto corner_of = [&](std::int32_t t, std::uint32_t v) {
    const Triangle& q = triangles[static_cast<std::size_t>(t)];
    return q[0] == v ? 0 : q[1] == v ? 1 : 2;
  };
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      if (seen_corner[i][k]) continue;
      const std::uint32_t v = triangles[i][k];
      std::uint32_t name = v;
      if (seen_vertex[v]) {
        name = static_cast<std::uint32_t>(vertices + copied_from.size());
        copied_from.push_back(v);
      }
      seen_vertex[v] = true;
      std::vector<std::pair<std::int32_t, int>> fan{{static_cast<std::int32_t>(i), k}};
      seen_corner[i][k] = true;
      for (std::size_t at = 0; at < fan.size(); ++at) {
        const auto [t, c] = fan[at];
        for (int side : {(c + 1) % 3, (c + 2) % 3}) {
          const std::int32_t n = neighbors[t][side];
          if (n < 0) continue;
          const int nc = corner_of(n, v);
          if (seen_corner[n][nc]) continue;
          seen_corner[n][nc] = true;
          fan.push_back({n, nc});
        }
      }
      for (const auto& [t, c] : fan) triangles[t][c] = name;
    }
  return copied_from;
}

}  // namespace tri
