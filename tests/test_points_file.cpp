#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <sstream>

#include "io/points_file.hpp"
#include "mesh_io_helpers.hpp"

using namespace tri;
using namespace tri::test;

namespace {

PointSet points_of(const std::string& bytes, const std::string& name = "a.xyz", PointsFileInfo* info = nullptr) {
  Context context;
  return parse_points(bytes, name, context, info);
}

IoError refused_points(const std::string& bytes, const std::string& name = "a.xyz") {
  Context context;
  try {
    parse_points(bytes, name, context);
  } catch (const IoError& error) {
    return error;
  }
  FAIL("accepted: " << bytes.substr(0, 200));
  return {"", ""};
}

const std::vector<Vec3> two{{1.5, -2, 3}, {4, 5.25, -0.125}};

// Literals of PCL's own LZF: a control byte of n-1 below 32 announces n bytes as they are.
std::string lzf_literals(const std::string& bytes) {
  std::string out;
  for (std::size_t at = 0; at < bytes.size(); at += 32) {
    const std::string piece = bytes.substr(at, 32);
    out += static_cast<char>(piece.size() - 1) + piece;
  }
  return out;
}

std::string pcd_header(const std::string& fields, std::size_t points, const std::string& data) {
  return "# .PCD v0.7\nVERSION 0.7\n" + fields + "WIDTH " + std::to_string(points) +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(points) + "\nDATA " + data + "\n";
}

const std::string xyz_fields = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";

}  // namespace

TEST_CASE("points: any separator, line end and sign") {
  for (const char* text :
       {"1.5 -2 3\n4 5.25 -0.125\n", "1.5\t-2\t3\n4\t5.25\t-0.125", "1.5,-2,3\n4,5.25,-0.125\n",
        "1.5;-2;3\n4;5.25;-0.125\n", "1.5, -2, 3\n4, 5.25, -0.125\n", "  1.5   -2 \t 3  \n\n+4 5.25 -.125\n",
        "1.5 -2 3\r\n4 5.25 -0.125\r\n", "1.5 -2 3\r4 5.25 -0.125\r", "1,5;-2;3\n4;5,25;-0,125\n",
        "1,5 -2 3\n4 5,25 -0,125\n", "1,5\t-2,0\t3,0\n4,0\t5,25\t-0,125\n", "15e-1 -0.2e1 3E0\n4 5.25 -1.25e-1\n",
        "# c\n1.5 -2 3\n// c\n% c\n! c\n4 5.25 -0.125\n# end",
        "\xEF\xBB\xBF"
        "1.5 -2 3\n4 5.25 -0.125\n",
        "2\n1.5 -2 3\n4 5.25 -0.125\n", "1.5,-2,3,\n4,5.25,-0.125,\n"}) {
    CAPTURE(text);
    CHECK(points_of(text).points == two);
    CHECK(points_of(text).normals.empty());
  }
}

TEST_CASE("points: header lines are skipped and named") {
  PointsFileInfo info;
  CHECK(points_of("Scan of a lid\nx y z\n1.5 -2 3\n4 5.25 -0.125\n", "a.asc", &info).points == two);
  CHECK(has_note(info.notes, "2 header lines skipped, beginning with \"Scan of a lid\""));
  points_of("1.5 -2 3\n", "a.xyz", &info);
  CHECK(info.notes.empty());
}

TEST_CASE("points: a header that names its columns says where x, y and z are") {
  PointsFileInfo info;
  const PointSet named = points_of("index,x,y,z,Face\n0,1.5,-2,3,7\n1,4,5.25,-0.125,8\n", "a.csv", &info);
  CHECK(named.points == two);
  CHECK(named.scalars.at("index") == std::vector<double>{0, 1});
  CHECK(named.scalars.at("Face") == std::vector<double>{7, 8});
  CHECK_FALSE(has_note(info.notes, "ignored"));
  CHECK(points_of("\"Z [mm]\";\"Y [mm]\";\"X [mm]\"\n3;-2;1,5\n-0,125;5,25;4\n", "a.csv").points == two);
  CHECK(points_of("//X Y Z Intensity\n1.5 -2 3 9\n4 5.25 -0.125 9\n").points == two);
  CHECK(points_of("# y x z\n-2 1.5 3\n5.25 4 -0.125\n").points == two);
  CHECK(points_of("name,x,y,z\nP1,1.5,-2,3\nP2,4,5.25,-0.125\n", "a.csv", &info).points == two);
  CHECK(has_note(info.notes, "column 1 of 4 ignored"));
  // Words of a sentence are no names of columns.
  CHECK(points_of("# this is a file with x y z\n1.5 -2 3 0\n4 5.25 -0.125 0\n").points == two);
  const PointSet set = points_of("nx ny nz x y z\n0 0 2 1.5 -2 3\n0 1 0 4 5.25 -0.125\n");
  CHECK(set.points == two);
  CHECK(set.normals == std::vector<Vec3>{{0, 0, 2}, {0, 1, 0}});
}

TEST_CASE("points: columns 4 to 6 are normals only if they are unit vectors on every line") {
  PointsFileInfo info;
  PointSet set = points_of("1.5 -2 3 0 0 1 77\n4 5.25 -0.125 0.6 0 -0.8 77\n", "a.xyz", &info);
  CHECK(set.points == two);
  CHECK(set.normals == std::vector<Vec3>{{0, 0, 1}, {0.6, 0, -0.8}});
  CHECK(has_note(info.notes, "read as normals"));
  CHECK(has_note(info.notes, "column 7 of 7 ignored"));

  set = points_of("1.5 -2 3 255 0 1\n4 5.25 -0.125 0.6 0 -0.8\n", "a.xyz", &info);
  CHECK(set.normals.empty());
  CHECK(has_note(info.notes, "columns 4, 5, 6 of 6 ignored"));

  std::string text;
  for (int i = 0; i < 5000; ++i) text += "1 2 3 0 1 0\n";
  CHECK(points_of(text).normals.size() == 5000);
  for (const char* last : {"1 2 3 9 9 9\n", "1 2 3\n", "1 2 3 a b c\n"}) {
    set = points_of(text + last, "a.xyz", &info);
    CHECK(set.points.size() == 5001);
    CHECK(set.normals.empty());
    CHECK(has_note(info.notes, "not unit vectors on every line"));
  }
}

TEST_CASE("points: every line that holds no point is refused with its number") {
  CHECK(refused_points("1 2 3\n4 5 nan\n").position() == 2);
  CHECK(refused_points("1 2 3\n4 inf 6\n").position() == 2);
  CHECK(refused_points("1 2 3\n4 1e999 6\n").position() == 2);
  CHECK(refused_points("nan 2 3\n").position() == 1);
  CHECK(refused_points("1 2 3\n\n# c\n4 5\n").position() == 4);
  CHECK(refused_points("1 2 3\n4 5 x\n").position() == 2);
  CHECK(refused_points("1 2 3\nx y z\n4 5 6\n").position() == 2);
  CHECK(refused_points("1,2,3\n4,,6\n").position() == 2);
  CHECK(std::string(refused_points("1,2,3\n4,,6\n").what()).find("column 2 is empty") != std::string::npos);
  CHECK(refused_points("1,5 2,5 3,5\n4.5 2 1\n").position() == 2);
  CHECK(refused_points("1.000,5;2,0;3,0\n").position() == 1);  // thousands and decimals
  CHECK(refused_points("1 2\n3 4\n").position() == 1);
  CHECK(refused_points("1.5abc 2 3\n1 2 3\n2 x 3\n").position() == 3);
  CHECK(refused_points("hello\nworld\n").position() == 1);
  CHECK(refused_points("# only\n\n").unit() == IoError::Unit::none);
  CHECK(refused_points("").unit() == IoError::Unit::none);
}

TEST_CASE("points: other kinds of files are refused by name") {
  const auto says = [](const std::string& bytes, const char* word, const char* name = "a.dat") {
    return std::string(refused_points(bytes, name).what()).find(word) != std::string::npos;
  };
  CHECK(says("no E57", "ASTM-E57", "a.e57"));
  CHECK(says("ISO-10303-21;", "CAD"));
  CHECK(says(std::string(72, ' ') + "S      1\n1 2 3\n", "CAD"));
  CHECK(says(std::string("1 2 3\n\0\0\0", 9), "binary"));
  CHECK(
      says("\xFF\xFE"
           "1 2 3",
           "UTF-16"));
}

TEST_CASE("points: a large text gives the same on any number of threads and names the first bad line") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> value(-1e4, 1e4);
  std::vector<Vec3> expected;
  std::ostringstream text;
  text.precision(17);
  for (int i = 0; i < 120'000; ++i) {  // some 7 MB: several chunks
    expected.emplace_back(value(random), value(random), value(random));
    text << expected.back()[0] << ' ' << expected.back()[1] << ' ' << expected.back()[2] << '\n';
    if (i % 1000 == 0) text << "# comment\n\n";
  }
  const std::string good = text.str();
  for (const int threads : {1, 2, 7}) {
    Context context;
    context.threads = threads;
    CHECK(parse_points(good, "a.xyz", context).points == expected);
  }
  std::string bad = good;
  const std::size_t first = bad.find('\n', 3'000'000) + 1, second = bad.find('\n', 5'000'000) + 1;
  bad[first] = 'x';
  bad[second] = 'x';
  const auto line =
      static_cast<std::uint64_t>(std::count(bad.begin(), bad.begin() + static_cast<std::ptrdiff_t>(first), '\n') + 1);
  for (const int threads : {1, 7}) {
    Context context;
    context.threads = threads;
    try {
      parse_points(bad, "a.xyz", context);
      FAIL("accepted");
    } catch (const IoError& error) {
      CHECK(error.position() == line);
    }
  }
  Context cancelled;
  cancelled.cancel();
  CHECK_THROWS_AS(parse_points(good, "a.xyz", cancelled), Cancelled);
}

TEST_CASE("points: PLY and meshes give their vertices") {
  PointsFileInfo info;
  const PointSet set = points_of(
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\nproperty "
      "float nx\nproperty float "
      "ny\nproperty float nz\nproperty uchar quality\nend_header\n1.5 -2 3 0 0 1 7\n4 5.25 -0.125 1 0 0 7\n",
      "a.ply", &info);
  CHECK(set.points == two);
  CHECK(set.normals == std::vector<Vec3>{{0, 0, 1}, {1, 0, 0}});
  CHECK(info.format == PointsFormat::ply);
  CHECK(set.scalars.at("quality") == std::vector<double>{7, 7});
  CHECK(points_of("v 1.5 -2 3\nv 4 5.25 -0.125\n", "a.obj", &info).points == two);
  CHECK(info.format == PointsFormat::mesh);
  CHECK(refused_points("OFF\n0 0 0\n", "a.off").unit() == IoError::Unit::none);
}

TEST_CASE("pcd: ASCII, binary and compressed give the same points") {
  PointsFileInfo info;
  CHECK(points_of(pcd_header(xyz_fields, 2, "ascii") + "1.5 -2 3\n4 5.25 -0.125\n", "a.pcd", &info).points == two);
  CHECK(info.format == PointsFormat::pcd);
  CHECK(info.notes.empty());
  CHECK(points_of(pcd_header(xyz_fields, 2, "binary") + raw(1.5f, -2.f, 3.f, 4.f, 5.25f, -0.125f), "a.dat").points ==
        two);
  const std::string values = raw(1.5f, 4.f, -2.f, 5.25f, 3.f, -0.125f);  // all x, all y, all z
  const std::string packed = lzf_literals(values);
  CHECK(points_of(pcd_header(xyz_fields, 2, "binary_compressed") +
                      raw(static_cast<std::uint32_t>(packed.size()), static_cast<std::uint32_t>(values.size())) +
                      packed,
                  "a.pcd")
            .points == two);
}

TEST_CASE("pcd: fields of any type, size and count around the coordinates; normals") {
  const std::string fields =
      "FIELDS rgb x histogram y normal_x normal_y normal_z z\nSIZE 4 8 2 4 4 4 4 2\nTYPE U F U F F F F I\nCOUNT 1 1 3 "
      "1 1 1 1 1\n";
  PointsFileInfo info;
  const std::string body =
      raw(7u, 1.5, std::array<std::uint16_t, 3>{1, 2, 3}, -2.f, 0.f, 0.f, 1.f, std::int16_t{3}) +
      raw(7u, 4.0, std::array<std::uint16_t, 3>{1, 2, 3}, 5.25f, std::nanf(""), 0.f, 1.f, std::int16_t{-9});
  const PointSet set = points_of(pcd_header(fields, 2, "binary") + body, "a.pcd", &info);
  CHECK(set.points == std::vector<Vec3>{{1.5, -2, 3}, {4, 5.25, -9}});
  CHECK(set.normals == std::vector<Vec3>{{0, 0, 1}, {0, 0, 0}});
  CHECK(has_note(info.notes, "fields ignored: histogram"));
  CHECK(set.colors == std::vector<std::array<std::uint8_t, 3>>{{0, 0, 7}, {0, 0, 7}});
  CHECK(has_note(info.notes, "1 points have no normal"));
  CHECK(points_of(pcd_header(fields, 1, "ascii") + "7 1.5 1 2 3 -2 0 0 1 3\n", "a.pcd").points ==
        std::vector<Vec3>{two[0]});
}

TEST_CASE("pcd: points that are all NaN are skipped and counted, others that are not finite are refused") {
  PointsFileInfo info;
  CHECK(
      points_of(pcd_header(xyz_fields, 3, "ascii") + "1.5 -2 3\nnan nan nan\n4 5.25 -0.125\n", "a.pcd", &info).points ==
      two);
  CHECK(info.points_skipped == 1);
  CHECK(has_note(info.notes, "1 points without a measurement"));
  CHECK(refused_points(pcd_header(xyz_fields, 2, "ascii") + "1 2 3\n1 nan 3\n", "a.pcd").position() == 13);
  CHECK(refused_points(pcd_header(xyz_fields, 2, "ascii") + "1 2 3\n1 inf 3\n", "a.pcd").position() == 13);
  const std::string header = pcd_header(xyz_fields, 1, "binary");
  CHECK(refused_points(header + raw(1.f, std::nanf(""), 2.f), "a.pcd").position() == header.size());
}

TEST_CASE("pcd: truncated, absurd and contradicting files are refused") {
  const std::string binary = pcd_header(xyz_fields, 2, "binary") + raw(1.5f, -2.f, 3.f, 4.f, 5.25f, -0.125f);
  for (std::size_t size = 0; size < binary.size(); ++size) refused_points(binary.substr(0, size), "a.pcd");
  const std::string ascii = pcd_header(xyz_fields, 2, "ascii") + "1.5 -2 3\n4 5.25 -0.125\n";
  for (std::size_t size = 0; size + 6 < ascii.size(); ++size) refused_points(ascii.substr(0, size), "a.pcd");
  for (const char* data : {"ascii", "binary", "binary_compressed"}) {
    CHECK_NOTHROW(refused_points(pcd_header(xyz_fields, 4'000'000'000, data) + std::string(100, '1'), "a.pcd"));
  }
  refused_points("VERSION 0.7\n" + xyz_fields + "WIDTH 2\nHEIGHT 2\nPOINTS 3\nDATA ascii\n1 2 3\n1 2 3\n1 2 3\n",
                 "a.pcd");
  refused_points("VERSION 0.7\nFIELDS x y\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\nPOINTS 1\nDATA ascii\n1 2\n", "a.pcd");
  refused_points("VERSION 0.7\nFIELDS x y z\nSIZE 3 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n", "a.pcd");
  refused_points(pcd_header(xyz_fields, 2, "zipped"), "a.pcd");
  // Compressed data that claims more than it can hold, and data that is broken.
  refused_points(pcd_header(xyz_fields, 2, "binary_compressed") + raw(8u, 25u) + std::string(8, '\0'), "a.pcd");
  refused_points(pcd_header(xyz_fields, 2, "binary_compressed") + raw(8u, 24u) + std::string(8, '\xFF'), "a.pcd");
  refused_points(pcd_header(xyz_fields, 2, "binary_compressed") + raw(9u, 24u) + std::string(8, '\0'), "a.pcd");
}

TEST_CASE("points: written files read back exactly, with and without normals") {
  TemporaryFolder folder;
  Context context;
  PointSet set;
  set.points = {{0.1, 1.0 / 3, -2e-308},
                {1e300, -1e-300, 5e-324},
                {123456789.12345679, 0.30000000000000004, -7},
                {1e22, -0.5, 1e-7}};
  for (const char* name : {"a.xyz", "a.TXT", "a.asc", "a.csv", "a.ply", "a.pcd"}) {
    write_points(folder / name, set, context);
    CHECK(read_points(folder / name, context).points == set.points);
  }
  set.normals = {{0, 0, 1}, {0.6, -0.8, 0}, {1, 0, 0}, {std::sqrt(1.0 / 3), std::sqrt(1.0 / 3), std::sqrt(1.0 / 3)}};
  for (const char* name : {"b.xyz", "b.csv", "b.ply", "b.pcd"}) {
    write_points(folder / name, set, context);
    const PointSet back = read_points(folder / name, context);
    CHECK(back.points == set.points);
    CHECK(back.normals == set.normals);
  }
}

TEST_CASE("points: intensity, colours and further columns are written and read back exactly") {
  TemporaryFolder folder;
  Context context;
  for (const bool with_normals : {false, true}) {
    PointSet set;
    set.points = two;
    if (with_normals) set.normals = {{0, 0, 1}, {0.6, 0, -0.8}};
    set.intensity = {0.1, std::nan("")};
    set.colors = {{255, 0, 7}, {1, 128, 3}};
    set.scalars["timeStamp"] = {1e9 + 0.125, -3};
    set.scalars["curvature"] = {std::nan(""), 1.0 / 3};
    for (const char* name : {"a.xyz", "a.csv", "a.ply", "a.pcd"}) {
      CAPTURE(name);
      write_points(folder / name, set, context);
      const PointSet back = read_points(folder / name, context);
      CHECK(back.points == set.points);
      CHECK(back.normals == set.normals);
      CHECK(back.colors == set.colors);
      REQUIRE(back.intensity.size() == 2);
      CHECK(back.intensity[0] == 0.1);
      CHECK(std::isnan(back.intensity[1]));
      REQUIRE(back.scalars.size() == 2);
      CHECK(back.scalars.at("timeStamp") == set.scalars.at("timeStamp"));
      CHECK(std::isnan(back.scalars.at("curvature")[0]));
      CHECK(back.scalars.at("curvature")[1] == 1.0 / 3);
    }
  }
}

TEST_CASE("points: a header names intensity and colours in the ways of other programs") {
  for (const char* header :
       {"x y z intensity r g b", "//X Y Z Scalar_Intensity Red Green Blue", "# X Y Z Reflectance R G B"}) {
    CAPTURE(header);
    const PointSet set = points_of(std::string(header) + "\n1.5 -2 3 0.5 255 0 7\n4 5.25 -0.125 9 1 2 3\n");
    CHECK(set.points == two);
    CHECK(set.intensity == std::vector<double>{0.5, 9});
    CHECK(set.colors == std::vector<std::array<std::uint8_t, 3>>{{255, 0, 7}, {1, 2, 3}});
    CHECK(set.scalars.empty());
  }
  // Colours that are no levels stay numbers.
  const PointSet shares = points_of("x,y,z,r,g,b\n1.5,-2,3,0.5,0,1\n4,5.25,-0.125,1,1,0.25\n");
  CHECK(shares.colors.empty());
  CHECK(shares.scalars.at("b") == std::vector<double>{1, 0.25});
  CHECK(refused_points("x,y,z,r,g,b\n1.5,-2,3,5,0,1\n4,5.25,-0.125,256,1,0\n").position() == 3);
}

TEST_CASE("points: what a line lacks beside the point is NaN and counted") {
  PointsFileInfo info;
  const PointSet set =
      points_of("x,y,z,intensity,ring\n1.5,-2,3,0.5,1\n4,5.25,-0.125,,n/a\n4,5.25,-0.125,2\n", "a.csv", &info);
  REQUIRE(set.size() == 3);
  CHECK(set.intensity[0] == 0.5);
  CHECK(std::isnan(set.intensity[1]));
  CHECK(set.intensity[2] == 2);
  CHECK(std::isnan(set.scalars.at("ring")[1]));
  CHECK(std::isnan(set.scalars.at("ring")[2]));
  CHECK(has_note(info.notes, "3 values beside the coordinates"));
}

TEST_CASE("pcd: intensity, packed colours and further fields, in every encoding") {
  const std::string fields = "FIELDS x y z intensity rgb ring\nSIZE 4 4 4 4 4 2\nTYPE F F F F F U\nCOUNT 1 1 1 1 1 1\n";
  // An opaque colour is a NaN as a float; its bytes must come through.
  const std::uint32_t first = 0xFF00FF07, second = 0x010203;
  const auto check = [](const PointSet& set) {
    CHECK(set.points == two);
    CHECK(set.intensity == std::vector<double>{0.5, 2});
    CHECK(set.scalars.at("ring") == std::vector<double>{3, 65535});
    CHECK(set.colors.at(1) == std::array<std::uint8_t, 3>{1, 2, 3});
  };
  const std::string by_point =
      raw(1.5f, -2.f, 3.f, 0.5f, first, std::uint16_t{3}) + raw(4.f, 5.25f, -0.125f, 2.f, second, std::uint16_t{65535});
  PointSet set = points_of(pcd_header(fields, 2, "binary") + by_point, "a.pcd");
  check(set);
  CHECK(set.colors[0] == std::array<std::uint8_t, 3>{0, 255, 7});
  const std::string by_field =
      raw(1.5f, 4.f, -2.f, 5.25f, 3.f, -0.125f, 0.5f, 2.f, first, second, std::uint16_t{3}, std::uint16_t{65535});
  const std::string packed = lzf_literals(by_field);
  set = points_of(pcd_header(fields, 2, "binary_compressed") +
                      raw(static_cast<std::uint32_t>(packed.size()), static_cast<std::uint32_t>(by_field.size())) +
                      packed,
                  "a.pcd");
  check(set);
  CHECK(set.colors[0] == std::array<std::uint8_t, 3>{0, 255, 7});
  std::ostringstream text;
  text.precision(9);
  text << "1.5 -2 3 0.5 nan 3\n4 5.25 -0.125 2 " << std::bit_cast<float>(second) << " 65535\n";
  set = points_of(pcd_header(fields, 2, "ascii") + text.str(), "a.pcd");
  check(set);
  CHECK(set.colors[0] == std::array<std::uint8_t, 3>{0, 0, 0});  // not known
  const std::string unsigned_fields =
      "FIELDS x y z intensity rgba ring\nSIZE 4 4 4 4 4 2\nTYPE F F F F U U\nCOUNT 1 1 1 1 1 1\n";
  check(points_of(pcd_header(unsigned_fields, 2, "ascii") + "1.5 -2 3 0.5 4278255367 3\n4 5.25 -0.125 2 66051 65535\n",
                  "a.pcd"));
}

TEST_CASE("points: what cannot be written is refused and leaves nothing") {
  TemporaryFolder folder;
  Context context;
  PointSet set;
  set.points = two;
  CHECK_THROWS_AS(write_points(folder / "a.stl", set, context), InvalidInput);
  CHECK_THROWS_AS(write_points(folder / "no/a.xyz", set, context), IoError);
  set.normals = {{0, 0, 1}};
  CHECK_THROWS_AS(write_points(folder / "a.xyz", set, context), InvalidInput);
  set.normals.clear();
  set.points[1][2] = std::nan("");
  CHECK_THROWS_AS(write_points(folder / "a.xyz", set, context), InvalidInput);
  CHECK(folder.entries().empty());
}

TEST_CASE("points: real files hold the points that a plain count of lines and the headers give") {
  const char* data = std::getenv("TRI_DATA");
  if (!data) return;
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(data) / "points")) {
    const std::string path = entry.path().string();
    const std::string extension = entry.path().extension().string();
    CAPTURE(path);
    Context context;
    PointsFileInfo info;
    if (extension != ".xyz" && extension != ".pcd") continue;
    const PointSet set = read_points(path, context, &info);
    std::istringstream text(file_bytes(path));
    std::string line;
    std::size_t count = 0;
    if (extension == ".pcd") {
      while (std::getline(text, line) && count == 0)
        if (line.starts_with("POINTS")) count = std::stoul(line.substr(7));
    } else {
      // Read a second time by the standard library.
      while (std::getline(text, line)) {
        std::istringstream numbers(line);
        double x, y, z;
        REQUIRE(static_cast<bool>(numbers >> x >> y >> z));
        REQUIRE(set.points[count++] == Vec3(x, y, z));
      }
    }
    CHECK(set.points.size() + info.points_skipped == count);
    ++files;
  }
  CHECK(files > 0);
}
