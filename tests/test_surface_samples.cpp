// clang-format off: OpenMesh does not compile after OpenCASCADE
#include "libtri/alignment/surface_samples.hpp"
// clang-format on

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "libtri/alignment/sample_field.hpp"
#include "libtri/example_parts.hpp"
#include "libtri/registration.hpp"
#include "meshops/random_stream.hpp"
#include "meshops/search/nearest_points.hpp"

using namespace tri;

TEST_CASE("sample_surface: points lie on the trimmed faces, in proportion to their areas, with their normals") {
  for (const char* name : {"bracket", "elbow", "sphere-cap"}) {
    const CadModel model = make_cad_model(example_part(name));
    const SurfaceSamples samples = sample_surface(model, 5000, 1, Context());
    CHECK(samples.points.size() >= 4950);
    CHECK(samples.points.size() <= 5000);
    Context context;
    const std::vector<Foot> feet = Registration(model).register_points(samples.points, context);
    double area = 0;
    std::vector<double> count(model.faces.size(), 0);
    for (std::size_t i = 0; i < feet.size(); ++i) {
      CHECK(std::abs(feet[i].deviation) < 1e-7 * model.diagonal);
      count[static_cast<std::size_t>(samples.faces[i])] += 1;
      const Vec3 normal(feet[i].normal[0], feet[i].normal[1], feet[i].normal[2]);
      if (feet[i].face == samples.faces[i]) CHECK((samples.normals[i] | normal) > 0.999);
    }
    for (const CadFace& face : model.faces) area += face.area;
    for (std::size_t f = 0; f < count.size(); ++f)
      CHECK(std::abs(count[f] - 5000 * model.faces[f].area / area) <= 1.001);
  }
}

TEST_CASE("sample_surface: the middle of the samples is the middle of the area") {
  // A cap of a sphere: the centroid of its area lies half way up its height [Archimedes].
  const CadModel model = make_cad_model(example_part("sphere-cap"));
  const SurfaceSamples samples = sample_surface(model, 20000, 2, Context());
  Vec3 low = samples.points[0], high = low, mean(0, 0, 0);
  for (const Vec3& p : samples.points) {
    low.minimize(p);
    high.maximize(p);
    mean += p / static_cast<double>(samples.points.size());
  }
  // The axis is the one along which the cap is lowest.
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (high[k] - low[k] < high[axis] - low[axis]) axis = k;
  CHECK(mean[axis] == doctest::Approx(0.5 * (low[axis] + high[axis])).epsilon(0.01));
}

TEST_CASE("SampleField: what a cell names is nearly the nearest sample") {
  const CadModel model = make_cad_model(example_part("bracket"));
  const SurfaceSamples samples = sample_surface(model, 5000, 1, Context());
  const SampleField field(samples, 0.1 * model.diagonal, 100000);
  const NearestPoints tree(samples.points);
  RandomStream random(3);
  std::vector<NearestPoints::Neighbor> near;
  for (int i = 0; i < 2000; ++i) {
    Vec3 p;
    for (int k = 0; k < 3; ++k)
      p[k] = random.uniform(model.box_min[k] - 0.05 * model.diagonal, model.box_max[k] + 0.05 * model.diagonal);
    float relative[3];
    for (int k = 0; k < 3; ++k) relative[k] = static_cast<float>(p[k] - field.centre()[k]);
    const SampleField::Sample& s = field.near(relative);
    const Vec3 found = Vec3(s.point[0], s.point[1], s.point[2]) + field.centre();
    tree.nearest(p, 1, near);
    // From the centre of the cell to the point it is at most half a diagonal of the cell, twice; the spread adds
    // little.
    CHECK((found - p).norm() <= std::sqrt(near[0].squared_distance) + 2 * field.cell());
  }
}
