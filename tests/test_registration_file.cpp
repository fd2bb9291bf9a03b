#include <doctest/doctest.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "io/mesh_file.hpp"
#include "io/registration_file.hpp"
#include "meshops/error.hpp"
#include "meshops/points/point_soup.hpp"
#include "temporary_folder.hpp"

using namespace tri;
using tri::test::file_bytes;
using tri::test::TemporaryFolder;

namespace {

// Numbers that need all their digits, a point without a foot, and feet on an edge and off it.
struct Case {
  CadModel model;
  std::vector<Vec3> points{{1.0 / 3, -1e-300, 12345678.9}, {0.1, 0.2, 0.3}, {0, 0, 0}};
  std::vector<Foot> feet;

  Case() {
    model.faces.resize(2);
    model.faces[0].index = 4;
    model.faces[1].index = 7;
    feet.resize(3);
    feet[0] = {.point = {0.1 + 0.2, 2e22 / 7, 1},
               .uv = {std::numbers::pi, -1e-17},
               .deviation = -1.0 / 7,
               .normal = {},
               .face = 1,
               .edge = 0};
    feet[1] = {.point = {1, 2, 3}, .uv = {4, 5}, .deviation = 6, .normal = {}, .face = 0, .edge = -1};
  }

  PointSet set() const {
    PointSet set;
    set.points = points;
    return set;
  }
};

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> list;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) list.push_back(cell);
  return list;
}

double number(const std::string& text) {
  double value = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  CHECK(end.ptr == text.data() + text.size());
  return value;
}

// The columns that both formats share, by the CSV's names.
std::vector<double> expected(const Case& c, std::size_t i) {
  const Foot& f = c.feet[i];
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> row{static_cast<double>(i), c.points[i][0], c.points[i][1], c.points[i][2]};
  if (f.face < 0)
    row.insert(row.end(), {0, nan, nan, nan, nan, nan, nan, 0});
  else
    row.insert(row.end(), {static_cast<double>(c.model.faces[static_cast<std::size_t>(f.face)].index), f.uv[0], f.uv[1],
                           f.point[0], f.point[1], f.point[2], f.deviation, f.edge >= 0 ? 1.0 : 0.0});
  return row;
}

bool same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

}  // namespace

TEST_CASE("write_registration: CSV has its header and one line a point whose numbers read back as the same doubles") {
  const TemporaryFolder folder;
  const Case c;
  Context context;
  write_registration(folder / "r.csv", c.set(), c.feet, c.model, context);
  std::istringstream lines(file_bytes(folder / "r.csv"));
  std::string line;
  std::getline(lines, line);
  CHECK(line == "index,x,y,z,face,u,v,fx,fy,fz,deviation,on_edge");
  for (std::size_t i = 0; i < c.points.size(); ++i) {
    CAPTURE(i);
    REQUIRE(std::getline(lines, line));
    const std::vector<std::string> row = cells(line);
    const std::vector<double> truth = expected(c, i);
    REQUIRE(row.size() == truth.size());
    for (std::size_t k = 0; k < row.size(); ++k) CHECK(same(number(row[k]), truth[k]));
  }
  CHECK(!std::getline(lines, line));
}

TEST_CASE("write_registration: PLY holds the same, to the bit, as properties of its vertices") {
  const TemporaryFolder folder;
  const Case c;
  Context context;
  write_registration(folder / "r.ply", c.set(), c.feet, c.model, context);
  const Soup soup = read_mesh(folder / "r.ply", context);
  REQUIRE(soup.points == c.points);
  CHECK(soup.triangles.empty());
  const char* names[] = {"point_index", "cad_face", "u", "v", "fx", "fy", "fz", "deviation", "on_edge"};
  REQUIRE(soup.vertex_scalars.size() == std::size(names));
  for (std::size_t i = 0; i < c.points.size(); ++i) {
    const std::vector<double> truth = expected(c, i);
    for (std::size_t k = 0; k < std::size(names); ++k) {
      CAPTURE(names[k]);
      CHECK(same(soup.vertex_scalars.at(names[k])[i], truth[k == 0 ? 0 : k + 3]));
    }
  }
}

TEST_CASE("write_registration: what else is known of the points follows, in both formats, under names of its own") {
  const TemporaryFolder folder;
  const Case c;
  Context context;
  PointSet set = c.set();
  set.normals = {{0, 0, 1}, {0.6, 0.8, 0}, {0, 0, 0}};
  set.intensity = {0.1 + 0.2, -1, 1e300};
  set.colors = {{0, 127, 255}, {1, 2, 3}, {9, 8, 7}};
  set.scalars["deviation"] = {7, 8, 9};
  set.scalars["scan line"] = {1.5, 2.5, 1.0 / 3};
  write_registration(folder / "r.csv", set, c.feet, c.model, context);
  write_registration(folder / "r.ply", set, c.feet, c.model, context);
  std::istringstream lines(file_bytes(folder / "r.csv"));
  std::string line;
  std::getline(lines, line);
  CHECK(line ==
        "index,x,y,z,face,u,v,fx,fy,fz,deviation,on_edge,nx,ny,nz,intensity,red,green,blue,input_deviation,scan_line");
  const PointSet read = to_points(read_mesh(folder / "r.ply", context));
  CHECK(read.points == set.points);
  CHECK(read.normals == set.normals);
  CHECK(read.intensity == set.intensity);
  CHECK(read.colors == set.colors);
  CHECK(read.scalars.at("input_deviation") == set.scalars.at("deviation"));
  CHECK(read.scalars.at("scan_line") == set.scalars.at("scan line"));
  CHECK(read.scalars.at("deviation")[0] == c.feet[0].deviation);
  for (std::size_t i = 0; i < 3; ++i) {
    std::getline(lines, line);
    const std::vector<std::string> row = cells(line);
    REQUIRE(row.size() == 21);
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK(number(row[12 + k]) == set.normals[i][static_cast<int>(k)]);
      CHECK(number(row[16 + k]) == set.colors[i][k]);
    }
    CHECK(number(row[15]) == set.intensity[i]);
    CHECK(number(row[19]) == set.scalars.at("deviation")[i]);
    CHECK(number(row[20]) == set.scalars.at("scan line")[i]);
  }
}

TEST_CASE("write_registration: refuses other endings and a wrong number of feet, and a cancel leaves no file") {
  const TemporaryFolder folder;
  Case c;
  Context context;
  CHECK_THROWS_AS(write_registration(folder / "r.txt", c.set(), c.feet, c.model, context), InvalidInput);
  context.cancel();
  CHECK_THROWS_AS(write_registration(folder / "r.csv", c.set(), c.feet, c.model, context), Cancelled);
  c.feet.pop_back();
  CHECK_THROWS_AS(write_registration(folder / "r.csv", c.set(), c.feet, c.model, context), InvalidInput);
  CHECK(folder.entries().empty());
}
