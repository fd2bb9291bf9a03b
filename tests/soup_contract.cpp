// What every registered operator on soups owes, whatever it does: run over the registry, so that a new operator is held
// to it by its registration alone.

#include <doctest/doctest.h>

#include <cmath>

#include "attribute_checks.hpp"
#include "contract.hpp"
#include "meshops/build_mesh.hpp"
#include "meshops/to_soup.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

/// Inputs on which most operators find something to do.
std::vector<std::pair<std::string, Soup>> soup_inputs() {
  std::vector<std::pair<std::string, Soup>> result;
  const auto add = [&](const char* name, const Soup& soup) { result.emplace_back(name, with_attributes(soup)); };
  add("cube", cube());
  add("loose triangles", exploded(sphere(8, 3)));
  add("cavity facing outward", joined(cube({0, 0, 0}, 3), cube({1, 1, 1}, 1)));
  Soup twice = cube();
  twice.triangles.push_back({3, 0, 2});
  twice.triangles.push_back({0, 3, 2});
  twice.triangles.push_back({4, 7, 5});
  add("duplicates of both kinds", twice);
  Soup turned = sphere(7, 4);
  for (std::size_t i = 0; i < turned.triangles.size(); i += 3)
    std::swap(turned.triangles[i][0], turned.triangles[i][1]);
  add("some turned", turned);
  Soup caps = sheet(3, 2);
  caps.points.emplace_back(0.5, 0, 0);
  caps.points.emplace_back(1.5, 1, 0);
  caps.triangles.push_back({0, 12, 1});
  caps.triangles.push_back({5, 13, 6});
  caps.triangles.push_back({5, 5, 6});
  add("caps and fins", caps);
  Soup needles = sphere(6, 2);
  for (int i = 0; i < 6; ++i) needles.points[static_cast<std::size_t>(1 + i)] = Vec3(0, 0, -1);
  add("sides of no length", needles);
  Soup touching = joined(cube(), cube({1, 1, 0}));
  for (Triangle& t : touching.triangles)
    for (std::uint32_t& v : t) v = v == 8 ? 3 : v == 12 ? 7 : v;
  add("cubes with an edge in common", touching);
  Soup junctions = joined(sheet(4, 1), sheet(2, 1));
  for (std::size_t i = 10; i < junctions.points.size(); ++i)
    junctions.points[i] = Vec3(2 * junctions.points[i][0], junctions.points[i][1] - 1, 0);
  add("sheets that meet in T-junctions", junctions);
  Soup folded = sheet(8, 8);
  for (Vec3& p : folded.points) p[2] = 0.001 * std::sin(2 * p[0] + 3 * p[1]);
  folded.points[40] += Vec3(2.5, 0.6, 0);
  add("folded over itself", folded);
  return result;
}

struct SoupKind {
  using Value = Soup;
  static constexpr Domain domain = Domain::soup;
  static constexpr int cancel_threads = 0;
  static std::vector<std::pair<std::string, Soup>> inputs() { return ::soup_inputs(); }
  static Soup valid() { return cube(); }
  static bool same(const Soup& a, const Soup& b) { return same_soup(a, b); }
  static void check_cancelled(const Soup& after, const Soup& before) { CHECK(same_soup(after, before)); }
};

std::vector<const Operator*> soup_operators() {
  return operators_of(Domain::soup);
}

}  // namespace

TEST_CASE("soup contract: no points, and points without triangles, are left alone") {
  for (const Operator* op : soup_operators()) {
    CAPTURE(op->name());
    Soup none, points;
    points.points = {{0, 0, 0}, {1, 2, 3}};
    const Soup before = points;
    Context context;
    const Report report = run(*op, none, context);
    CHECK(report.unchanged());
    CHECK(report.operation == op->name());
    CHECK(none.points.empty());
    CHECK(run(*op, points, context).unchanged());
    CHECK(same_soup(points, before));
  }
}

TEST_CASE("soup contract: a closed, well-shaped mesh is returned bit for bit, with a zero report") {
  for (const Operator* op : soup_operators()) {
    if (!op->promises().leaves_good_mesh) continue;
    CAPTURE(op->name());
    Soup soup = with_attributes(sphere(9, 5));
    const Soup before = soup;
    Context context;
    const Report report = run(*op, soup, context);
    CHECK(report.unchanged());
    CHECK(report.skipped.empty());
    CHECK(report.touched_vertices.empty());
    CHECK(report.touched_faces.empty());
    CHECK(same_soup(soup, before));
  }
}

TEST_CASE("soup contract: indices and attributes fit afterwards, and the report counts what changed") {
  for_all<SoupKind>([](const Operator& op, const Soup& input) {
    Soup soup = input;
    Context context;
    const Report report = run(op, soup, context);
    CHECK_NOTHROW(check_soup(soup));
    CHECK(soup.points.size() + report.vertices_removed == input.points.size() + report.vertices_added);
    CHECK(soup.triangles.size() + report.faces_removed == input.triangles.size() + report.faces_added);
    for (const std::uint32_t f : report.touched_faces) CHECK(f < soup.triangles.size());
    for (const std::uint32_t v : report.touched_vertices) CHECK(v < soup.points.size());
    if (report.unchanged())
      CHECK(same_soup(soup, input));
    else
      CHECK_FALSE(same_soup(soup, input));
    // Sheets that become plates get their thickness by copies of their vertices beside them.
    const bool beside = op.name() == "make-solid" && report.vertices_added > 0;
    check_attributes(soup, input, report.vertices_moved > 0 || beside);
  });
}

TEST_CASE("soup contract: a second run changes nothing, where promised") {
  check_second_run<SoupKind>();
}

TEST_CASE("soup contract: the result does not depend on the number of threads") {
  check_threads<SoupKind>();
}

TEST_CASE("soup contract: cancelled at any checkpoint, the soup is as it was; progress never goes backwards") {
  check_cancel<SoupKind>();
}

TEST_CASE("soup contract: an option out of range is refused and nothing is touched") {
  check_options<SoupKind>();
}

TEST_CASE("soup contract: an inconsistent soup is refused") {
  for (const Operator* op : soup_operators()) {
    CAPTURE(op->name());
    Soup wrong_index = cube(), wrong_length = with_attributes(cube());
    wrong_index.triangles[3][1] = 8;
    wrong_length.corner_scalars["x"].pop_back();
    Context context;
    CHECK_THROWS_AS(run(*op, wrong_index, context), InvalidInput);
    CHECK_THROWS_AS(run(*op, wrong_length, context), InvalidInput);
  }
}

TEST_CASE("soup contract: made a mesh and a soup again, the attributes are what they were, of copies as well") {
  for (const auto& input : soup_inputs()) {
    CAPTURE(input.first);
    Context context;
    BuiltMesh built = build_mesh(input.second, context);
    check_attributes(to_soup(view_of(built.mesh)), input.second, false);
  }
}
