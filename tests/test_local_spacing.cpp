#include <doctest/doctest.h>

#include "meshops/search/local_spacing.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

TEST_CASE("local_spacing: is the spacing of a regular mesh, whatever its scale") {
  for (const double scale : {1e-3, 1.0, 1e4}) {
    Mesh mesh = icosahedron();
    const double edge = mesh.calc_edge_length(EdgeHandle(0));
    for (const auto v : mesh.vertices()) mesh.set_point(v, mesh.point(v) * scale);
    for (const double s : local_spacing(view_of(mesh))) CHECK(s == doctest::Approx(edge * scale));
  }
}

TEST_CASE("local_spacing: a vertex pulled far away keeps its neighbours' spacing") {
  Mesh mesh = grid(6, 6);
  const VertexHandle spike(3 * 7 + 3);
  mesh.set_point(spike, {3, 3, 100});
  const auto spacing = local_spacing(view_of(mesh));
  for (const double s : spacing) {
    CHECK(s >= 1);
    CHECK(s <= std::sqrt(2.0) + 1e-12);
  }
}

TEST_CASE("local_spacing: isolated and deleted vertices have none") {
  Mesh mesh = grid(2, 2);
  mesh.add_vertex({9, 9, 9});
  mesh.delete_vertex(VertexHandle(0), false);
  const auto spacing = local_spacing(view_of(mesh));
  CHECK(spacing[0] == 0);
  CHECK(spacing[9] == 0);
  CHECK(spacing[4] > 0);
}
