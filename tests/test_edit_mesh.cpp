#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libtri/triangulation/shell/edit_mesh.hpp"
#include "link_check.hpp"

using namespace tri;

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge sorted(std::uint32_t a, std::uint32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

struct Grid {
  std::string name;
  int columns, rows;
  bool closed_u, closed_v;
  long components, loops, euler;
};
const Grid grids[] = {
    {"sheet", 8, 6, false, false, 1, 1, 1}, {"tube", 8, 6, true, false, 1, 2, 0}, {"torus", 8, 6, true, true, 1, 0, 0}};

EditMesh make(const Grid& g) {
  const int nu = g.columns + !g.closed_u, nv = g.rows + !g.closed_v;
  EditMesh mesh;
  mesh.vertices.resize(static_cast<std::size_t>(nu * nv));
  const auto vertex = [&](int i, int j) { return static_cast<std::uint32_t>((j % nv) * nu + i % nu); };
  for (int j = 0; j < g.rows; ++j)
    for (int i = 0; i < g.columns; ++i) {
      const auto a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  std::map<Edge, std::int32_t> sides;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      sides[{mesh.triangles[t][(k + 1) % 3], mesh.triangles[t][(k + 2) % 3]}] = static_cast<std::int32_t>(t);
  for (const Triangle& t : mesh.triangles) {
    std::array<std::int32_t, 3> row;
    for (int k = 0; k < 3; ++k) {
      const auto twin = sides.find({t[(k + 2) % 3], t[(k + 1) % 3]});
      row[k] = twin == sides.end() ? -1 : twin->second;
    }
    mesh.neighbors.push_back(row);
  }
  mesh.creases.assign(mesh.triangles.size(), 0);
  mesh.index_vertices();
  return mesh;
}

// All edges of the living triangles, and those marked as creases from either side.
struct Edges {
  std::map<Edge, int> all;  // with the number of triangles
  std::set<Edge> creases;
  bool one_sided_crease = false;
};
Edges edges_of(const EditMesh& mesh) {
  Edges result;
  std::map<Edge, int> marks;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!mesh.alive(static_cast<std::int32_t>(t))) continue;
    for (int k = 0; k < 3; ++k) {
      const Edge e = sorted(mesh.triangles[t][(k + 1) % 3], mesh.triangles[t][(k + 2) % 3]);
      ++result.all[e];
      if (mesh.creases[t] >> k & 1) ++marks[e], result.creases.insert(e);
    }
  }
  for (const auto& [edge, count] : marks) result.one_sided_crease |= count != result.all[edge];
  return result;
}

void mark_crease(EditMesh& mesh, std::int32_t t, int k) {
  const Edge e = sorted(mesh.triangles[t][(k + 1) % 3], mesh.triangles[t][(k + 2) % 3]);
  mesh.creases[t] |= static_cast<std::uint8_t>(1u << k);
  const std::int32_t n = mesh.neighbors[t][k];
  if (n < 0) return;
  for (int m = 0; m < 3; ++m)
    if (sorted(mesh.triangles[n][(m + 1) % 3], mesh.triangles[n][(m + 2) % 3]) == e)
      mesh.creases[n] |= static_cast<std::uint8_t>(1u << m);
}

void check_state(const EditMesh& mesh, const Grid& grid, const std::set<Edge>& creases) {
  const test::LinkedTriangles linked = test::check_links(mesh.triangles, mesh.neighbors);
  CHECK_LINKS(linked);
  REQUIRE(linked.problems.empty());
  REQUIRE(linked.double_edges.empty());
  REQUIRE(linked.components == grid.components);
  REQUIRE(linked.loops == grid.loops);
  REQUIRE(linked.euler == grid.euler);
  REQUIRE(mesh.vertex_triangle.size() == mesh.vertices.size());
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const std::int32_t t = mesh.vertex_triangle[v];
    REQUIRE((t >= 0) == (linked.vertices.count(v) == 1));
    if (t < 0) continue;
    REQUIRE(mesh.alive(t));
    REQUIRE(std::count(mesh.triangles[t].begin(), mesh.triangles[t].end(), v) == 1);
  }
  const Edges edges = edges_of(mesh);
  REQUIRE_FALSE(edges.one_sided_crease);
  REQUIRE(edges.creases == creases);
}

// The star as the triangles say it, without walking.
void check_star(const EditMesh& mesh, std::uint32_t v, const EditMesh::Star& star) {
  std::set<std::int32_t> fan;
  std::set<std::uint32_t> ring;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& q = mesh.triangles[t];
    if (!mesh.alive(static_cast<std::int32_t>(t)) || std::find(q.begin(), q.end(), v) == q.end()) continue;
    fan.insert(static_cast<std::int32_t>(t));
    for (const std::uint32_t w : q)
      if (w != v) ring.insert(w);
  }
  REQUIRE(std::set<std::int32_t>(star.fan.begin(), star.fan.end()) == fan);
  REQUIRE(star.fan.size() == fan.size());
  REQUIRE(std::set<std::uint32_t>(star.ring.begin(), star.ring.end()) == ring);
  REQUIRE(star.ring.size() == ring.size());
  REQUIRE(star.closed == (star.ring.size() == star.fan.size()));
  for (std::size_t i = 0; i < star.fan.size(); ++i) {
    const Triangle& q = mesh.triangles[star.fan[i]];
    const int c = mesh.corner(star.fan[i], v);
    REQUIRE(q[(c + 1) % 3] == star.ring[i]);
    REQUIRE(q[(c + 2) % 3] == star.ring[(i + 1) % star.ring.size()]);
  }
}

class RandomEdits {
 public:
  RandomEdits(EditMesh& mesh, std::uint32_t seed) : mesh_(mesh), random_(seed) {
    for (int i = 0; i < 20; ++i) mark_crease(mesh_, triangle(), corner());
    creases = edges_of(mesh_).creases;
  }

  bool flip() {
    const std::int32_t t = triangle();
    const int k = corner();
    const std::int32_t n = mesh_.neighbors[t][k];
    if (n < 0 || (mesh_.creases[t] >> k & 1)) return false;
    const std::uint32_t b = mesh_.triangles[t][(k + 1) % 3], c = mesh_.triangles[t][(k + 2) % 3];
    const std::uint32_t a = mesh_.triangles[t][k], d = mesh_.opposite(t, k);
    const auto before = edges_of(mesh_).all;
    REQUIRE(mesh_.has_edge(a, d) == (before.count(sorted(a, d)) == 1));
    if (a == d || before.count(sorted(a, d))) return false;
    mesh_.flip(t, k);
    auto expected = before;
    expected.erase(sorted(b, c));
    expected[sorted(a, d)] = 2;
    REQUIRE(edges_of(mesh_).all == expected);
    return true;
  }

  void split() {
    const std::int32_t t = triangle();
    const int k = corner();
    const std::uint32_t b = mesh_.triangles[t][(k + 1) % 3], c = mesh_.triangles[t][(k + 2) % 3];
    EditMesh::Vertex vertex;
    vertex.point = 17;
    const std::uint32_t m = mesh_.split_edge(t, k, vertex);
    REQUIRE(m + 1 == mesh_.vertices.size());
    REQUIRE(mesh_.vertices[m].point == 17);
    if (creases.erase(sorted(b, c))) creases.insert({sorted(b, m), sorted(m, c)});
  }

  // Removes a vertex and fills its star from one ring vertex, or lets the boundary recede to the ring.
  bool remove() {
    const std::uint32_t v = mesh_.triangles[triangle()][corner()];
    EditMesh::Star star;
    REQUIRE(mesh_.star(v, star, 1000));
    check_star(mesh_, v, star);
    REQUIRE(mesh_.on_boundary(v) == !star.closed);
    EditMesh::Star cut_short;
    REQUIRE(mesh_.star(v, cut_short, star.fan.size()));
    REQUIRE_FALSE(mesh_.star(v, cut_short, star.fan.size() - 1));
    const auto edges = edges_of(mesh_).all;
    const std::size_t n = star.ring.size();
    std::vector<Triangle> patch;
    std::set<Edge> open;  // ring edges that the patch leaves out
    if (!star.closed && random_() % 2) {
      for (std::size_t i = 0; i + 1 < n; ++i) {
        if (edges.at(sorted(star.ring[i], star.ring[i + 1])) != 2) return false;
        if (i > 0 && mesh_.on_boundary(star.ring[i])) return false;
        open.insert(sorted(star.ring[i], star.ring[i + 1]));
      }
    } else {
      if (n < 4) return false;
      const std::size_t hub = star.closed ? random_() % n : 0;
      for (std::size_t i = 1; i + 1 < n; ++i) {
        const Triangle q{star.ring[hub], star.ring[(hub + i) % n], star.ring[(hub + i + 1) % n]};
        patch.push_back(q);
        const bool last_chord = !star.closed || i + 2 < n;
        if (last_chord && edges.count(sorted(q[0], q[2]))) return false;
      }
    }
    mesh_.replace_star(v, star, patch);
    REQUIRE(mesh_.vertex_triangle[v] == -1);
    std::erase_if(creases, [&](const Edge& e) { return e.first == v || e.second == v; });
    return true;
  }

  std::set<Edge> creases;

 private:
  std::int32_t triangle() {
    while (true) {
      const auto t = static_cast<std::int32_t>(random_() % mesh_.triangles.size());
      if (mesh_.alive(t)) return t;
    }
  }
  int corner() { return static_cast<int>(random_() % 3); }

  EditMesh& mesh_;
  std::mt19937 random_;
};

}  // namespace

TEST_CASE("EditMesh: random flips, splits and removals keep links, creases and topology") {
  for (const Grid& grid : grids) {
    CAPTURE(grid.name);
    for (std::uint32_t seed = 1; seed <= 3; ++seed) {
      EditMesh mesh = make(grid);
      RandomEdits edits(mesh, seed);
      int flips = 0, removals = 0;
      for (int step = 0; step < 300; ++step) {
        flips += edits.flip();
        if (step % 3 == 0) edits.split();
        if (step % 2 == 0) removals += edits.remove();
        if (step % 10 == 0) check_state(mesh, grid, edits.creases);
      }
      check_state(mesh, grid, edits.creases);
      CHECK(flips > 50);
      CHECK(removals > 20);
    }
  }
}

TEST_CASE("EditMesh: a flip and the flip back give the same edges, with the creases beside them") {
  EditMesh mesh = make(grids[0]);
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles.size()); t += 3)
    if (mesh.neighbors[t][0] >= 0) mark_crease(mesh, t, 0);
  const Edges before = edges_of(mesh);
  int flipped = 0;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles.size()); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::int32_t n = mesh.neighbors[t][k];
      if (n < 0 || (mesh.creases[t] >> k & 1)) continue;
      const std::uint32_t a = mesh.triangles[t][k], d = mesh.opposite(t, k);
      if (mesh.has_edge(a, d)) continue;
      mesh.flip(t, k);
      int back = 0;
      while (sorted(mesh.triangles[t][(back + 1) % 3], mesh.triangles[t][(back + 2) % 3]) != sorted(a, d)) ++back;
      mesh.flip(t, back);
      ++flipped;
      const Edges after = edges_of(mesh);
      REQUIRE(after.all == before.all);
      REQUIRE(after.creases == before.creases);
      break;
    }
  CHECK(flipped > 20);
  check_state(mesh, grids[0], before.creases);
}

TEST_CASE("EditMesh: an edge split keeps the area on both sides and the boundary closed") {
  EditMesh mesh = make(grids[0]);
  const std::size_t triangles = mesh.triangles.size();
  std::int32_t rim = 0;
  int side = 0;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(triangles); ++t)
    for (int k = 0; k < 3; ++k)
      if (mesh.neighbors[t][k] < 0) rim = t, side = k;
  const std::uint32_t on_rim = mesh.split_edge(rim, side, {});
  CHECK(mesh.triangles.size() == triangles + 1);
  CHECK(mesh.on_boundary(on_rim));
  std::int32_t inner = 0;
  while (mesh.neighbors[inner][0] < 0) ++inner;
  const std::uint32_t inside = mesh.split_edge(inner, 0, {});
  CHECK(mesh.triangles.size() == triangles + 3);
  CHECK_FALSE(mesh.on_boundary(inside));
  check_state(mesh, grids[0], {});
}
