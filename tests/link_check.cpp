#include "link_check.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

namespace tri::test {
namespace {

using IndexEdge = std::pair<std::uint32_t, std::uint32_t>;

struct Forest {
  std::vector<std::size_t> parent;
  explicit Forest(std::size_t n) : parent(n) { std::iota(parent.begin(), parent.end(), std::size_t{0}); }
  std::size_t root(std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { parent[root(a)] = root(b); }
};

}  // namespace

LinkedTriangles check_links(const std::vector<Triangle>& triangles,
                            const std::vector<std::array<std::int32_t, 3>>& neighbors) {
  LinkedTriangles result;
  const auto problem = [&](const std::string& text) {
    if (result.problems.size() < 10) result.problems.push_back(text);
  };
  if (triangles.size() != neighbors.size()) {
    problem("as many rows of neighbours as triangles are needed");
    return result;
  }
  const auto n_triangles = static_cast<std::int32_t>(triangles.size());
  const auto live = [&](std::size_t t) { return triangles[t][0] != triangles[t][1]; };
  const auto side = [&](std::size_t t, int k) {
    return IndexEdge(triangles[t][(k + 1) % 3], triangles[t][(k + 2) % 3]);
  };

  Forest corners(3 * triangles.size()), components(triangles.size());
  std::map<std::uint32_t, std::vector<std::uint32_t>> rim;  // from a vertex to the next along the boundary
  std::map<IndexEdge, int> undirected;
  long edges = 0, live_triangles = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!live(t)) continue;
    ++live_triangles;
    const Triangle& q = triangles[t];
    result.vertices.insert(q.begin(), q.end());
    if (q[1] == q[2] || q[2] == q[0]) problem("triangle " + std::to_string(t) + " has a vertex twice");
    for (int k = 0; k < 3; ++k) {
      const auto [from, to] = side(t, k);
      const std::int32_t n = neighbors[t][k];
      const auto at = std::to_string(t) + ", side " + std::to_string(k);
      if (n < 0) {
        ++edges;
        ++undirected[{std::min(from, to), std::max(from, to)}];
        rim[to].push_back(from);
        continue;
      }
      if (n >= n_triangles || !live(static_cast<std::size_t>(n)) || n == static_cast<std::int32_t>(t)) {
        problem("triangle " + at + ": neighbour " + std::to_string(n) + " is none");
        continue;
      }
      int answers = 0, twin = -1;
      for (int m = 0; m < 3; ++m)
        if (neighbors[n][m] == static_cast<std::int32_t>(t) &&
            side(static_cast<std::size_t>(n), m) == IndexEdge(to, from))
          ++answers, twin = m;
      if (answers != 1) {
        problem("triangle " + at + ": neighbour " + std::to_string(n) + " answers " + std::to_string(answers) +
                " times along the edge");
        continue;
      }
      components.join(t, static_cast<std::size_t>(n));
      corners.join(3 * t + (k + 1) % 3, 3 * static_cast<std::size_t>(n) + (twin + 2) % 3);
      corners.join(3 * t + (k + 2) % 3, 3 * static_cast<std::size_t>(n) + (twin + 1) % 3);
      if (static_cast<std::int32_t>(t) < n) {
        ++edges;
        ++undirected[{std::min(from, to), std::max(from, to)}];
      }
    }
  }
  std::map<std::uint32_t, std::set<std::size_t>> fans;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!live(t)) continue;
    result.components += components.root(t) == t;
    for (int k = 0; k < 3; ++k) fans[triangles[t][k]].insert(corners.root(3 * t + k));
  }
  for (const auto& [vertex, roots] : fans)
    if (roots.size() != 1)
      problem("vertex " + std::to_string(vertex) + " has " + std::to_string(roots.size()) + " fans");
  for (const auto& [edge, uses] : undirected)
    if (uses > 1) result.double_edges.push_back(edge);
  while (!rim.empty()) {
    ++result.loops;
    auto at = rim.begin();
    while (at != rim.end()) {
      const std::uint32_t next = at->second.back();
      at->second.pop_back();
      if (at->second.empty()) rim.erase(at);
      at = rim.find(next);
    }
  }
  result.euler = static_cast<long>(result.vertices.size()) - edges + live_triangles;
  return result;
}

}  // namespace tri::test
