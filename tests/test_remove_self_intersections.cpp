// Crossing triangles are cut: checked by comparing every pair, and by areas, which cutting does not change.
#include <doctest/doctest.h>

#include <cmath>

#include "meshops/crossings/triangle_pair.hpp"
#include "meshops/operators/remove_self_intersections.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

/// Pairs of triangles without a corner's place in common that meet.
std::size_t crossings(const Soup& soup) {
  std::size_t count = 0;
  const auto corners = [&](const Triangle& t) { return std::array{soup.points[t[0]], soup.points[t[1]], soup.points[t[2]]}; };
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    for (std::size_t j = i + 1; j < soup.triangles.size(); ++j) {
      const auto a = corners(soup.triangles[i]), b = corners(soup.triangles[j]);
      bool share = false;
      for (const Vec3& p : a)
        for (const Vec3& q : b) share |= p == q;
      count += !share && triangles_intersect(a, b);
    }
  return count;
}

}  // namespace

TEST_CASE("remove-self-intersections: what does not cross stays as it is") {
  Context context;
  Soup soup = with_attributes(joined(cube(), sheet(3, 3)));
  for (std::size_t i = 8; i < soup.points.size(); ++i) soup.points[i] += Vec3(3, 3, 3);
  const Soup before = soup;
  CHECK(remove_self_intersections(soup, {}, context).unchanged());
  CHECK(same_soup(soup, before));
}

TEST_CASE("remove-self-intersections: surfaces that cross are cut, vertices stay and no area is lost") {
  Context context;
  for (const double shift : {0.3, 0.5, 0.77}) {
    CAPTURE(shift);
    Soup soup = joined(sphere(16, 8), sphere(15, 9, 0.8, Vec3(shift, 0.1, 0.2)));
    const Soup before = soup;
    const Report report = remove_self_intersections(soup, {}, context);
    CHECK(report.skipped.empty());
    CHECK(report.figures.at("crossing pairs") > 0);
    CHECK(crossings(before) > 0);
    CHECK(crossings(soup) == 0);
    CHECK(soup_area(soup) == doctest::Approx(soup_area(before)).epsilon(1e-6));
    CHECK(soup_volume(soup) == doctest::Approx(soup_volume(before)).epsilon(1e-6));
    for (std::size_t i = 0; i < before.points.size(); ++i) CHECK((soup.points[i] - before.points[i]).norm() < 1e-5);
  }
}

TEST_CASE("remove-self-intersections: values of vertices are interpolated and those of triangles go to their pieces") {
  Context context;
  Soup soup = joined(cube(), cube(Vec3(0.5, 0.4, 0.3)));
  for (const Vec3& p : soup.points) soup.vertex_scalars["sum"].push_back(p[0] + 2 * p[1] + 3 * p[2]);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) soup.face_scalars["body"].push_back(t < 12 ? 0 : 1);
  remove_self_intersections(soup, {}, context);
  REQUIRE(soup.vertex_scalars["sum"].size() == soup.points.size());
  for (std::size_t i = 0; i < soup.points.size(); ++i) {
    const Vec3& p = soup.points[i];
    CHECK(soup.vertex_scalars["sum"][i] == doctest::Approx(p[0] + 2 * p[1] + 3 * p[2]).epsilon(1e-6));
  }
  double first = 0;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const Triangle& v = soup.triangles[t];
    if (soup.face_scalars["body"][t] == 0)
      first += ((soup.points[v[1]] - soup.points[v[0]]) % (soup.points[v[2]] - soup.points[v[0]])).norm() / 2;
  }
  CHECK(first == doctest::Approx(6).epsilon(1e-6));
}
