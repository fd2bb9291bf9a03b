// Any triangles become a solid: checked by counting edges and fans, by comparing every pair of triangles, and by the
// distance of the input to the result, on meshes with every kind of defect and their combinations.

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "meshops/crossings/self_intersections.hpp"
#include "meshops/operators/make_solid.hpp"
#include "meshops/repair.hpp"
#include "meshops/search/closest_triangle.hpp"
#include "meshops/single_precision.hpp"

using namespace tri;

namespace {

Soup cell_box(const Vec3& low, const Vec3& high, std::uint32_t cells = 1) {
  Soup soup;
  std::map<std::array<double, 3>, std::uint32_t> index;
  const auto vertex = [&](Vec3 p) {
    for (int k = 0; k < 3; ++k) p[k] = low[k] + (high[k] - low[k]) * p[k] / cells;
    const auto [it, added] =
        index.emplace(std::array{p[0], p[1], p[2]}, static_cast<std::uint32_t>(soup.points.size()));
    if (added) soup.points.push_back(p);
    return it->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const bool top : {false, true})
      for (std::uint32_t i = 0; i < cells; ++i)
        for (std::uint32_t j = 0; j < cells; ++j) {
          const auto at = [&](std::uint32_t x, std::uint32_t y) {
            Vec3 p;
            p[axis] = top ? cells : 0, p[(axis + 1) % 3] = x, p[(axis + 2) % 3] = y;
            return vertex(p);
          };
          const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
          for (Triangle t : {Triangle{a, b, c}, Triangle{a, c, d}}) {
            if (!top) std::swap(t[1], t[2]);
            soup.triangles.push_back(t);
          }
        }
  return soup;
}

void put_beside(Soup& soup, const Soup& other) {
  const auto first = static_cast<std::uint32_t>(soup.points.size());
  soup.points.insert(soup.points.end(), other.points.begin(), other.points.end());
  for (const Triangle& t : other.triangles) soup.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

Soup turned(Soup soup, double angle, const Vec3& axis) {
  const Vec3 u = axis / axis.norm();
  for (Vec3& p : soup.points)
    p = p * std::cos(angle) + (u % p) * std::sin(angle) + u * ((u | p) * (1 - std::cos(angle)));
  return soup;
}

double volume(const Soup& soup) {
  double sum = 0;
  for (const Triangle& t : soup.triangles) sum += soup.points[t[0]] | (soup.points[t[1]] % soup.points[t[2]]);
  return sum / 6;
}

/// Edges have two sides that run against each other, and the triangles of each vertex are one fan.
bool closed_manifold(const Soup& soup) {
  std::map<std::array<std::uint32_t, 2>, int> sides;
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> around;  // vertex -> from -> to
  for (const Triangle& t : soup.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      ++sides[{t[k], t[(k + 1) % 3]}];
      if (!around[t[k]].emplace(t[(k + 1) % 3], t[(k + 2) % 3]).second) return false;
    }
  for (const auto& [side, count] : sides)
    if (count != 1 || !sides.contains({side[1], side[0]})) return false;
  for (const auto& [v, ring] : around) {
    std::size_t steps = 0;
    std::uint32_t at = ring.begin()->first;
    do {
      const auto next = ring.find(at);
      if (next == ring.end()) return false;
      at = next->second;
      ++steps;
    } while (at != ring.begin()->first && steps <= ring.size());
    if (steps != ring.size()) return false;
  }
  return true;
}

/// Pairs of triangles without a place in common that meet, triangles in the same place, and triangles without area.
std::size_t contacts(const Soup& soup) {
  std::size_t count = 0;
  const auto corners = [&](const Triangle& t) {
    std::array<std::array<double, 3>, 3> c;
    for (std::size_t k = 0; k < 3; ++k) c[k] = {soup.points[t[k]][0], soup.points[t[k]][1], soup.points[t[k]][2]};
    return c;
  };
  std::set<std::array<std::array<double, 3>, 3>> seen;
  for (const Triangle& t : soup.triangles) {
    auto c = corners(t);
    std::sort(c.begin(), c.end());
    count += !seen.insert(c).second;
    const Vec3 n = (soup.points[t[1]] - soup.points[t[0]]) % (soup.points[t[2]] - soup.points[t[0]]);
    count += !(n.sqrnorm() > 0);
  }
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    const auto a = corners(soup.triangles[i]);
    for (std::size_t j = i + 1; j < soup.triangles.size(); ++j) {
      const auto b = corners(soup.triangles[j]);
      bool share = false, apart = false;
      for (const auto& p : a) share |= std::find(b.begin(), b.end(), p) != b.end();
      for (std::size_t k = 0; k < 3; ++k)
        apart |= std::max({a[0][k], a[1][k], a[2][k]}) < std::min({b[0][k], b[1][k], b[2][k]}) ||
                 std::max({b[0][k], b[1][k], b[2][k]}) < std::min({a[0][k], a[1][k], a[2][k]});
      if (share || apart) continue;
      const auto as = [&](const Triangle& t) {
        return std::array{soup.points[t[0]], soup.points[t[1]], soup.points[t[2]]};
      };
      count += triangles_intersect(as(soup.triangles[i]), as(soup.triangles[j]));
    }
  }
  return count;
}

double diagonal(const Soup& soup) {
  Vec3 low = soup.points[0], high = low;
  for (const Vec3& p : soup.points) low.minimize(p), high.maximize(p);
  return (high - low).norm();
}

/// Share of the area of `soup` whose triangles have their middle within 0.1% of the diagonal of `result`.
double share_kept(const Soup& soup, const Soup& result) {
  const ClosestTriangle nearest(result.points, result.triangles);
  double kept = 0, all = 0;
  for (const Triangle& t : soup.triangles) {
    const Vec3 &a = soup.points[t[0]], &b = soup.points[t[1]], &c = soup.points[t[2]];
    const double area = ((b - a) % (c - a)).norm();
    all += area;
    if (nearest.closest((a + b + c) / 3.0).distance <= 1e-3 * diagonal(soup)) kept += area;
  }
  return all > 0 ? kept / all : 1;
}

/// Breaks a mesh in ways numbered by the bits of `kinds`.
Soup with_defects(unsigned kinds, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto number = [&](std::uint32_t below) { return static_cast<std::uint32_t>(random() % below); };
  const auto real = [&] { return static_cast<double>(random() % 100000) / 100000; };
  Soup soup = turned(cell_box(Vec3(0, 0, 0), Vec3(1, 1, 1), 2 + number(2)), real(), Vec3(real() + 0.1, real(), real()));
  if (kinds & 1)  // another solid through it
    put_beside(soup, turned(cell_box(Vec3(0.3, 0.2, 0.4), Vec3(1.4, 0.9, 0.8), 1 + number(2)), real(),
                            Vec3(real(), real(), 1)));
  if (kinds & 2)  // holes
    for (int i = 0; i < 3; ++i)
      soup.triangles.erase(soup.triangles.begin() + number(static_cast<std::uint32_t>(soup.triangles.size())));
  if (kinds & 4)  // reversed triangles
    for (int i = 0; i < 4; ++i) {
      Triangle& t = soup.triangles[number(static_cast<std::uint32_t>(soup.triangles.size()))];
      std::swap(t[0], t[1]);
    }
  if (kinds & 8) {  // fins: edges of three triangles
    for (int i = 0; i < 2; ++i) {
      const Triangle t = soup.triangles[number(static_cast<std::uint32_t>(soup.triangles.size()))];
      soup.points.push_back(Vec3(2 * real() - 0.5, 2 * real() - 0.5, 2 * real() - 0.5));
      soup.triangles.push_back({t[0], t[1], static_cast<std::uint32_t>(soup.points.size() - 1)});
    }
  }
  if (kinds & 16) {  // duplicates, triangles without area, unwelded corners
    soup.triangles.push_back(soup.triangles[number(10)]);
    soup.triangles.push_back({soup.triangles[3][0], soup.triangles[3][0], soup.triangles[3][1]});
    soup.points.push_back(soup.points[soup.triangles[5][1]]);
    soup.triangles[5][1] = static_cast<std::uint32_t>(soup.points.size() - 1);
  }
  if (kinds & 32) {  // loose triangles through everything
    for (int i = 0; i < 2; ++i) {
      const auto first = static_cast<std::uint32_t>(soup.points.size());
      for (int k = 0; k < 3; ++k)
        soup.points.push_back(Vec3(1.6 * real() - 0.3, 1.6 * real() - 0.3, 1.6 * real() - 0.3));
      soup.triangles.push_back({first, first + 1, first + 2});
    }
  }
  return soup;
}

}  // namespace

TEST_CASE("make-solid: returns a solid as it is") {
  const Soup cube = turned(cell_box(Vec3(0, 0, 0), Vec3(1, 2, 3), 3), 0.3, Vec3(1, 2, 3));
  Soup soup = cube;
  Context context;
  const Report report = make_solid(soup, {}, context);
  CHECK(report.unchanged());
  CHECK(soup.points == cube.points);
  CHECK(soup.triangles == cube.triangles);
}

TEST_CASE("make-solid: a solid with a cavity stays as it is") {
  Soup soup = cell_box(Vec3(0, 0, 0), Vec3(3, 3, 3));
  Soup cavity = cell_box(Vec3(1, 1, 1), Vec3(2, 2, 2));
  for (Triangle& t : cavity.triangles) std::swap(t[0], t[1]);
  put_beside(soup, cavity);
  const Soup before = soup;
  Context context;
  CHECK(make_solid(soup, {}, context).unchanged());
  CHECK(soup.triangles == before.triangles);
}

TEST_CASE("make-solid: the union of two boxes has the volume of the union, walls dropped") {
  Soup soup = cell_box(Vec3(0, 0, 0), Vec3(2, 2, 2));
  put_beside(soup, cell_box(Vec3(1, 0.5, 0.5), Vec3(3, 1.5, 1.5)));
  Context context;
  make_solid(soup, {.keep_walls = false}, context);
  CHECK(closed_manifold(soup));
  CHECK(contacts(soup) == 0);
  CHECK(volume(soup) == doctest::Approx(9).epsilon(1e-6));
}

TEST_CASE("make-solid: with walls kept, the volume is that of the union but for thin gaps and nothing is lost") {
  Soup soup = cell_box(Vec3(0, 0, 0), Vec3(2, 2, 2));
  put_beside(soup, cell_box(Vec3(1, 0.5, 0.5), Vec3(3, 1.5, 1.5)));
  const Soup before = soup;
  Context context;
  make_solid(soup, {}, context);
  CHECK(closed_manifold(soup));
  CHECK(contacts(soup) == 0);
  CHECK(volume(soup) == doctest::Approx(9).epsilon(1e-3));
  CHECK(volume(soup) < 9);
  CHECK(share_kept(before, soup) == 1);
}

TEST_CASE("make-solid: a flat sheet becomes a thin plate") {
  Soup soup;
  soup.points = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}};
  const Soup before = soup;
  Context context;
  make_solid(soup, {}, context);
  CHECK(closed_manifold(soup));
  CHECK(contacts(soup) == 0);
  CHECK(volume(soup) > 0);
  CHECK(volume(soup) < 1e-3);
  CHECK(share_kept(before, soup) == 1);
}

TEST_CASE("make-solid: a box without its lid is closed") {
  Soup soup = cell_box(Vec3(0, 0, 0), Vec3(1, 1, 1), 3);
  soup.triangles.resize(soup.triangles.size() - 18);
  Context context;
  const Report report = make_solid(soup, {}, context);
  CHECK(report.figures.at("holes closed") == 1);
  CHECK(closed_manifold(soup));
  CHECK(volume(soup) == doctest::Approx(1));
}

TEST_CASE("make-solid: an inside-out box is turned") {
  Soup soup = cell_box(Vec3(0, 0, 0), Vec3(1, 1, 1), 2);
  for (Triangle& t : soup.triangles) std::swap(t[0], t[1]);
  Context context;
  CHECK_FALSE(make_solid(soup, {}, context).unchanged());
  CHECK(volume(soup) == doctest::Approx(1));
}

TEST_CASE("make-solid: attributes are kept and interpolated") {
  Soup soup = cell_box(Vec3(0, 0, 0), Vec3(2, 2, 2));
  put_beside(soup, cell_box(Vec3(1, 0.5, 0.5), Vec3(3, 1.5, 1.5)));
  for (const Vec3& p : soup.points) soup.vertex_scalars["height"].push_back(p[2]);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) soup.face_scalars["body"].push_back(t < 12 ? 0 : 1);
  Context context;
  make_solid(soup, {.keep_walls = false}, context);
  REQUIRE(soup.vertex_scalars["height"].size() == soup.points.size());
  REQUIRE(soup.face_scalars["body"].size() == soup.triangles.size());
  for (std::size_t i = 0; i < soup.points.size(); ++i)
    CHECK(soup.vertex_scalars["height"][i] == doctest::Approx(soup.points[i][2]).epsilon(1e-6));
}

TEST_CASE("make-solid: every combination of defects ends closed, manifold and without contacts, and nothing is lost") {
  Context context;
  double worst = 1;
  for (unsigned kinds = 1; kinds < 64; ++kinds) {
    for (std::uint32_t seed = 0; seed < 4; ++seed) {
      CAPTURE(kinds);
      CAPTURE(seed);
      const Soup before = with_defects(kinds, 64 * seed + kinds);
      Soup soup = before;
      const RepairResult result = repair(soup, {.goal = RepairGoal::solid}, context);
      CHECK(result.left == 0);
      CHECK(closed_manifold(soup));
      if (seed == 0) CHECK(contacts(soup) == 0);
      worst = std::min(worst, share_kept(before, soup));
    }
  }
  CHECK(worst > 0.98);
}

TEST_CASE("make-solid: the result does not depend on the number of threads") {
  const Soup before = with_defects(63, 7);
  Soup one = before, two = before;
  Context single, pair;
  single.threads = 1, pair.threads = 2;
  repair(one, {.goal = RepairGoal::solid}, single);
  repair(two, {.goal = RepairGoal::solid}, pair);
  CHECK(one.points == two.points);
  CHECK(one.triangles == two.triangles);
}

namespace {

/// Every coordinate a float, and closed and manifold when vertices in one place are one, as in STL.
bool holds_as_floats(const Soup& soup) {
  std::map<std::array<double, 3>, std::uint32_t> place;
  Soup welded = soup;
  for (Triangle& t : welded.triangles)
    for (std::uint32_t& v : t) {
      const Vec3& p = soup.points[v];
      for (int k = 0; k < 3; ++k)
        if (static_cast<double>(static_cast<float>(p[k])) != p[k]) return false;
      v = place.emplace(std::array{p[0], p[1], p[2]}, v).first->second;
    }
  return closed_manifold(welded);
}

/// An open prism with its rims in the planes z = 0 and z = 1.
Soup tube(int corners, const Vec3& center) {
  Soup soup;
  for (int i = 0; i < corners; ++i) {
    const double a = 2 * std::acos(-1.0) * i / corners;
    for (const double z : {0.0, 1.0}) soup.points.push_back(center + Vec3(std::cos(a), std::sin(a), z));
  }
  const auto n = static_cast<std::uint32_t>(2 * corners);
  for (std::uint32_t i = 0; i < n; i += 2) {
    soup.triangles.push_back({i, (i + 2) % n, (i + 3) % n});
    soup.triangles.push_back({i, (i + 3) % n, i + 1});
  }
  return soup;
}

}  // namespace

TEST_CASE(
    "make-solid: for single precision the result is a solid by place, every coordinate a float, and nothing is lost") {
  Context context;
  // Each of these has sheets, walls, or solids that touch; the coordinates are no floats.
  std::vector<std::pair<std::string, Soup>> cases;
  Soup soup = cell_box(Vec3(0, 0, 0), Vec3(2, 2, 2));
  put_beside(soup, cell_box(Vec3(1, 0.5, 0.5), Vec3(3, 1.5, 1.5)));
  cases.emplace_back("boxes through each other", soup);
  soup = cell_box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  put_beside(soup, cell_box(Vec3(1, 1, 0), Vec3(2, 2, 1)));
  cases.emplace_back("boxes that touch in an edge", soup);
  soup = cell_box(Vec3(0, 0, 0), Vec3(1, 1, 1), 2);
  put_beside(soup, cell_box(Vec3(1, 1, 1), Vec3(2, 2, 2), 2));
  cases.emplace_back("boxes that touch in a corner", soup);
  soup = cell_box(Vec3(0, 0, 0), Vec3(1, 1, 1), 2);
  put_beside(soup, cell_box(Vec3(1, 0, 0), Vec3(2, 1, 1), 2));
  cases.emplace_back("boxes that touch in a face", soup);
  soup = Soup{};
  soup.points = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0), Vec3(0.5, 0.5, 0.7)};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 2, 4}};
  cases.emplace_back("a sheet with a fin", soup);
  for (auto& [name, shape] : cases) {
    CAPTURE(name);
    Soup result = turned(shape, 0.7, Vec3(1, 2, 3));
    const Soup before = result;
    const Report report = make_solid(result, {.single_precision = true}, context);
    CHECK(report.skipped.empty());
    CHECK(holds_as_floats(result));
    CHECK(contacts(result) == 0);
    CHECK(share_kept(before, result) == 1);
    const Soup once = result;
    CHECK(make_solid(result, {.single_precision = true}, context).unchanged());
    CHECK(result.points == once.points);
    CHECK(result.triangles == once.triangles);
  }
}

TEST_CASE("make-solid: for single precision also sheets that meet in one point come apart") {
  std::mt19937 random(3);
  const auto real = [&] { return 2.0 * static_cast<double>(random() % 100000) / 100000 - 1; };
  Context context;
  for (int i = 0; i < 20; ++i) {
    CAPTURE(i);
    Soup soup;
    soup.points.push_back(Vec3(0.1, 0.2, 0.3));
    for (std::uint32_t t = 0; t < 4; ++t) {
      for (int k = 0; k < 2; ++k) soup.points.push_back(soup.points[0] + Vec3(real(), real(), real()));
      soup.triangles.push_back({0, 2 * t + 1, 2 * t + 2});
    }
    const Soup before = soup;
    CHECK(make_solid(soup, {.single_precision = true}, context).skipped.empty());
    CHECK(holds_as_floats(soup));
    CHECK(contacts(soup) == 0);
    CHECK(share_kept(before, soup) == 1);
  }
}

TEST_CASE("make-solid: for single precision thin solids that rounding turns inside out are turned round") {
  std::mt19937 random(11);
  const auto real = [&] { return 2.0 * static_cast<double>(random() % 100000) / 100000 - 1; };
  const auto tetrahedron = [](const std::array<Vec3, 4>& p) { return (p[1] - p[0]) | ((p[2] - p[0]) % (p[3] - p[0])); };
  Soup soup;
  constexpr int solids = 20;
  for (int i = 0; i < solids; ++i) {
    std::array<Vec3, 4> p, rounded;
    do {
      p[0] = Vec3(60 + i, 61, 62) + Vec3(real(), real(), real()) * 0.1;
      for (std::size_t k = 1; k < 3; ++k) p[k] = p[0] + Vec3(real(), real(), real()) * 0.1;
      const Vec3 along = (p[1] - p[0]) * real() + (p[2] - p[0]) * real(), up = (p[1] - p[0]) % (p[2] - p[0]);
      p[3] = p[0] + along + up * (2e-6 / up.norm());
      std::ranges::transform(p, rounded.begin(), rounded_to_floats);
    } while (!(tetrahedron(p) > 0 && tetrahedron(rounded) < -1e-12));
    const auto first = static_cast<std::uint32_t>(soup.points.size());
    for (const Vec3& corner : p) soup.points.push_back(corner);
    for (const Triangle& t : {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{1, 2, 3}, Triangle{2, 0, 3}})
      soup.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  put_beside(soup, cell_box(Vec3(60, 70, 60), Vec3(62, 72, 62)));
  put_beside(soup, cell_box(Vec3(61, 70.5, 60.5), Vec3(63, 71.5, 61.5)));
  const Soup before = soup;
  Context context;
  const Report report = make_solid(soup, {.single_precision = true}, context);
  CHECK(report.skipped.empty());
  CHECK(report.faces_reversed > 0);
  CHECK(holds_as_floats(soup));
  CHECK(contacts(soup) == 0);
  CHECK(share_kept(before, soup) == 1);
  // The volume of each component.
  std::vector<std::uint32_t> part(soup.points.size());
  for (std::uint32_t v = 0; v < part.size(); ++v) part[v] = v;
  for (bool changed = true; changed;) {
    changed = false;
    for (const Triangle& t : soup.triangles) {
      const std::uint32_t least = std::min({part[t[0]], part[t[1]], part[t[2]]});
      for (const std::uint32_t v : t) changed |= part[v] != least, part[v] = least;
    }
  }
  std::map<std::uint32_t, double> volumes;
  for (const Triangle& t : soup.triangles) {
    const Vec3& origin = soup.points[part[t[0]]];
    volumes[part[t[0]]] += (soup.points[t[0]] - origin) | ((soup.points[t[1]] - origin) % (soup.points[t[2]] - origin));
  }
  CHECK(volumes.size() > solids);
  for (const auto& [first, six_times] : volumes) CHECK(six_times > 0);
}

TEST_CASE(
    "make-solid: triangles nearly in one plane, which rounding makes cross again, are made a solid more than once") {
  std::mt19937 random(1);
  const auto real = [&] { return 2.0 * static_cast<double>(random() % 1000000) / 1000000 - 1; };
  Context context;
  double most_passes = 0;
  for (int i = 0; i < 3; ++i) {
    CAPTURE(i);
    Soup soup;
    for (std::uint32_t t = 0; t < 20; ++t) {
      for (int k = 0; k < 3; ++k) {
        const double x = real(), y = real(), z = real();
        soup.points.emplace_back(x, y, 1e-7 * z);
      }
      soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    const Soup before = soup;
    const Report report = make_solid(soup, {}, context);
    if (report.figures.count("passes")) most_passes = std::max(most_passes, report.figures.at("passes"));
    CHECK(report.skipped.empty());
    CHECK(closed_manifold(soup));
    CHECK(contacts(soup) == 0);
    CHECK(share_kept(before, soup) == 1);
  }
  CHECK(most_passes > 1);
}

TEST_CASE("make-solid: lids that lie nearly in one plane and overlap come to an end") {
  Soup soup = tube(48, Vec3(0, 0, 0));
  put_beside(soup, tube(37, Vec3(0.4, 0.3, 0)));
  soup = turned(soup, 0.9, Vec3(1, -2, 0.5));
  const Soup before = soup;
  Context context;
  const Report report = make_solid(soup, {}, context);
  CHECK(report.figures.at("holes closed") == 4);
  CHECK(report.skipped.empty());
  CHECK(closed_manifold(soup));
  CHECK(contacts(soup) == 0);
  CHECK(share_kept(before, soup) == 1);
}

TEST_CASE("repair: a solid is returned as it is, with vertices that coincide and vertices that nothing uses") {
  Soup soup = cell_box(Vec3(0, 0, 0), Vec3(1, 1, 1), 2);
  put_beside(soup, cell_box(Vec3(1, 1, 1), Vec3(2, 2, 2), 2));  // touch in a corner
  soup.points.push_back(Vec3(5, 5, 5));
  const Soup before = soup;
  Context context;
  for (const RepairGoal goal : {RepairGoal::solid, RepairGoal::automatic}) {
    const RepairResult result = repair(soup, {.goal = goal}, context);
    CHECK_FALSE(result.changed);
    CHECK(result.goal == RepairGoal::solid);
    CHECK(result.left == 0);
    CHECK(soup.points == before.points);
    CHECK(soup.triangles == before.triangles);
  }
}

TEST_CASE("repair: a sheet drawn from both sides is kept") {
  Soup soup;
  soup.points = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 2, 1}, {0, 3, 2}};
  const Soup before = soup;
  Context context;
  const RepairResult result = repair(soup, {.goal = RepairGoal::solid}, context);
  CHECK(result.left == 0);
  CHECK(closed_manifold(soup));
  CHECK(share_kept(before, soup) == 1);
}

TEST_CASE("repair: what cannot become a solid is left, counted and named") {
  Soup soup;
  soup.points = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)};
  soup.triangles = {{0, 1, 2}};
  const Soup before = soup;
  Context context;
  const RepairResult result = repair(soup, {.goal = RepairGoal::solid}, context);
  CHECK(result.left == 1);
  CHECK(result.steps.back().skipped.at("triangles without area") == 1);
  CHECK(result.steps.back().notes.size() == 1);
  CHECK(soup.triangles == before.triangles);
}

TEST_CASE("repair: the deviation is that of what was closed, and every place lies on what a step made") {
  Soup soup = cell_box(Vec3(0, 0, 0), Vec3(1, 1, 1), 4);
  soup.triangles.resize(soup.triangles.size() - 32);  // the last side goes
  Context context;
  const RepairResult result = repair(soup, {.goal = RepairGoal::solid}, context);
  REQUIRE(result.deviation.has_value());
  CHECK(result.deviation->lost == doctest::Approx(0));
  CHECK(result.deviation->added == doctest::Approx(0.5).epsilon(0.1));  // the middle of the side is half a side from
                                                                        // its rim
  REQUIRE(result.places.size() == result.steps.size());
  REQUIRE(result.places.back().size() == 14);  // its rim has 16 vertices
  for (const RepairPlace& p : result.places.back()) {
    CHECK(p.is_triangle);
    const Triangle& t = soup.triangles.at(p.index);
    CHECK(((soup.points[t[0]] + soup.points[t[1]] + soup.points[t[2]]) / 3.0 - p.at).norm() == doctest::Approx(0));
  }
}

TEST_CASE("repair: sheets that cross are cut apart and stay open for the goal surface") {
  Soup soup;
  soup.points = {Vec3(0, 0, 0),      Vec3(1, 0, 0),      Vec3(1, 1, 0),     Vec3(0, 1, 0),
                 Vec3(0.3, 0.2, -1), Vec3(0.3, 0.8, -1), Vec3(0.3, 0.8, 1), Vec3(0.3, 0.2, 1)};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  const Soup before = soup;
  Context context;
  const RepairResult result = repair(soup, {.goal = RepairGoal::surface}, context);
  CHECK(result.left == 0);
  CHECK(contacts(soup) == 0);
  CHECK(share_kept(before, soup) == 1);
  double area = 0;
  for (const Triangle& t : soup.triangles)
    area += ((soup.points[t[1]] - soup.points[t[0]]) % (soup.points[t[2]] - soup.points[t[0]])).norm() / 2;
  CHECK(area == doctest::Approx(1 + 1.2));
}

TEST_CASE("repair: an open sheet stays open unless a solid is asked for") {
  Soup soup;
  soup.points = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}};
  const Soup before = soup;
  Context context;
  const RepairResult result = repair(soup, {}, context);
  CHECK(result.goal == RepairGoal::surface);
  CHECK_FALSE(result.changed);
  CHECK(soup.triangles == before.triangles);
}
