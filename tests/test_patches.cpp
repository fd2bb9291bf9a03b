#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "libtri/example_parts.hpp"
#include "libtri/model/cad_model.hpp"
#include "libtri/model/cad_topology.hpp"
#include "libtri/model/shape_occt.hpp"
#include "libtri/sampling/virtual_measurement.hpp"
#include "libtri/triangulation/patches.hpp"
#include "measured_part.hpp"
#include "meshops/error.hpp"
#include "occt_parts.hpp"

using namespace tri;

namespace {

struct MeasuredPart {
  CadModel model;
  std::vector<Vec3> points;
  std::vector<Foot> feet;
};

// The truth of a virtual measurement stands in for the registration.
MeasuredPart measured_part(const Shape& shape, std::uint64_t n, SamplingPattern pattern = SamplingPattern::random,
                           double noise = 0.001) {
  Context context;
  MeasurementOptions options;
  options.points = n;
  options.pattern = pattern;
  options.noise = noise;
  const VirtualMeasurement m = measure(shape, options, context);
  MeasuredPart result{make_cad_model(shape), m.points, {}};
  result.feet = test::true_feet(result.model, m);
  return result;
}

// Everything that is owed of connectivity: linked both ways, one fan per vertex, no double edge; and its topology.
struct Counted {
  long components = 0, loops = 0, euler = 0;
  std::set<std::uint32_t> vertices;
};
Counted check_manifold(const PointMesh& mesh) {
  Counted counted;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> sides;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto from = mesh.triangles[t][(k + 1) % 3], to = mesh.triangles[t][(k + 2) % 3];
      REQUIRE(from != to);
      REQUIRE(sides.emplace(std::pair(from, to), t).second);
      counted.vertices.insert(from);
    }
  std::map<std::uint32_t, std::uint32_t> rim;
  std::size_t edges = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto from = mesh.triangles[t][(k + 1) % 3], to = mesh.triangles[t][(k + 2) % 3];
      const auto twin = sides.find({to, from});
      if (twin == sides.end()) {
        CHECK(mesh.neighbors[t][k] == -1);
        REQUIRE(rim.emplace(to, from).second);  // a vertex twice on the rim would be a bow-tie
        ++edges;
      } else {
        REQUIRE(mesh.neighbors[t][k] == static_cast<std::int32_t>(twin->second));
        edges += from < to;
      }
    }
  counted.euler =
      static_cast<long>(counted.vertices.size()) - static_cast<long>(edges) + static_cast<long>(mesh.triangles.size());
  while (!rim.empty()) {
    ++counted.loops;
    for (auto at = rim.begin(); at != rim.end();) {
      const auto next = at->second;
      rim.erase(at);
      at = rim.find(next);
    }
  }
  std::map<std::uint32_t, std::uint32_t> parent;
  for (const auto v : counted.vertices) parent[v] = v;
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& t : mesh.triangles)
    for (int k = 1; k < 3; ++k) parent[root(t[k])] = root(t[0]);
  for (const auto v : counted.vertices) counted.components += root(v) == v;
  return counted;
}

// Share of the area that faces against the model.
double turned_share(const MeasuredPart& m, const PointMesh& mesh) {
  double all = 0, turned = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 n = (m.points[t[1]] - m.points[t[0]]) % (m.points[t[2]] - m.points[t[0]]);
    Vec3 model(0, 0, 0);
    for (const auto v : t) model += Vec3(m.feet[v].normal[0], m.feet[v].normal[1], m.feet[v].normal[2]);
    all += n.norm();
    if ((n | model) < 0) turned += n.norm();
  }
  return turned / all;
}

void check_complete(const MeasuredPart& m, const PatchesOptions& options = {}) {
  Context context;
  const PatchConnection result = connect_by_patches(m.model, m.feet, m.points, options, context);
  CHECK(result.failed_faces.empty());
  CHECK(result.open_stars == 0);
  CHECK(result.duplicates.empty());
  const Counted mesh = check_manifold(result.mesh);
  const CadTopology cad = cad_topology(m.model);
  CHECK(mesh.components == cad.components);
  CHECK(mesh.loops == cad.loops);
  CHECK(mesh.euler == cad.euler);
  const auto registered = std::count_if(m.feet.begin(), m.feet.end(), [](const Foot& f) { return f.face >= 0; });
  CHECK(static_cast<long>(mesh.vertices.size()) == registered);
  CHECK(turned_share(m, result.mesh) < 0.02);
}

}  // namespace

TEST_CASE(
    "connect_by_patches: solids of planes, cylinders, cones, spheres and tori keep their topology and every point") {
  for (const auto& solid : test::known_solids()) {
    for (const std::uint64_t n : {300, 3000}) {
      CAPTURE(solid.name);
      CAPTURE(n);
      const MeasuredPart m = measured_part(make_shape(solid.shape), n);
      CHECK(cad_topology(m.model).euler == solid.euler);
      check_complete(m);
    }
  }
}

TEST_CASE("connect_by_patches: every example part keeps its topology and every point") {
  for (const ExamplePart& part : example_parts()) {
    CAPTURE(part.name);
    const Shape shape = example_part(part.name);
    check_complete(measured_part(shape, 3400, SamplingPattern::random, 0.01));
    check_complete(measured_part(shape, 8000, SamplingPattern::scan, 0.01));
  }
}

TEST_CASE("connect_by_patches: a face without points leaves no hole") {
  MeasuredPart m = measured_part(make_shape(test::box_with_hole()), 2000);
  for (std::size_t f = 0; f < m.model.faces.size(); ++f) {
    CAPTURE(f);
    MeasuredPart without = m;
    for (Foot& foot : without.feet)
      if (foot.face == static_cast<int>(f)) foot.face = -1;
    Context context;
    const PatchConnection result = connect_by_patches(without.model, without.feet, without.points, {}, context);
    const Counted mesh = check_manifold(result.mesh);
    CHECK(mesh.components == 1);
    CHECK(mesh.loops == 0);
    CHECK(mesh.euler == 0);
  }
}

TEST_CASE("connect_by_patches: before stitching there is one patch per face and no triangle across an edge") {
  const MeasuredPart m = measured_part(make_shape(test::box_with_hole()), 3000);
  Context context;
  const PatchConnection result = connect_by_patches(m.model, m.feet, m.points, {.keep_patches = true}, context);
  const auto& patches = result.patches;
  REQUIRE_FALSE(patches.triangles.empty());
  CHECK(patches.triangles.size() < result.mesh.triangles.size());
  std::map<int, double> area;
  for (const auto& t : patches.triangles) {
    const int face = m.feet[t[0]].face;
    CHECK(m.feet[t[1]].face == face);
    CHECK(m.feet[t[2]].face == face);
    area[face] += 0.5 * ((m.feet[t[1]].point - m.feet[t[0]].point) % (m.feet[t[2]].point - m.feet[t[0]].point)).norm();
  }
  CHECK(area.size() == m.model.faces.size());
  // Chords of the hole's wall lie inside it; everything else is plane, and no patch reaches over its face's edges.
  for (const auto& [face, sum] : area) {
    CHECK(sum < m.model.faces[static_cast<std::size_t>(face)].area);
    CHECK(sum > 0.6 * m.model.faces[static_cast<std::size_t>(face)].area);
  }
}

TEST_CASE("connect_by_patches: points on the edges and corners themselves are vertices once") {
  MeasuredPart m = measured_part(make_shape(test::known_solids()[0].shape), 500);
  // On the edge between the first face and each neighbour, and at its corners, exactly.
  const CadFace& face = m.model.faces[0];
  std::vector<std::pair<Vec2, int>> extra;
  for (const TrimLoop& loop : face.loops)
    for (const Coedge& coedge : loop.coedges)
      for (const double s : {0.0, 0.25, 0.5})
        extra.emplace_back(coedge.polyline.front() * (1 - s) + coedge.polyline.back() * s, coedge.edge);
  for (const auto& [uv, edge] : extra) {
    Foot foot;
    foot.uv = uv;
    foot.face = 0;
    foot.edge = edge;
    foot.point = face.surface->point(uv[0], uv[1]);
    const SurfacePoint s = face.surface->evaluate(uv[0], uv[1]);
    const Vec3 n = (s.du % s.dv).normalized() * (face.reversed ? -1.0 : 1.0);
    for (int k = 0; k < 3; ++k) foot.normal[k] = static_cast<float>(n[k]);
    m.feet.push_back(foot);
    m.points.push_back(foot.point);
  }
  check_complete(m);
}

TEST_CASE("connect_by_patches: two points over one foot are both vertices, two at one position are one") {
  MeasuredPart m = measured_part(make_shape(test::known_solids()[0].shape), 400);
  Foot foot = m.feet[7];
  m.feet.push_back(foot);
  m.points.push_back(m.points[7] + Vec3(foot.normal[0], foot.normal[1], foot.normal[2]) * 0.01);
  check_complete(m);
  m.feet.push_back(foot);
  m.points.push_back(m.points[7]);
  Context context;
  const PatchConnection result = connect_by_patches(m.model, m.feet, m.points, {}, context);
  REQUIRE(result.duplicates.size() == 1);
  CHECK(result.duplicates[0] == std::array<std::uint32_t, 2>{401, 7});
  CHECK(check_manifold(result.mesh).vertices.size() == 401);
}

TEST_CASE("connect_by_patches: the same mesh for any number of threads") {
  const MeasuredPart m = measured_part(example_part("elbow"), 20000);
  Context context;
  context.threads = 1;
  const PatchConnection one = connect_by_patches(m.model, m.feet, m.points, {}, context);
  context.threads = 2;
  const PatchConnection two = connect_by_patches(m.model, m.feet, m.points, {}, context);
  CHECK(one.mesh.triangles == two.mesh.triangles);
  CHECK(one.mesh.neighbors == two.mesh.neighbors);
}

TEST_CASE("connect_by_patches: no point at all gives no triangle, and broken contracts are refused") {
  const MeasuredPart m = measured_part(make_shape(test::known_solids()[0].shape), 10);
  Context context;
  CHECK(connect_by_patches(m.model, {}, {}, {}, context).mesh.triangles.empty());
  CHECK_THROWS_AS(connect_by_patches(m.model, m.feet, {}, {}, context), InvalidInput);
  CHECK_THROWS_AS(connect_by_patches(m.model, m.feet, m.points, {.edge_reach = 0}, context), InvalidInput);
  context.cancel();
  CHECK_THROWS_AS(connect_by_patches(m.model, m.feet, m.points, {}, context), Cancelled);
}
