#include <doctest/doctest.h>

#include <numeric>
#include <string>
#include <vector>

#include "meshops/editing/attribute_seams.hpp"
#include "meshops/editing/label_property.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

int seams(Mesh& mesh) {
  const std::vector<std::uint8_t> s = attribute_seams(view_of(mesh));
  if (s.empty()) return 0;
  REQUIRE(s.size() == mesh.n_edges());
  for (const EdgeHandle e : mesh.edges()) {
    if (!s[static_cast<std::size_t>(e.idx())]) continue;
    CHECK_FALSE(mesh.is_boundary(e));
    CHECK(mesh.calc_edge_midpoint(e)[0] == 2);
  }
  return std::accumulate(s.begin(), s.end(), 0);
}

}  // namespace

TEST_CASE("attribute seams: lie where corner values or groups jump, not where they merely change") {
  Mesh mesh = grid(4, 3);
  CHECK(attribute_seams(view_of(mesh)).empty());
  const auto right = [&](FaceHandle f) { return mesh.calc_face_centroid(f)[0] > 2; };

  OpenMesh::HPropHandleT<OpenMesh::Vec2f> chart;
  OpenMesh::FPropHandleT<double> quality;
  mesh.add_property(chart, "h:texture");
  mesh.add_property(quality, "f:quality");
  for (const FaceHandle f : mesh.faces()) {
    mesh.property(quality, f) = f.idx();
    for (const HalfedgeHandle h : mesh.fh_range(f)) {
      const Vec3 p = mesh.point(mesh.to_vertex_handle(h));
      mesh.property(chart, h) = OpenMesh::Vec2f(static_cast<float>(p[0]), static_cast<float>(p[1]));
    }
  }
  CHECK(seams(mesh) == 0);
  for (const FaceHandle f : mesh.faces())
    for (const HalfedgeHandle h : mesh.fh_range(f))
      if (right(f)) mesh.property(chart, h)[1] += 5;
  CHECK(seams(mesh) == 3);
  mesh.remove_property(chart);

  OpenMesh::FPropHandleT<int> group;
  mesh.add_property(group, "f:group");
  for (const FaceHandle f : mesh.faces()) mesh.property(group, f) = right(f);
  CHECK(seams(mesh) == 3);
  mesh.remove_property(group);

  OpenMesh::FPropHandleT<double> material;
  OpenMesh::MPropHandleT<std::vector<std::string>> names;
  mesh.add_property(material, "f:paint");
  for (const FaceHandle f : mesh.faces()) mesh.property(material, f) = right(f);
  CHECK(seams(mesh) == 0);
  mesh.add_property(names, std::string(property::labels) + "paint");
  CHECK(seams(mesh) == 3);
}
