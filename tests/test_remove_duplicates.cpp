#include <doctest/doctest.h>

#include "meshops/checks/mesh_summary.hpp"
#include "meshops/operators/remove_duplicates.hpp"
#include "meshops/operators/weld.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

Report run_remove_duplicates(Soup& soup, OppositePairs opposite = OppositePairs::automatic) {
  Context context;
  return remove_duplicates(soup, {.opposite = opposite}, context);
}

Soup welded(Soup soup) {
  Context context;
  weld(soup, {.touching = true}, context);
  return soup;
}

}  // namespace

TEST_CASE("remove_duplicates: copies go whichever corner they begin with, and the first stays") {
  Soup soup = with_attributes(cube());
  const Soup before = soup;
  for (const Triangle& t : before.triangles) {
    soup.triangles.push_back({t[1], t[2], t[0]});
    soup.triangles.push_back({t[2], t[0], t[1]});
    for (int i = 0; i < 2; ++i) {
      soup.face_scalars["id"].push_back(-1);
      soup.face_scalars["group"].push_back(-1);
      for (int k = 0; k < 3; ++k) soup.corner_scalars["x"].push_back(-1);
    }
  }
  const Report report = run_remove_duplicates(soup);
  CHECK(report.faces_removed == 24);
  CHECK(report.figures.at("duplicates removed") == 24);
  CHECK(same_soup(soup, before));
}

TEST_CASE("remove_duplicates: a wall between two solids goes, and they become one") {
  // Two cubes that share a whole face and its diagonal.
  Soup soup = welded(joined(cube(), cube({1, 0, 0})));
  REQUIRE(soup.points.size() == 12);
  REQUIRE(summarize(soup).duplicate_triangles == 2);
  const Report report = run_remove_duplicates(soup);
  CHECK(report.figures.at("opposite pairs removed") == 2);
  CHECK(report.faces_removed == 4);
  const MeshSummary s = summarize(soup);
  CHECK(s.closed);
  CHECK(s.manifold);
  CHECK(s.oriented);
  CHECK(s.volume == doctest::Approx(2));
}

TEST_CASE("remove_duplicates: of a sheet drawn from both sides one side stays, closed or not") {
  for (const Soup& shape : {sheet(3, 3), sphere(6, 3)}) {
    const std::size_t triangles = shape.triangles.size();
    Soup both = shape;
    for (const Triangle& t : shape.triangles) both.triangles.push_back({t[1], t[0], t[2]});
    for (const OppositePairs choice : {OppositePairs::automatic, OppositePairs::one}) {
      Soup soup = both;
      const Report report = run_remove_duplicates(soup, choice);
      CHECK(same_soup(soup, shape));
      CHECK(report.figures.at("opposite pairs made one") == triangles);
    }
    Soup none = both, kept = both;
    run_remove_duplicates(none, OppositePairs::none);
    CHECK(none.triangles.empty());
    const Report report = run_remove_duplicates(kept, OppositePairs::keep);
    CHECK(report.unchanged());
    CHECK(report.figures.at("opposite pairs found") == triangles);
    CHECK(same_soup(kept, both));
  }
}

TEST_CASE("remove_duplicates: three copies of which one is turned are one opposite pair") {
  Soup soup = sheet(1, 1);
  soup.triangles.push_back(soup.triangles[0]);
  soup.triangles.push_back({soup.triangles[0][0], soup.triangles[0][2], soup.triangles[0][1]});
  Soup kept = soup;
  CHECK(run_remove_duplicates(soup).faces_removed == 2);
  CHECK(run_remove_duplicates(kept, OppositePairs::keep).faces_removed == 1);
  CHECK(same_soup(soup, sheet(1, 1)));
}

TEST_CASE("remove_duplicates: triangles that name a vertex twice are left alone") {
  Soup soup = sheet(1, 1);
  soup.triangles.push_back({0, 0, 1});
  soup.triangles.push_back({0, 0, 1});
  CHECK(run_remove_duplicates(soup).unchanged());
}
