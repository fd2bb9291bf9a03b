#include <doctest/doctest.h>

#include <OpenMesh/Core/Geometry/EigenVectorT.hh>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "meshops/build_mesh.hpp"
#include "meshops/to_soup.hpp"

using namespace tri;

namespace {

/// Two triangles and, between their vertices, one that is deleted with the face that had it.
Mesh two_triangles_and_a_deleted_one() {
  Soup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {9, 9, 9}, {1, 1, 0}, {0, 1, 0}};
  soup.triangles = {{0, 1, 3}, {1, 2, 3}, {0, 3, 4}};
  Context context;
  Mesh mesh = build_mesh(soup, context).mesh;
  mesh.delete_face(FaceHandle(1), true);
  return mesh;
}

template <class T, class Mesh, class Value>
void add(Mesh& mesh, const std::string& name, const Value& value) {
  OpenMesh::VPropHandleT<T> handle;
  mesh.add_property(handle, name);
  for (int i = 0; i < static_cast<int>(mesh.n_vertices()); ++i) mesh.property(handle, VertexHandle(i)) = value(i);
}

template <class T, class Mesh, class Value>
void add_to_faces(Mesh& mesh, const std::string& name, const Value& value) {
  OpenMesh::FPropHandleT<T> handle;
  mesh.add_property(handle, name);
  for (int i = 0; i < static_cast<int>(mesh.n_faces()); ++i) mesh.property(handle, FaceHandle(i)) = value(i);
}

using Values = std::vector<double>;

}  // namespace

TEST_CASE("to_soup: carries every type of number, without deleted elements") {
  Mesh mesh = two_triangles_and_a_deleted_one();
  add<double>(mesh, "v:double", [](int i) { return i + 0.5; });
  add<float>(mesh, "v:float", [](int i) { return i + 0.25f; });
  add<bool>(mesh, "v:bool", [](int i) { return i % 2 == 1; });
  add<short>(mesh, "v:short", [](int i) { return static_cast<short>(-i); });
  add<unsigned char>(mesh, "v:byte", [](int i) { return static_cast<unsigned char>(250 + i); });
  add<std::int64_t>(mesh, "v:long", [](int i) { return std::int64_t{1} << (40 + i); });
  add_to_faces<unsigned>(mesh, "f:unsigned", [](int i) { return 4000000000u + static_cast<unsigned>(i); });
  add<std::string>(mesh, "v:text", [](int) { return "no number"; });
  add<int>(mesh, "no prefix", [](int i) { return i; });
  const Soup soup = to_soup(view_of(mesh));
  CHECK(soup.points.size() == 4);
  CHECK(soup.vertex_scalars.at("double") == Values{0.5, 1.5, 3.5, 4.5});
  CHECK(soup.vertex_scalars.at("float") == Values{0.25, 1.25, 3.25, 4.25});
  CHECK(soup.vertex_scalars.at("bool") == Values{0, 1, 1, 0});
  CHECK(soup.vertex_scalars.at("short") == Values{0, -1, -3, -4});
  CHECK(soup.vertex_scalars.at("byte") == Values{250, 251, 253, 254});
  CHECK(soup.vertex_scalars.at("long") == Values{0x1p40, 0x1p41, 0x1p43, 0x1p44});
  CHECK(soup.face_scalars.at("unsigned") == Values{4e9, 4e9 + 2});
  CHECK(soup.vertex_scalars.size() == 6);
  CHECK(soup.face_scalars.size() == 1);
}

TEST_CASE("to_soup: vectors become a scalar for each of their numbers") {
  Mesh mesh = two_triangles_and_a_deleted_one();
  add<Vec3>(mesh, "v:force", [](int i) { return Vec3(i, 10 * i, 100 * i); });
  add<Eigen::Vector2f>(mesh, "v:slope", [](int i) { return Eigen::Vector2f(0.5f, static_cast<float>(-i)); });
  add<Vec2>(mesh, "v:uv", [](int i) { return Vec2(i, 2 * i); });
  add_to_faces<OpenMesh::Vec4i>(mesh, "f:quad", [](int i) { return OpenMesh::Vec4i(i, 5, 6, 7); });
  mesh.request_vertex_texcoords2D();
  for (const VertexHandle v : mesh.all_vertices()) mesh.set_texcoord2D(v, {static_cast<float>(v.idx()), 0.5f});
  mesh.request_halfedge_texcoords2D();
  for (const HalfedgeHandle h : mesh.all_halfedges())
    mesh.set_texcoord2D(h, {static_cast<float>(mesh.to_vertex_handle(h).idx()), 0.25f});
  const Soup soup = to_soup(view_of(mesh));
  CHECK(soup.vertex_scalars.at("force_0") == Values{0, 1, 3, 4});
  CHECK(soup.vertex_scalars.at("force_2") == Values{0, 100, 300, 400});
  CHECK(soup.vertex_scalars.at("slope_1") == Values{0, -1, -3, -4});
  CHECK(soup.vertex_scalars.at("u") == Values{0, 1, 3, 4});
  CHECK(soup.vertex_scalars.at("v") == Values{0, 2, 6, 8});
  CHECK(soup.vertex_scalars.at("s") == Values{0, 1, 3, 4});
  CHECK(soup.vertex_scalars.at("t") == Values{0.5, 0.5, 0.5, 0.5});
  CHECK(soup.face_scalars.at("quad_0") == Values{0, 2});
  CHECK(soup.face_scalars.at("quad_3") == Values{7, 7});
  // Of each corner, that of its vertex.
  REQUIRE(soup.corner_scalars.at("s").size() == 6);
  const std::vector<int> old{0, 1, 3, 4};
  for (std::size_t t = 0; t < 2; ++t)
    for (std::size_t k = 0; k < 3; ++k) CHECK(soup.corner_scalars.at("s")[3 * t + k] == old[soup.triangles[t][k]]);
}

TEST_CASE("to_soup: colours of any type") {
  SUBCASE("bytes with alpha") {
    Mesh mesh = two_triangles_and_a_deleted_one();
    add<OpenMesh::Vec4uc>(mesh, "v:colors",
                          [](int i) { return OpenMesh::Vec4uc(static_cast<unsigned char>(i), 20, 30, 128); });
    const Soup soup = to_soup(view_of(mesh));
    REQUIRE(soup.vertex_colors.size() == 4);
    CHECK(soup.vertex_colors[2] == std::array<std::uint8_t, 3>{3, 20, 30});
    CHECK(soup.vertex_scalars.at("alpha") == Values{128, 128, 128, 128});
  }
  SUBCASE("floats in [0,1]") {
    Mesh mesh = two_triangles_and_a_deleted_one();
    add<OpenMesh::Vec3f>(mesh, "v:colors", [](int i) { return OpenMesh::Vec3f(0, 1, static_cast<float>(i) / 5); });
    add_to_faces<OpenMesh::Vec4f>(mesh, "f:colors", [](int) { return OpenMesh::Vec4f(1, 0, 0.2f, 1); });
    add_to_faces<int>(mesh, "f:group", [](int i) { return i; });
    const Soup soup = to_soup(view_of(mesh));
    REQUIRE(soup.vertex_colors.size() == 4);
    CHECK(soup.vertex_colors[2] == std::array<std::uint8_t, 3>{0, 255, 153});
    CHECK(soup.vertex_scalars.empty());
    CHECK(soup.face_scalars.at("blue") == Values{51, 51});
    CHECK(soup.face_scalars.size() == 4);  // opaque: no alpha
  }
  SUBCASE("what is out of range is carried as it is") {
    Mesh mesh = two_triangles_and_a_deleted_one();
    add<OpenMesh::Vec3f>(mesh, "v:colors", [](int i) { return OpenMesh::Vec3f(0, 1, static_cast<float>(i)); });
    const Soup soup = to_soup(view_of(mesh));
    CHECK(soup.vertex_colors.empty());
    CHECK(soup.vertex_scalars.at("colors_2") == Values{0, 1, 3, 4});
  }
}

TEST_CASE("to_soup: what a mesh was built from comes back") {
  Soup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  soup.triangles = {{0, 1, 2}, {2, 3, 0}};
  soup.vertex_scalars["heat"] = {1, 2, 3, std::numeric_limits<double>::infinity()};
  soup.vertex_scalars["cad_face"] = {1, 2, 3, 4};
  soup.vertex_normals.assign(4, {0, 0, 1});
  soup.vertex_colors.assign(4, {1, 2, 3});
  soup.face_scalars["group"] = {1, 0};
  soup.face_labels["group"] = {"a", "b"};
  soup.corner_scalars["s"] = {0, 1, 2, 3, 4, 5};
  Context context;
  Mesh mesh = build_mesh(soup, context).mesh;
  const Soup back = to_soup(view_of(mesh));
  CHECK(back.points == soup.points);
  CHECK(back.triangles == soup.triangles);
  CHECK(back.vertex_scalars == soup.vertex_scalars);
  CHECK(back.vertex_normals == soup.vertex_normals);
  CHECK(back.vertex_colors == soup.vertex_colors);
  CHECK(back.face_scalars == soup.face_scalars);
  CHECK(back.face_labels == soup.face_labels);
  CHECK(back.corner_scalars == soup.corner_scalars);
}
