#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "meshops/crossings/triangle_pair.hpp"
#include "meshops/holes/boundary_loops.hpp"
#include "meshops/holes/filling_obstacles.hpp"
#include "meshops/holes/filling_projection.hpp"

using namespace tri;

using std::numbers::pi;

namespace {

struct Holed {
  Mesh mesh;
  std::vector<VertexHandle> ring;  ///< of the hole, as a filling runs
  std::vector<VertexTriple> filling;
};

/// A strip of `rows` rows of faces around a hole of `n` edges; `place` gives a vertex from the turns made along the rim
/// and the number of the row.
template <class Place>
void surround(Holed& h, int n, int rows, Place place) {
  std::vector<std::vector<VertexHandle>> at(static_cast<std::size_t>(rows) + 1);
  for (int r = 0; r <= rows; ++r)
    for (int i = 0; i < n; ++i)
      at[static_cast<std::size_t>(r)].push_back(h.mesh.add_vertex(place(static_cast<double>(i) / n, r)));
  for (std::size_t r = 0; r + 1 < at.size(); ++r)
    for (std::size_t i = 0; i < at[r].size(); ++i) {
      const std::size_t j = (i + 1) % at[r].size();
      h.mesh.add_face(at[r][i], at[r + 1][i], at[r + 1][j]);
      h.mesh.add_face(at[r][i], at[r + 1][j], at[r][j]);
    }
  h.ring = at[0];
}

/// Cuts random ears until nothing is left.
void fill_at_random(Holed& h, std::mt19937& random) {
  std::vector<VertexHandle> left = h.ring;
  while (left.size() >= 3) {
    const std::size_t i = random() % left.size(), n = left.size();
    h.filling.push_back({left[(i + n - 1) % n], left[i], left[(i + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

/// A fan around the ring's first vertex.
void fill_with_fan(Holed& h) {
  for (std::size_t i = 1; i + 1 < h.ring.size(); ++i) h.filling.push_back({h.ring[0], h.ring[i], h.ring[i + 1]});
}

OverlapTree::Box box_of(const Holed& h) {
  OverlapTree::Box box;
  for (const VertexHandle v : h.ring) box.grow(h.mesh.point(v));
  return box;
}

std::array<Vec3, 3> places(const Holed& h, const VertexTriple& t) {
  return {h.mesh.point(t[0]), h.mesh.point(t[1]), h.mesh.point(t[2])};
}

bool meet_in_space(const Holed& h, const VertexTriple& t, const VertexTriple& u) {
  const auto p = places(h, t), q = places(h, u);
  if (!triangle_has_area(p[0], p[1], p[2]) || !triangle_has_area(q[0], q[1], q[2])) return false;
  const auto names = [](const VertexTriple& x) {
    return std::array<std::uint32_t, 3>{static_cast<std::uint32_t>(x[0].idx()), static_cast<std::uint32_t>(x[1].idx()),
                                        static_cast<std::uint32_t>(x[2].idx())};
  };
  return triangles_meet(names(t), p, names(u), q);
}

VertexTriple corners_of_filling(const Holed& h, FaceHandle f) {
  VertexTriple t;
  std::size_t k = 0;
  for (const VertexHandle v : h.mesh.fv_ccw_range(f)) t[k++] = v;
  return t;
}

/// Compares each triangle that is not in doubt with all others. @return how many are not in doubt
std::size_t check_against_all_pairs(Holed& h) {
  const FillingProjection projection(view_of(h.mesh), h.ring, box_of(h));
  const std::vector<char> doubt = projection.in_doubt(h.filling);
  REQUIRE(doubt.size() == h.filling.size());
  std::size_t shown = 0, wrong = 0;
  for (std::size_t t = 0; t < h.filling.size(); ++t) {
    if (doubt[t]) continue;
    ++shown;
    for (std::size_t u = 0; u < h.filling.size(); ++u) wrong += u != t && meet_in_space(h, h.filling[t], h.filling[u]);
    for (const FaceHandle f : h.mesh.faces())
      wrong += projection.covers(f) && meet_in_space(h, h.filling[t], corners_of_filling(h, f));
  }
  CHECK(wrong == 0);
  return shown;
}

}  // namespace

TEST_CASE("FillingProjection: shows all of a filling that lies along its surface") {
  Holed h;
  surround(h, 40, 3, [](double t, int row) {
    const double r = 1 + 0.2 * row, a = 2 * pi * t;
    return Vec3(r * std::cos(a), 0.4 * r * std::sin(3 * a), -r * std::sin(a));  // not along an axis it could rely on
  });
  fill_with_fan(h);
  CHECK(check_against_all_pairs(h) == h.filling.size());
}

TEST_CASE("FillingProjection: what it shows of random fillings of noisy rims is so by all pairs") {
  std::mt19937 random(7);
  std::size_t shown = 0, all = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Holed h;
    const int n = 6 + trial % 30;
    const double noise = 0.02 * (trial % 40) / n * 6;
    std::normal_distribution<double> normal;
    std::uniform_int_distribution<int> grid(-3, 3);
    const bool on_grid = trial % 3 == 0;  // many points in line, above each other, and in one place
    surround(h, n, 3, [&](double t, int row) {
      const double r = 1 + 0.3 * row, a = 2 * pi * t;
      Vec3 p(r * std::cos(a), r * std::sin(a), 0.3 * std::sin(2 * a));
      for (int k = 0; k < 3; ++k)
        p[k] = on_grid ? std::round(8 * p[k] + (trial % 2 ? 0 : 0.3 * grid(random))) : p[k] + noise * normal(random);
      return p;
    });
    if (trial % 4 == 0)
      fill_with_fan(h);
    else
      fill_at_random(h, random);
    shown += check_against_all_pairs(h);
    all += h.filling.size();
  }
  CHECK(shown > all / 20);
  CHECK(shown < all);
}

TEST_CASE("FillingProjection: a rim that goes round twice proves nothing, though no triangle is turned over") {
  Holed h;
  surround(h, 60, 2, [](double t, int row) {
    const double a = 4 * pi * t, r = 1 + 0.2 * std::cos(a / 2) + 0.3 * row;
    return Vec3(r * std::cos(a), r * std::sin(a), std::sin(a / 2));
  });
  const VertexHandle first = h.ring[0];
  for (std::size_t i = 1; i + 1 < h.ring.size(); ++i) h.filling.push_back({first, h.ring[i], h.ring[i + 1]});
  check_against_all_pairs(h);
}

TEST_CASE("FillingProjection: triangles at a vertex with a second gap around it are in doubt") {
  Holed h;
  surround(h, 30, 3, [](double t, int row) {
    const double r = 1 + 0.2 * row;
    return Vec3(r * std::cos(2 * pi * t), r * std::sin(2 * pi * t), 0);
  });
  const VertexHandle v = h.ring[5];
  for (const FaceHandle f : h.mesh.vf_range(v)) {
    const VertexTriple t = corners_of_filling(h, f);
    if (std::count_if(t.begin(), t.end(), [&](VertexHandle w) { return w.idx() < 30; }) > 1) continue;
    h.mesh.delete_face(f, false);
    break;
  }
  fill_with_fan(h);
  const FillingProjection projection(view_of(h.mesh), h.ring, box_of(h));
  const std::vector<char> doubt = projection.in_doubt(h.filling);
  std::size_t at_gap = 0;
  for (std::size_t t = 0; t < h.filling.size(); ++t)
    if (std::find(h.filling[t].begin(), h.filling[t].end(), v) != h.filling[t].end()) {
      ++at_gap;
      CHECK(doubt[t]);
    }
  CHECK(at_gap == 2);
  CHECK(std::count(doubt.begin(), doubt.end(), 0) > 20);
}

TEST_CASE("FillingObstacles: what is not in doubt crosses nothing, not even parts that are not joined to the rim") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1, 1);
  std::size_t shown = 0, crossing = 0;
  for (int trial = 0; trial < 6; ++trial) {
    Holed h;
    surround(h, 150, 2, [](double t, int row) {
      const double r = 1 + 0.1 * row, a = 2 * pi * t;
      return Vec3(r * std::cos(a), r * std::sin(a), 0.2 * std::sin(3 * a));
    });
    for (int i = 0; i < 20 * trial; ++i) {
      const Vec3 p(place(random), place(random), 0.2 * place(random));
      const auto near = [&] { return h.mesh.add_vertex(p + 0.1 * Vec3(place(random), place(random), place(random))); };
      const VertexHandle a = near(), b = near(), c = near();
      h.mesh.add_face(a, b, c);
    }
    fill_with_fan(h);
    const std::vector<std::vector<VertexHandle>> rims{h.ring};
    FillingObstacles obstacles(view_of(h.mesh), rims);
    obstacles.start(0);
    const std::vector<char> doubt = obstacles.in_doubt(h.filling);
    for (std::size_t t = 0; t < h.filling.size(); ++t) {
      int met = 0;
      for (const FaceHandle f : h.mesh.faces()) met += meet_in_space(h, h.filling[t], corners_of_filling(h, f));
      CHECK(obstacles.crossings(h.filling[t]) == met);
      if (!doubt[t]) CHECK(met == 0);
      shown += !doubt[t];
      crossing += met > 0;
    }
  }
  CHECK(shown > 200);
  CHECK(crossing > 50);
}

TEST_CASE("FillingObstacles: every triangle at an edge crosses the faces that the edge pierces") {
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  std::size_t pierced = 0;
  Holed h;
  surround(h, 60, 3, [&](double t, int row) {  // so noisy that the faces at the rim cross each other
    const double r = 1 + 0.1 * row, a = 2 * pi * t;
    return Vec3(r * std::cos(a), r * std::sin(a), 0) + 0.06 * Vec3(normal(random), normal(random), normal(random));
  });
  const std::vector<std::vector<VertexHandle>> rims{h.ring};
  FillingObstacles obstacles(view_of(h.mesh), rims);
  obstacles.start(0);
  for (std::size_t i = 0; i < h.ring.size(); ++i) {
    const VertexHandle a = h.ring[i], b = h.ring[(i + 1) % h.ring.size()];
    const std::vector<FaceHandle> found = obstacles.pierced(a, b);
    std::vector<FaceHandle> expected;
    for (const FaceHandle f : h.mesh.faces()) {
      const VertexTriple t = corners_of_filling(h, f);
      if (std::find(t.begin(), t.end(), a) == t.end() && std::find(t.begin(), t.end(), b) == t.end() &&
          segment_pierces(h.mesh.point(a), h.mesh.point(b), places(h, t)))
        expected.push_back(f);
    }
    CHECK(found == expected);
    pierced += found.size();
    for (const VertexHandle c : h.ring)
      if (c != a && c != b) CHECK(obstacles.crossings({a, b, c}) >= static_cast<int>(found.size()));
  }
  CHECK(pierced > 0);
}
