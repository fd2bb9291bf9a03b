// The main job: points measured on a CAD model become a mesh.

#include <iostream>
#include <tri/libtri/example_parts.hpp>
#include <tri/libtri/model/cad_model.hpp>
#include <tri/libtri/sampling/virtual_measurement.hpp>
#include <tri/libtri/triangulation/triangulate.hpp>

#include "require.hpp"

int main() {
  tri::Context context;
  const tri::Shape part = tri::example_part("sphere-cap");
  const tri::CadModel model = tri::make_cad_model(part);
  const tri::VirtualMeasurement measured = tri::measure(part, {.points = 500, .seed = 3}, context);
  const tri::TriangulateResult result = tri::triangulate(model, measured.points, {}, context);
  REQUIRE(model.faces.size() == 1);
  REQUIRE(result.outliers.empty());
  REQUIRE(result.mesh.n_vertices() + result.duplicates.size() == 500);
  REQUIRE(result.checks.mesh.euler == 1);
  std::cout << "libtri: " << result.mesh.n_faces() << " triangles through 500 points\n";
  return 0;
}
