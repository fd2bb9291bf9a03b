#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "meshops/error.hpp"
#include "meshops/operators/smooth.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

constexpr SmoothMethod methods[] = {SmoothMethod::laplace, SmoothMethod::taubin, SmoothMethod::cotangent};

Report run_smooth(Mesh& mesh, const SmoothOptions& options = {}) {
  Context context;
  const Report report = smooth(view_of(mesh), options, context);
  CHECK_VALID_MESH(mesh);
  return report;
}

/// Moves each vertex along `normal(p)` by Gaussian noise; boundary vertices too if asked for.
void add_noise(Mesh& mesh, double sigma, const std::function<Vec3(const Vec3&)>& normal, bool boundary = true) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, sigma);
  for (const VertexHandle v : mesh.vertices()) {
    const double by = noise(random);
    if (boundary || !mesh.is_boundary(v)) mesh.point(v) += by * normal(mesh.point(v));
  }
}

double rms(const Mesh& mesh, const std::function<double(const Vec3&)>& error,
           const std::function<bool(VertexHandle)>& counts) {
  double sum = 0;
  int n = 0;
  for (const VertexHandle v : mesh.vertices()) {
    if (!counts(v)) continue;
    sum += error(mesh.point(v)) * error(mesh.point(v));
    ++n;
  }
  return std::sqrt(sum / n);
}

/// The unit sphere: an icosahedron, each triangle split into `n` x `n` and laid onto the sphere.
Mesh round_sphere(int n) {
  const Mesh coarse = icosahedron();
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  for (const FaceHandle f : coarse.faces()) {
    std::vector<Vec3> p;
    for (const VertexHandle v : coarse.fv_range(f)) p.push_back(coarse.point(v));
    const auto vertex = [&](int i, int j) {
      const Vec3 q = (p[0] * (n - i - j) + p[1] * i + p[2] * j).normalized();
      for (std::size_t k = 0; k < points.size(); ++k)
        if ((points[k] - q).norm() < 1e-9) return static_cast<int>(k);
      points.push_back(q);
      return static_cast<int>(points.size()) - 1;
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
        if (i + j + 1 < n) triangles.push_back({vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
      }
  }
  return make_mesh(points, triangles);
}

double mean_edge(const Mesh& mesh) {
  double sum = 0;
  for (const EdgeHandle e : mesh.edges()) sum += mesh.calc_edge_length(e);
  return sum / static_cast<double>(mesh.n_edges());
}

/// The surface of a box of cells, each face a grid; faces look outward.
Mesh grid_box(int n) {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  const auto vertex = [&](Vec3 p) {
    const auto it = std::ranges::find(points, p);
    if (it != points.end()) return static_cast<int>(it - points.begin());
    points.push_back(p);
    return static_cast<int>(points.size()) - 1;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto at = [&](int a, int b) {
            Vec3 p;
            p[axis] = side;
            p[(axis + 1) % 3] = a;
            p[(axis + 2) % 3] = b;
            return vertex(p);
          };
          std::array<int, 4> q{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
          if (side == 0) std::swap(q[1], q[3]);
          triangles.push_back({q[0], q[1], q[2]});
          triangles.push_back({q[0], q[2], q[3]});
        }
  return make_mesh(points, triangles);
}

}  // namespace

TEST_CASE("smooth: noise on a plane falls to a fifth (taubin: two fifths), away from the rim that stays") {
  for (const SmoothMethod method : methods) {
    Mesh mesh = grid(40, 40);
    add_noise(
        mesh, 0.1, [](const Vec3&) { return Vec3(0, 0, 1); }, false);
    const auto inside = [&](VertexHandle v) { return !mesh.is_boundary(v); };
    const auto error = [](const Vec3& p) { return p[2]; };
    const double before = rms(mesh, error, inside);
    const Mesh original = mesh;
    const Report report = run_smooth(mesh, {.method = method});
    CHECK(rms(mesh, error, inside) < (method == SmoothMethod::taubin ? 0.4 : 0.2) * before);
    CHECK(report.vertices_moved == 39 * 39);
    CHECK(report.skipped.at("on the boundary") == 4 * 40 - 4);
    CHECK(report.skipped.at("at a corner") == 4);
    CHECK(report.figures.count("volume before") == 0);
    double sum = 0, largest = 0;
    for (const VertexHandle v : mesh.vertices()) {
      const double moved = (mesh.point(v) - original.point(v)).norm();
      sum += moved;
      largest = std::max(largest, moved);
      if (mesh.is_boundary(v)) CHECK(moved == 0);
    }
    CHECK(report.figures.at("mean distance") == doctest::Approx(sum / (39 * 39)));
    CHECK(report.figures.at("largest distance") == largest);
  }
}

TEST_CASE("smooth: noise on a sphere falls, and taubin keeps its volume to a thousandth") {
  const Mesh clean = round_sphere(16);
  const double h = mean_edge(clean);
  for (const SmoothMethod method : methods) {
    Mesh mesh = clean;
    add_noise(mesh, 0.1 * h, [](const Vec3& p) { return p.normalized(); });
    const double volume = mesh_volume(view_of(mesh));
    const Report report = run_smooth(mesh, {.method = method});
    CHECK(report.figures.at("volume before") == doctest::Approx(volume));
    CHECK(report.figures.at("volume after") == doctest::Approx(mesh_volume(view_of(mesh))));
    // Shrinking is judged by the volume; here by the distance from the mean sphere.
    double mean = 0;
    for (const VertexHandle v : mesh.vertices()) mean += mesh.point(v).norm() / static_cast<double>(mesh.n_vertices());
    const double left = rms(
        mesh, [&](const Vec3& p) { return p.norm() - mean; }, [](VertexHandle) { return true; });
    CHECK(left < (method == SmoothMethod::taubin ? 0.45 : 0.3) * 0.1 * h);
    const double shrinkage = std::abs(mesh_volume(view_of(mesh)) / volume - 1);
    if (method == SmoothMethod::taubin)
      CHECK(shrinkage < 0.003);
    else
      CHECK(shrinkage < 0.06);
  }
}

TEST_CASE(
    "smooth: on a cylinder of uneven spacing the cotangent flow moves vertices along the normal, laplace does not") {
  // Rings whose distance grows from 0.05 to 0.4; uniform weights pull towards the narrow rings.
  PatchShape shape = tube(40, 24, 2, 0, 1);
  shape.point = [](int i, int j) {
    const double angle = 2 * pi * i / 40;
    return Vec3(2 * std::cos(angle), 2 * std::sin(angle), 0.05 * j + 0.0075 * j * j);
  };
  const auto drift = [&](SmoothMethod method) {
    Mesh mesh = shape.mesh();
    run_smooth(mesh, {.method = method});
    const Mesh before = shape.mesh();
    double sum = 0;
    for (const VertexHandle v : mesh.vertices()) sum += std::abs((mesh.point(v) - before.point(v))[2]);
    return sum / static_cast<double>(mesh.n_vertices());
  };
  CHECK(drift(SmoothMethod::cotangent) < 0.2 * drift(SmoothMethod::laplace));

  Mesh noisy = shape.mesh();
  add_noise(
      noisy, 0.02, [](const Vec3& p) { return Vec3(p[0], p[1], 0).normalized(); }, false);
  const auto error = [](const Vec3& p) { return std::hypot(p[0], p[1]) - 2; };
  const auto inside = [&](VertexHandle v) { return !noisy.is_boundary(v); };
  const double before = rms(noisy, error, inside);
  run_smooth(noisy, {.iterations = 5});
  CHECK(rms(noisy, error, inside) < 0.6 * before);
}

TEST_CASE("smooth: creases and corners of a box stay bit for bit, and its noisy faces become flat") {
  for (const SmoothMethod method : methods) {
    Mesh mesh = grid_box(8);
    const Mesh exact = mesh;
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 0.05);
    const auto extremes = [&](VertexHandle v) {
      int count = 0;
      for (int k = 0; k < 3; ++k) count += exact.point(v)[k] == 0 || exact.point(v)[k] == 8;
      return count;
    };
    double before = 0, after = 0;
    const auto off = [&](VertexHandle v) {
      for (int k = 0; k < 3; ++k)
        if (exact.point(v)[k] == 0 || exact.point(v)[k] == 8) return std::abs(mesh.point(v)[k] - exact.point(v)[k]);
      return 0.0;
    };
    for (const VertexHandle v : mesh.vertices()) {
      if (extremes(v) != 1) continue;
      for (int k = 0; k < 3; ++k)
        if (exact.point(v)[k] == 0 || exact.point(v)[k] == 8) mesh.point(v)[k] += noise(random);
      before += off(v);
    }
    const Report report = run_smooth(mesh, {.method = method});
    for (const VertexHandle v : mesh.vertices()) {
      if (extremes(v) >= 2)
        CHECK(mesh.point(v) == exact.point(v));
      else
        after += off(v);
    }
    CHECK(after < (method == SmoothMethod::taubin ? 0.45 : 0.25) * before);
    CHECK(report.skipped.at("at a corner") == 8);
    CHECK(report.skipped.at("on a crease") == 12 * 7);
  }
}

TEST_CASE("smooth: along creases, straight edges stay straight, corners stay, and vertices are spaced evenly") {
  for (const SmoothMethod method : methods) {
    Mesh mesh = grid_box(8);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> shift(-0.3, 0.3);
    const auto on_edge = [](const Vec3& p) {
      int fixed = 0;
      for (int k = 0; k < 3; ++k) fixed += p[k] == 0 || p[k] == 8;
      return fixed;
    };
    for (const VertexHandle v : mesh.vertices()) {
      if (on_edge(mesh.point(v)) != 2) continue;
      for (int k = 0; k < 3; ++k)
        if (mesh.point(v)[k] != 0 && mesh.point(v)[k] != 8) mesh.point(v)[k] += shift(random);
    }
    const Mesh start = mesh;
    run_smooth(mesh, {.method = method, .creases = LineRule::along});
    for (const VertexHandle v : mesh.vertices()) {
      CHECK(on_edge(mesh.point(v)) == on_edge(start.point(v)));
      if (on_edge(start.point(v)) == 3) CHECK(mesh.point(v) == start.point(v));
    }
    CHECK(mesh_volume(view_of(mesh)) == doctest::Approx(512).epsilon(1e-12));
  }
  Mesh uneven = grid_box(8);
  for (const VertexHandle v : uneven.vertices())
    if (uneven.point(v) == Vec3(4, 0, 0)) uneven.point(v)[0] = 4.6;
  run_smooth(uneven, {.method = SmoothMethod::laplace, .iterations = 200, .creases = LineRule::along});
  for (const VertexHandle v : uneven.vertices())
    if (uneven.point(v)[1] == 0 && uneven.point(v)[2] == 0)
      CHECK(uneven.point(v)[0] == doctest::Approx(std::round(uneven.point(v)[0])).epsilon(1e-3));
}

TEST_CASE("smooth: along the boundary, a noisy rim is smoothed; else it stays bit for bit") {
  for (const SmoothMethod method : methods) {
    Mesh mesh = tube(60, 10, 5, 0, 5).mesh();
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, 0.05);
    for (const VertexHandle v : mesh.vertices())
      if (mesh.is_boundary(v)) mesh.point(v)[2] += noise(random);
    const auto off = [](const Vec3& p) { return std::min(std::abs(p[2]), std::abs(p[2] - 5)); };
    Mesh fixed = mesh, along = mesh;
    const auto rim = [&](VertexHandle v) { return mesh.is_boundary(v); };
    const double before = rms(mesh, off, rim);
    run_smooth(fixed, {.method = method});
    for (const VertexHandle v : mesh.vertices())
      if (rim(v)) CHECK(fixed.point(v) == mesh.point(v));
    run_smooth(along, {.method = method, .boundary = LineRule::along});
    CHECK(rms(along, off, rim) < 0.6 * before);
  }
}

TEST_CASE("smooth: a coordinate that all points share is kept bit for bit") {
  for (const SmoothMethod method : methods) {
    Mesh mesh = grid(12, 9);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> shift(-0.3, 0.3);
    for (const VertexHandle v : mesh.vertices()) {
      const double x = shift(random), y = shift(random);
      mesh.point(v) += Vec3(x, y, 0);
      mesh.point(v)[2] = 0.1;
    }
    const Report report = run_smooth(mesh, {.method = method, .boundary = LineRule::along});
    CHECK(report.vertices_moved > 0);
    for (const VertexHandle v : mesh.vertices()) CHECK(mesh.point(v)[2] == 0.1);
  }
}

TEST_CASE("smooth: max-distance bounds how far a vertex ends from its start") {
  for (const SmoothMethod method : methods) {
    Mesh mesh = grid(20, 20);
    add_noise(mesh, 0.1, [](const Vec3&) { return Vec3(0, 0, 1); });
    const Mesh start = mesh;
    const Report report = run_smooth(mesh, {.method = method, .max_distance = 0.05});
    int held = 0;
    for (const VertexHandle v : mesh.vertices()) {
      const double moved = (mesh.point(v) - start.point(v)).norm();
      CHECK(moved <= 0.05 * (1 + 1e-12));
      held += moved > 0.05 * (1 - 1e-9);
    }
    CHECK(held > 50);
    CHECK(report.figures.at("held by max-distance") == held);
    CHECK(report.figures.at("largest distance") <= 0.05 * (1 + 1e-12));
  }
}

TEST_CASE("smooth: no triangle is folded over, though the mean of the neighbours lies outside") {
  // An L with all its corners around one vertex, whose mean is in the notch.
  const std::vector<Vec3> points{{0, 0, 0}, {4, 0, 0}, {4, 1, 0}, {1, 1, 0}, {1, 4, 0}, {0, 4, 0}, {0.8, 0.8, 0}};
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i < 6; ++i) triangles.push_back({i, (i + 1) % 6, 6});
  for (const SmoothMethod method : methods) {
    Mesh mesh = make_mesh(points, triangles);
    const Report report = run_smooth(mesh, {.method = method, .iterations = 40});
    if (method == SmoothMethod::laplace) CHECK(report.figures.at("held back from folding") == 1);
    CHECK(report.vertices_moved == 1);
    for (const FaceHandle f : mesh.faces()) CHECK(mesh.calc_face_normal(f)[2] > 0);
  }
  // Folds that were there may go.
  Mesh folded = grid(8, 8);
  folded.point(VertexHandle(40)) += Vec3(1.3, 0.2, 0);
  run_smooth(folded);
  for (const FaceHandle f : folded.faces()) CHECK(folded.calc_face_normal(f)[2] > 0);
}

TEST_CASE("smooth: no NaN on triangles without area, and nothing leaves the hull") {
  for (const SmoothMethod method : methods) {
    CAPTURE(static_cast<int>(method));
    Mesh mesh = bumpy_grid(12, 12);
    std::mt19937 random(9);
    for (int i = 0; i < 40; ++i) {  // needles, caps, and points in one place
      const HalfedgeHandle h(static_cast<int>(random() % mesh.n_halfedges()));
      const Vec3 a = mesh.point(mesh.from_vertex_handle(h)), b = mesh.point(mesh.to_vertex_handle(h));
      const double share[] = {0, 1e-9, 0.5, 1};
      mesh.split(mesh.edge_handle(h), mesh.add_vertex(a + (b - a) * share[i % 4]));
    }
    for (const double strength : {0.01, 0.65, 100.0}) {
      if (strength > 1 && method != SmoothMethod::cotangent) continue;
      Mesh moved = mesh;
      run_smooth(
          moved,
          {.method = method, .iterations = 30, .strength = strength, .feature_angle = pi, .boundary = LineRule::along});
      for (const VertexHandle v : moved.vertices())
        for (int k = 0; k < 3; ++k) {
          CHECK(std::isfinite(moved.point(v)[k]));
          CHECK(moved.point(v)[k] > (method == SmoothMethod::taubin ? -2 : -0.31));
          CHECK(moved.point(v)[k] < (method == SmoothMethod::taubin ? 14 : 12.31));
        }
    }
  }
}

TEST_CASE("smooth: a point that is not finite stays and pulls no neighbour") {
  for (const SmoothMethod method : methods) {
    Mesh mesh = bumpy_grid(8, 8);
    mesh.point(VertexHandle(40))[1] = std::nan("");
    mesh.point(VertexHandle(20))[2] = std::numeric_limits<double>::infinity();
    const Report report = run_smooth(mesh, {.method = method, .feature_angle = pi});
    CHECK(report.skipped.at("not finite") == 2);
    CHECK(report.vertices_moved == 7 * 7 - 2);
    for (const VertexHandle v : mesh.vertices()) {
      if (v.idx() == 40 || v.idx() == 20) continue;
      for (int k = 0; k < 3; ++k) CHECK(std::isfinite(mesh.point(v)[k]));
    }
  }
}

TEST_CASE("smooth: a note where creases hold much of the mesh, and a larger angle lets go") {
  Mesh mesh = round_sphere(10);
  add_noise(mesh, 0.4 * mean_edge(mesh), [](const Vec3& p) { return p.normalized(); });
  Mesh again = mesh;
  const Report held = run_smooth(mesh, {.feature_angle = 0.2}), free = run_smooth(again, {.feature_angle = pi});
  CHECK(held.notes.size() == 1);
  CHECK(held.skipped.at("on a crease") + held.skipped.at("at a corner") + held.vertices_moved == mesh.n_vertices());
  CHECK(free.notes.empty());
  CHECK(free.vertices_moved == mesh.n_vertices());
}

TEST_CASE("smooth: a strength outside of the method's range is refused, the mesh untouched") {
  Mesh mesh = bumpy_grid(5, 5);
  const Snapshot before = snapshot(view_of(mesh));
  Context context;
  CHECK_THROWS_AS(smooth(view_of(mesh), {.method = SmoothMethod::laplace, .strength = 1.1}, context), InvalidInput);
  CHECK_THROWS_AS(smooth(view_of(mesh), {.method = SmoothMethod::taubin, .strength = 0.7}, context), InvalidInput);
  CHECK(snapshot(view_of(mesh)) == before);
}

TEST_CASE("smooth: each method and rule gives the same on any number of threads, and cancelled it changes nothing") {
  for (const SmoothMethod method : methods) {
    Mesh mesh = bumpy_grid(90, 80);
    const SmoothOptions options{
        .method = method, .iterations = 4, .creases = LineRule::along, .boundary = LineRule::along};
    Mesh one = mesh;
    Context single;
    single.threads = 1;
    smooth(view_of(one), options, single);
    Mesh many = mesh;
    run_smooth(many, options);
    CHECK(snapshot(view_of(one)) == snapshot(view_of(many)));

    const Snapshot before = snapshot(view_of(mesh));
    for (const int stop : {1, 10, 25}) {
      Context context;
      context.threads = 1;
      std::atomic<int> seen = 0;
      context.on_checkpoint = [&] {
        if (++seen == stop) context.cancel();
      };
      CHECK_THROWS_AS(smooth(view_of(mesh), options, context), Cancelled);
      CHECK(snapshot(view_of(mesh)) == before);
    }
  }
}
