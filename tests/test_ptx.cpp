#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <sstream>

#include "io/points_file.hpp"
#include "mesh_io_helpers.hpp"

using namespace tri;
using namespace tri::test;

namespace {

const std::string no_pose = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

PointSet read_ptx(const std::string& bytes, PointsFileInfo* info = nullptr, const std::string& name = "a.ptx") {
  Context context;
  PointSet set = parse_points(bytes, name, context, info);
  CHECK_NOTHROW(validate(set));
  return set;
}

IoError refused_ptx(const std::string& bytes) {
  Context context;
  try {
    parse_points(bytes, "a.ptx", context);
  } catch (const IoError& error) {
    return error;
  }
  FAIL("accepted: " << bytes.substr(0, 200));
  return {"", ""};
}

}  // namespace

TEST_CASE("ptx: points, intensity and colours; cells without a return are counted") {
  PointsFileInfo info;
  const std::string body = "1.5 -2 3 0.5 255 0 7\n0 0 0 0.5 0 0 0\n4 5.25 -0.125 0.25 1 2 3\n0.0 -0 0e1 0 0 0 0\n";
  for (const char* name : {"a.ptx", "a.dat"}) {
    const PointSet set = read_ptx("2\n2\n" + no_pose + body, &info, name);
    CHECK(set.points == std::vector<Vec3>{{1.5, -2, 3}, {4, 5.25, -0.125}});
    CHECK(set.intensity == std::vector<double>{0.5, 0.25});
    CHECK(set.colors == std::vector<std::array<std::uint8_t, 3>>{{255, 0, 7}, {1, 2, 3}});
    CHECK(set.scalars.empty());
    CHECK(info.format == PointsFormat::ptx);
    CHECK(info.points_skipped == 2);
    CHECK(has_note(info.notes, "2 cells of 4 without a return"));
    REQUIRE(info.scans.size() == 1);
    CHECK(info.scans[0].points == 2);
    CHECK_FALSE(info.scans[0].has_pose);
  }
  CHECK(read_ptx("1\r\n2\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n0 0 1\r\n1 0 0 0\r\n0 1 0 0\r\n0 0 1 0\r\n0 0 0 1\r\n1 2 3 "
                 "0.5\r\n4 5 6 1\r\n")
            .points == std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}});
  CHECK(read_ptx("1\n1\n" + no_pose + "1 2 3").intensity.empty());
}

TEST_CASE("ptx: every scan is put where its matrix says, the matrix being of row vectors") {
  // A quarter turn about z that takes (1,0,0) to (0,1,0): as rows for row vectors, x maps to the first row.
  const std::string turned = "7 8 9\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n7 8 9 1\n";
  PointsFileInfo info;
  const PointSet set =
      read_ptx("1\n3\n" + turned + "1 0 0 0.5\n0 0 0 0.5\n0 2 0 0.5\n" + "1\n1\n" + no_pose + "1 2 3 1\n", &info);
  CHECK(set.points == std::vector<Vec3>{{7, 9, 9}, {5, 8, 9}, {1, 2, 3}});
  CHECK(set.intensity == std::vector<double>{0.5, 0.5, 1});
  CHECK(set.scalars.at("scan") == std::vector<double>{1, 1, 2});
  REQUIRE(info.scans.size() == 2);
  CHECK(info.scans[0].has_pose);
  CHECK(info.scans[0].translation == Vec3(7, 8, 9));
  CHECK(info.scans[0].skipped == 1);
  CHECK(info.scans[1].points == 1);
}

TEST_CASE("ptx: scans with different columns keep all of them") {
  const PointSet set = read_ptx("1\n1\n" + no_pose + "1 2 3\n1\n1\n" + no_pose + "4 5 6 0.5 9 8 7\n");
  CHECK(set.size() == 2);
  CHECK(std::isnan(set.intensity.at(0)));
  CHECK(set.intensity[1] == 0.5);
  CHECK(set.colors.at(1) == std::array<std::uint8_t, 3>{9, 8, 7});
}

TEST_CASE("ptx: the same on any number of threads, over many chunks") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> value(-5, 5);
  std::ostringstream text;
  text.precision(17);
  const int rows = 400, columns = 150;
  std::vector<Vec3> expected;
  text << columns << '\n' << rows << '\n' << no_pose;
  for (int i = 0; i < rows * columns; ++i) {
    if (i % 3 == 0) {
      text << "0 0 0 0.5\n";
      continue;
    }
    expected.emplace_back(value(random), value(random), value(random));
    text << expected.back()[0] << ' ' << expected.back()[1] << ' ' << expected.back()[2] << ' ' << i << '\n';
  }
  const std::string good = text.str();
  REQUIRE(good.size() > 2'000'000);
  for (const int threads : {1, 2, 5}) {
    Context context;
    context.threads = threads;
    CHECK(parse_points(good, "a.ptx", context).points == expected);
  }
  std::string bad = good;
  const std::size_t at = bad.find('\n', 1'500'000) + 1;
  bad[at] = 'x';
  const auto line =
      static_cast<std::uint64_t>(std::count(bad.begin(), bad.begin() + static_cast<std::ptrdiff_t>(at), '\n') + 1);
  CHECK(refused_ptx(bad).position() == line);
  Context cancelled;
  cancelled.cancel();
  CHECK_THROWS_AS(parse_points(good, "a.ptx", cancelled), Cancelled);
}

TEST_CASE("ptx: what is no PTX is refused with its line") {
  const std::string start = "1\n2\n" + no_pose;
  CHECK(refused_ptx(start + "1.25 2.25 3.25 0.5\n").position() == 12);  // a cell is missing
  CHECK(refused_ptx(start + "1 2 3 0.5\n1 2 nan 0.5\n").position() == 12);
  CHECK(refused_ptx(start + "1 2 3 0.5\n1 2 3\n").position() == 12);
  CHECK(refused_ptx(start + "1 2 3 0.5\n1 2 3 0.5 6\n").position() == 12);
  CHECK(refused_ptx(start + "1 2 3 0.5 6\n1 2 3 0.5 6\n").position() == 11);
  CHECK(refused_ptx(start + "1 2 3 0.5 6 7 256\n1 2 3 0.5 6 7 8\n").position() == 11);
  CHECK(refused_ptx(start + "\n1 2 3 0.5\n").position() == 11);
  CHECK(refused_ptx(start + "1 2 3 0.5\n1 2 3 0.5\nend\n").position() == 13);
  CHECK(refused_ptx(start + "0 0 0 0.5\n0 0 0 0.5\n").unit() == IoError::Unit::none);  // no point at all
  CHECK(refused_ptx("1\n-2\n" + no_pose).position() == 2);
  CHECK(refused_ptx("4000000000\n4000000000\n" + no_pose + "1 2 3 4\n").unit() == IoError::Unit::line);
  CHECK(refused_ptx("60000\n60000\n" + no_pose + "1 2 3 4\n").unit() == IoError::Unit::line);
  CHECK(refused_ptx("1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 2\n1 2 3\n").position() == 7);
  const std::string whole = start + "1 2 3 0.5\n4 5 6 0.5\n";
  for (std::size_t size = 1; size + 5 < whole.size(); ++size) refused_ptx(whole.substr(0, size));
}

TEST_CASE("ptx: a matrix that stretches is applied and named") {
  PointsFileInfo info;
  const PointSet set = read_ptx("1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n2 0 0 0\n0 2 0 0\n0 0 2 0\n0 0 0 1\n1 2 3\n", &info);
  CHECK(set.points == std::vector<Vec3>{{2, 4, 6}});
  CHECK(has_note(info.notes, "stretches"));
}
