#include <doctest/doctest.h>

#include <random>

#include "meshops/crossings/crossing_guard.hpp"
#include "meshops/crossings/self_intersections.hpp"
#include "meshops/editing/mesh_edit.hpp"
#include "meshops/to_soup.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

std::size_t crossings(Mesh& mesh) {
  const Soup soup = to_soup(view_of(mesh));
  return self_intersections(soup.points, soup.triangles, Context(), Neighbors::judge).size();
}

/// Asks of a random change, makes it in a copy, and compares. Then makes it, if it is wanted.
struct Trial {
  Mesh mesh;
  CrossingGuard guard{view_of(mesh), context()};
  std::size_t now = crossings(mesh);
  int worse = 0, as_good = 0;

  explicit Trial(const Mesh& m) : mesh(m) { guard.build(); }
  static const Context& context() {
    static const Context c;
    return c;
  }

  template <class Change>
  void go(bool says_worse, bool make, const Change& change) {
    Mesh copy = mesh;
    change(copy);
    const std::size_t then = crossings(copy);
    REQUIRE(says_worse == (then > now));
    ++(says_worse ? worse : as_good);
    if (!make) return;
    change(mesh);
    guard.done();
    now = then;
  }
};

}  // namespace

TEST_CASE(
    "crossing_guard: says what brute force says, of collapses, flips and moves on what crosses and what does not") {
  for (const std::uint32_t seed : {1u, 2u}) {
    Trial trial(crumpled_sheets(9, 0.05, seed));
    REQUIRE(trial.now == 0);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> shift(-0.7, 0.7);
    Mesh& mesh = trial.mesh;
    for (int step = 0; step < 900; ++step) {
      // In the second half changes are made that make it worse, too.
      const bool any = step >= 450;
      const EdgeHandle e(static_cast<int>(random() % mesh.n_edges()));
      const VertexHandle v(static_cast<int>(random() % mesh.n_vertices()));
      if (mesh.status(e).deleted() || mesh.status(v).deleted()) continue;
      const HalfedgeHandle h = mesh.halfedge_handle(e, random() % 2);
      if (step % 3 == 0) {
        if (step % 9 != 0 || !is_collapse_ok(mesh, h)) continue;
        const VertexHandle to = mesh.to_vertex_handle(h);
        const Vec3 place = step % 2 ? mesh.point(to) : 0.5 * (mesh.point(to) + mesh.point(mesh.from_vertex_handle(h)));
        const bool worse = trial.guard.collapse_makes_worse(h, place);
        trial.go(worse, any || !worse, [&](Mesh& m) {
          set_point(view_of(m), to, place);
          collapse(view_of(m), h);
        });
      } else if (step % 3 == 1) {
        if (mesh.is_boundary(e) || !mesh.is_flip_ok(e)) continue;
        const bool worse = trial.guard.flip_makes_worse(e);
        trial.go(worse, any || !worse, [&](Mesh& m) { flip_edge(view_of(m), e); });
      } else {
        const Vec3 place = mesh.point(v) + Vec3(shift(random), shift(random), shift(random)) * (step % 2 ? 1 : 0.1);
        const bool worse = trial.guard.move_makes_worse(v, place);
        trial.go(worse, any || !worse, [&](Mesh& m) { set_point(view_of(m), v, place); });
      }
    }
    CHECK(trial.worse > 50);
    CHECK(trial.as_good > 50);
    CHECK(trial.now > 0);
  }
}

TEST_CASE("crossing_guard: knows faces that were added") {
  Mesh mesh = crumpled_sheets(4, 0.05, 3);
  const Context context;
  CrossingGuard guard(view_of(mesh), context);
  std::mt19937 random(3);
  for (int k = 0; k < 60; ++k) {
    const EdgeHandle e(static_cast<int>(random() % mesh.n_edges()));
    const HalfedgeHandle h = mesh.halfedge_handle(e, 0);
    const Vec3 &a = mesh.point(mesh.from_vertex_handle(h)), &b = mesh.point(mesh.to_vertex_handle(h));
    const VertexHandle v = split_edge(view_of(mesh), e, 0.5 * (a + b), 0.5);
    guard.split(v);
    const std::size_t before = crossings(mesh);
    const Vec3 place = mesh.point(v) + Vec3(0, 0, k % 2 ? 0.1 : -0.1);
    Mesh copy = mesh;
    copy.set_point(v, place);
    const bool worse = guard.move_makes_worse(v, place);
    REQUIRE(worse == (crossings(copy) > before));
    if (worse) continue;
    set_point(view_of(mesh), v, place);
    guard.done();
  }
}

TEST_CASE("triangles_cross: corners and sides in common do not count, by their places") {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), d(0, 0, 1), e(1, 1, 1);
  CHECK_FALSE(triangles_cross({a, b, c}, {b, a, d}));
  CHECK_FALSE(triangles_cross({a, b, c}, {a, d, e}));
  CHECK_FALSE(triangles_cross({a, b, c}, {d, e, Vec3(0, 1, 1)}));
  CHECK(triangles_cross({a, b, c}, {b, a, Vec3(0.5, 0.5, 0)}));
  CHECK(triangles_cross({a, b, c}, {a, b, Vec3(0.5, 0.5, 0)}));
  CHECK(triangles_cross({a, b, c}, {a, b, c}));
  CHECK(triangles_cross({a, b, c}, {Vec3(0.2, 0.2, -1), Vec3(0.2, 0.2, 1), Vec3(2, 2, 0)}));
  CHECK_FALSE(triangles_cross({a, b, c}, {a, b, Vec3(2, 0, 0)}));  // without an area
}
