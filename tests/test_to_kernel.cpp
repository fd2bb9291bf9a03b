#include <doctest/doctest.h>

#include <vector>

#include "mesh_check.hpp"
#include "meshops/build_mesh.hpp"
#include "meshops/to_kernel.hpp"
#include "meshops/to_soup.hpp"

using namespace tri;
using namespace tri::test;

namespace {

struct FloatTraits : OpenMesh::DefaultTraits {
  using Color = OpenMesh::Vec4f;
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge | OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
  VertexTraits { int tag = 7; };
};
using FloatMesh = OpenMesh::TriMesh_ArrayKernelT<FloatTraits>;

Soup rich_soup() {
  Mesh mesh = bumpy_grid(3, 2);
  Soup soup = to_soup(view_of(mesh));
  for (std::size_t i = 0; i < soup.points.size(); ++i) {
    soup.vertex_colors.push_back({static_cast<std::uint8_t>(i), 255, 0});
    soup.vertex_normals.push_back({0, 0.6, 0.8});
    soup.vertex_scalars["height"].push_back(static_cast<double>(i) / 3);
  }
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    soup.face_scalars["group"].push_back(static_cast<double>(i % 2));
  soup.face_labels["group"] = {"lid", "base"};
  for (std::size_t i = 0; i < 3 * soup.triangles.size(); ++i)
    soup.corner_scalars["s"].push_back(static_cast<double>(i));
  return soup;
}

}  // namespace

TEST_CASE("to_kernel: links, positions and every attribute come along, and go back into the same soup") {
  const Soup soup = rich_soup();
  Context context;
  const BuiltMesh built = build_mesh(soup, context);
  FloatMesh mesh;
  to_kernel(built.mesh, mesh);
  REQUIRE(mesh_problems(mesh).empty());
  for (const VertexHandle v : mesh.vertices()) {
    CHECK(mesh.data(v).tag == 7);
    for (unsigned k = 0; k < 3; ++k) CHECK(mesh.point(v)[k] == static_cast<float>(built.mesh.point(v)[k]));
    CHECK(mesh.color(v)[0] == doctest::Approx(v.idx() / 255.0));
  }
  MeshLease lease(mesh);
  const Soup back = to_soup(lease.view());
  CHECK(back.triangles == soup.triangles);
  CHECK(back.vertex_scalars == soup.vertex_scalars);
  CHECK(back.face_scalars == soup.face_scalars);
  CHECK(back.face_labels == soup.face_labels);
  CHECK(back.corner_scalars == soup.corner_scalars);
  CHECK(back.vertex_colors == soup.vertex_colors);
  REQUIRE(back.vertex_normals.size() == soup.points.size());
  CHECK(back.vertex_normals[3][1] == doctest::Approx(0.6));
}

TEST_CASE("to_kernel: what only the target has stays with default values, what both have is the source's") {
  Context context;
  const BuiltMesh built = build_mesh(rich_soup(), context);
  FloatMesh mesh;
  mesh.add_vertex({9, 9, 9});
  OpenMesh::VPropHandleT<int> own;
  mesh.add_property(own, "editor:own");
  mesh.property(own, VertexHandle(0)) = 5;
  OpenMesh::VPropHandleT<float> height;
  mesh.add_property(height, "v:height");
  to_kernel(built.mesh, mesh);
  CHECK(mesh.n_vertices() == built.mesh.n_vertices());
  for (const VertexHandle v : mesh.vertices()) CHECK(mesh.property(own, v) == 0);
  OpenMesh::VPropHandleT<double> now;
  REQUIRE(mesh.get_property_handle(now, "v:height"));
  CHECK(mesh.property(now, VertexHandle(2)) == 2.0 / 3);
}

TEST_CASE("to_kernel: deleted elements stay deleted") {
  Mesh source = grid(3, 3);
  source.delete_face(FaceHandle(4), false);
  FloatMesh mesh;
  to_kernel(source, mesh);
  for (const FaceHandle f : source.all_faces()) CHECK(mesh.status(f).deleted() == source.status(f).deleted());
}
