#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "io/truth_file.hpp"
#include "meshops/error.hpp"
#include "temporary_folder.hpp"

using namespace tri;
using namespace tri::test;

TEST_CASE("write_truth: every number reads back as the same double, in the order of the points") {
  VirtualMeasurement m;
  for (int i = 0; i < 3000; ++i) {
    TruePoint t;
    t.face = i % 16 + 1;
    t.outlier = i % 7 == 0;
    t.uv = {std::sqrt(i + 0.1), -1e-9 * i};
    t.point = {1.0 / (i + 3), 1e6 + i / 7.0, -0.0};
    t.normal = {std::sin(i), std::cos(i), 0};
    m.truth.push_back(t);
    m.points.push_back(t.point);
  }
  const TemporaryFolder folder;
  Context context;
  write_truth(folder / "a.truth.csv", m, context);
  std::istringstream lines(file_bytes(folder / "a.truth.csv"));
  std::string line;
  REQUIRE(std::getline(lines, line));
  CHECK(line == "index,face,u,v,x,y,z,nx,ny,nz,outlier");
  std::size_t i = 0;
  bool same = true;
  for (; std::getline(lines, line) && i < m.truth.size(); ++i) {
    std::istringstream cells(line);
    std::vector<double> value;
    for (std::string cell; std::getline(cells, cell, ',');) value.push_back(std::strtod(cell.c_str(), nullptr));
    REQUIRE(value.size() == 11);
    const TruePoint& t = m.truth[i];
    same = same && value[0] == double(i) && value[1] == t.face && Vec2(value[2], value[3]) == t.uv &&
           Vec3(value[4], value[5], value[6]) == t.point && Vec3(value[7], value[8], value[9]) == t.normal &&
           value[10] == (t.outlier ? 1 : 0);
  }
  CHECK(same);
  CHECK(i == 3000);
}

TEST_CASE("write_truth: leaves no file when cancelled or where it cannot be written") {
  VirtualMeasurement m;
  m.truth.resize(20000);
  const TemporaryFolder folder;
  Context context;
  CHECK_THROWS_AS(write_truth(folder / "missing/a.csv", m, context), IoError);
  context.cancel();
  CHECK_THROWS_AS(write_truth(folder / "a.csv", m, context), Cancelled);
  CHECK(folder.entries().empty());
}
