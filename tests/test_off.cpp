#include <cmath>

#include "mesh_io_helpers.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

const std::string triangle_off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

}  // namespace

TEST_CASE("off: comments, blank lines, counts on the first line, CRLF, missing edges") {
  for (const char* text :
       {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2",
        "# made by\n\nOFF # key\n# counts\n3 1\n\n0 0 0 # first\n1 0 0\n# mid\n0 1 0\n3 0 1 2 # f\n#end",
        "OFF\r\n3 1 0\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2\r\n",
        "\xEF\xBB\xBFOFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "OFF\r3 1 0\r0 0 0\r1 0 0\r0 1 0\r3 0 1 2\r",
        "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"}) {
    CAPTURE(text);
    const Soup soup = parsed(text, "a.off");
    CHECK(soup.points == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    CHECK(soup.triangles == std::vector<Triangle>{{0, 1, 2}});
  }
}

TEST_CASE("off: polygons are triangulated, edges counted, vertices without a face kept") {
  MeshFileInfo info;
  const Soup soup =
      parsed("OFF\n6 4 0\n0 0 0\n2 0 0\n2 2 0\n1 0.5 0\n0 2 0\n9 9 9\n4 0 1 2 4\n2 0 1\n5 0 1 2 3 4\n3 0 0 0\n",
             "a.off", &info);
  CHECK(soup.points.size() == 6);
  REQUIRE(soup.triangles.size() == 6);
  CHECK(soup.triangles[0] == Triangle{0, 1, 2});
  CHECK(soup.triangles[1] == Triangle{0, 2, 4});
  CHECK(soup.triangles[5] == Triangle{0, 0, 0});
  // The pentagon with a notch at (1, 0.5): three triangles that turn left and cover its area of 4 - 1.5.
  double area = 0;
  for (std::size_t i = 2; i < 5; ++i) {
    const auto& t = soup.triangles[i];
    const Vec3 twice = (soup.points[t[1]] - soup.points[t[0]]) % (soup.points[t[2]] - soup.points[t[0]]);
    CHECK(twice[2] > 0);
    area += twice[2] / 2;
  }
  CHECK(area == doctest::Approx(2.5));
  CHECK(info.polygons == 3);
  CHECK(info.polygons_split == 2);
  CHECK(has_note(info.notes, "1 faces of fewer than three corners"));
}

TEST_CASE("off: a polygon with a hole joined by a slit is cut without overlap, in any plane") {
  // A square of side 4 with a square hole of side 2, reached from corner 0 along a slit that is walked twice.
  const double outline[10][2] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}};
  for (int axis = 0; axis < 3; ++axis) {
    std::string text = "OFF\n10 1 0\n";
    for (const auto& p : outline) {
      double xyz[3] = {5, 5, 5};
      xyz[(axis + 1) % 3] = p[0];
      xyz[(axis + 2) % 3] = p[1];
      text += std::to_string(xyz[0]) + " " + std::to_string(xyz[1]) + " " + std::to_string(xyz[2]) + "\n";
    }
    const Soup soup = parsed(text + "10 0 1 2 3 4 5 6 7 8 9\n", "a.off");
    double area = 0, signed_area = 0;
    for (const auto& t : soup.triangles) {
      const Vec3 twice = (soup.points[t[1]] - soup.points[t[0]]) % (soup.points[t[2]] - soup.points[t[0]]);
      area += twice.norm() / 2;
      signed_area += twice[axis] / 2;
    }
    CHECK(soup.triangles.size() == 8);
    CHECK(area == doctest::Approx(12));
    CHECK(signed_area == doctest::Approx(12));
  }
}

TEST_CASE("off: an outline that crosses itself or is too large is cut all the same, with a note") {
  MeshFileInfo info;
  const Soup bow = parsed("OFF\n4 1 0\n0 0 0\n2 2 0\n2 0 0\n0 1 0\n4 0 1 2 3\n", "a.off", &info);
  CHECK(bow.triangles.size() == 2);
  CHECK(has_note(info.notes, "crosses itself"));

  std::string star = "OFF\n5000 1 0\n", face = "5000";
  for (int i = 0; i < 5000; ++i) {
    const double radius = i % 2 ? 1 : 2, angle = i * 2 * 3.14159265358979 / 5000;
    star += std::to_string(radius * std::cos(angle)) + " " + std::to_string(radius * std::sin(angle)) + " 0\n";
    (face += ' ') += std::to_string(i);
  }
  CHECK(parsed(star + face + "\n", "a.off", &info).triangles.size() == 4998);
  CHECK(has_note(info.notes, "more than 2000 corners"));
}

TEST_CASE("off: colours count to 255 or to 1, normals come before them") {
  CHECK(parsed("COFF\n1 0 0\n0 0 0 255 128 0 255\n", "a.off").vertex_colors[0] ==
        std::array<std::uint8_t, 3>{255, 128, 0});
  CHECK(parsed("COFF\n1 0 0\n0 0 0 1 0.5 0 1\n", "a.off").vertex_colors[0] == std::array<std::uint8_t, 3>{255, 128, 0});
  CHECK(parsed("COFF\n1 0 0\n0 0 0 1 0 0\n", "a.off").vertex_colors[0] == std::array<std::uint8_t, 3>{255, 0, 0});
  CHECK(parsed("COFF\n1 0 0\n0 0 0 1 0 0 255\n", "a.off").vertex_colors[0] == std::array<std::uint8_t, 3>{1, 0, 0});
  const Soup soup = parsed("STCNOFF\n1 0 0\n1 2 3 0 0 1 10 20 30 0.5 0.25\n", "a.off");
  CHECK(soup.points[0] == Vec3(1, 2, 3));
  CHECK(soup.vertex_normals[0] == Vec3(0, 0, 1));
  CHECK(soup.vertex_colors[0] == std::array<std::uint8_t, 3>{10, 20, 30});
}

TEST_CASE("off: every bad file is refused with its line") {
  CHECK(refused("OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "a.off").position() == 4);
  CHECK(refused("OFF\n3 1 0\n0 0 0\n1 inf 0\n0 1 0\n3 0 1 2\n", "a.off").position() == 4);
  CHECK(refused("OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "a.off").position() == 4);
  CHECK(refused("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "a.off").position() == 6);
  CHECK(refused("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "a.off").position() == 6);
  CHECK(refused("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", "a.off").position() == 6);
  CHECK(refused("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", "a.off").position() == 6);
  CHECK(refused("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n999999999 0 1 2\n", "a.off").position() == 6);
  CHECK(refused("OFF\n4000000000 1 0\n0 0 0\n", "a.off").unit() == IoError::Unit::line);
  CHECK(refused("OFF\n3 4000000000 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "a.off").unit() == IoError::Unit::line);
  CHECK(refused("OFF\n-1 0 0\n", "a.off").position() == 2);
  CHECK(refused("OFF\n99999999999999999999 0 0\n", "a.off").position() == 2);
  CHECK(refused("4OFF\n1 0 0\n0 0 0 0\n", "a.off").position() == 1);
  CHECK(refused("OFF BINARY\n1 0 0\n", "a.off").position() == 1);
  CHECK(refused("COFF\n1 0 0\n0 0 0 300 0 0\n", "a.off").position() == 3);
  CHECK(refused("garbage", "a.off").position() == 1);
  check_truncations(triangle_off, "a.off", 2);
}

TEST_CASE("off: writes and reads back exactly, colours and normals too") {
  Soup soup = awkward_soup();
  check_same_geometry(round_trip(soup, "a.off"), soup);
  soup.vertex_colors.assign(soup.points.size(), {1, 0, 1});
  soup.vertex_normals.assign(soup.points.size(), Vec3(0.6, 0, 0.8));
  const Soup back = round_trip(soup, "a.off");
  check_same_geometry(back, soup);
  CHECK(back.vertex_colors == soup.vertex_colors);
  CHECK(back.vertex_normals == soup.vertex_normals);
}

TEST_CASE("off: colours of faces, in both scales, on polygons, and faces without one") {
  MeshFileInfo info;
  const Soup soup =
      parsed("OFF\n4 4 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 1.0 0.5 0.0\n3 0 1 2\n3 0 1 3 0 0 1.0 0.5\n3 0 1 2 7\n",
             "a.off", &info);
  REQUIRE(soup.triangles.size() == 5);
  const auto& green = soup.face_scalars.at("green");
  CHECK(soup.face_scalars.at("red")[0] == 255);
  CHECK(green[0] == 128);
  CHECK(green[1] == 128);
  CHECK(std::isnan(green[2]));
  CHECK(soup.face_scalars.at("blue")[3] == 255);
  CHECK(std::isnan(green[4]));
  CHECK(has_note(info.notes, "the colours of 1 faces, places in a colour map"));
  CHECK(has_note(info.notes, "the transparency of 1 colours"));
  const Soup back = round_trip(soup, "a.off");
  for (const char* name : {"red", "green", "blue"})
    for (std::size_t i = 0; i < 5; ++i)
      CHECK((back.face_scalars.at(name)[i] == soup.face_scalars.at(name)[i] ||
             std::isnan(soup.face_scalars.at(name)[i])));
  CHECK(refused("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 300 0 0\n", "a.off").position() == 6);
}

TEST_CASE("off: texture coordinates of vertices become those of corners and come back") {
  const Soup soup = parsed(
      "STCNOFF\n3 1 0\n0 0 0 0 0 1 255 0 0 255 0.1 0.2\n1 0 0 0 0 1 0 255 0 255 0.3 0.4\n0 1 0 0 0 1 0 0 9 255 0.5 0.6\n3 2 0 1\n",
      "a.off");
  CHECK(soup.corner_scalars.at("s") == std::vector<double>{0.5, 0.1, 0.3});
  CHECK(soup.corner_scalars.at("t") == std::vector<double>{0.6, 0.2, 0.4});
  CHECK(soup.vertex_colors[1] == std::array<std::uint8_t, 3>{0, 255, 0});
  CHECK(same_soup(round_trip(soup, "a.off"), soup));
  CHECK(std::string(refused("STOFF\n1 0 0\n0 0 0 1\n", "a.off").what()).find("no texture coordinates") !=
        std::string::npos);
}
