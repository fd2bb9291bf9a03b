// Files in and out.

#include <cstdio>
#include <iostream>
#include <string>
#include <tri/io/mesh_file.hpp>
#include <tri/io/points_file.hpp>
#include <tri/meshops/build_mesh.hpp>
#include <tri/meshops/error.hpp>

#include "require.hpp"

int main() {
  tri::Context context;
  tri::Soup tetrahedron;
  tetrahedron.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0.1}};
  tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  for (const std::string ending : {"stl", "ply", "obj", "off"}) {
    const std::string path = "consumer-mesh." + ending;
    tri::write_mesh(path, tetrahedron, {.ascii = true}, context);
    tri::MeshFileInfo info;
    const tri::Soup back = tri::read_mesh(path, context, &info);
    REQUIRE(back.points.size() == 4);
    REQUIRE(back.triangles.size() == 4);
    const tri::BuiltMesh built = tri::build_mesh(back, context);
    REQUIRE(built.mesh.n_edges() == 6);
    REQUIRE(built.report.unchanged());
    std::remove(path.c_str());
  }

  tri::PointSet points;
  points.points = tetrahedron.points;
  tri::write_points("consumer-points.csv", points, context);
  REQUIRE(tri::read_points("consumer-points.csv", context).points[3] == tri::Vec3(0, 0, 0.1));
  std::remove("consumer-points.csv");

  bool located = false;
  try {
    tri::parse_mesh("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nonsense\n", "broken.stl", context);
  } catch (const tri::IoError& error) {
    located = error.unit() == tri::IoError::Unit::line && error.position() == 4;
  }
  REQUIRE(located);
  std::cout << "io: four mesh formats, points\n";
  return 0;
}
