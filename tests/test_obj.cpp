#include <cmath>

#include "mesh_io_helpers.hpp"

using namespace tri;
using namespace tri::test;

namespace {

const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";

}  // namespace

TEST_CASE("obj: all forms of a corner name the same vertices") {
  for (const char* face :
       {"f 1 2 3", "f 1/1 2/1 3/1", "f 1//1 2//1 3//1", "f 1/1/1 2/1/1 3/1/1", "f -4 -3 -2",
        "f -4/-1/-1 -3/-1/-1 -2/-1/-1", "f 1/ 2/ 3/", "f 1 2 3 # comment", "f \\\n1 2 \\\r\n3", "  f\t1 2   3  "}) {
    CAPTURE(face);
    const Soup soup = parsed(vertices + "vt 0 0\nvn 0 0 1\n" + face + "\n", "a.obj");
    CHECK(soup.points == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
    CHECK(soup.triangles == std::vector<Triangle>{{0, 1, 2}});
  }
}

TEST_CASE("obj: negative indices count from the vertices read so far, positive ones may come early") {
  const Soup soup = parsed("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -1 -2 -3\n", "a.obj");
  CHECK(soup.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 1, 2}, {3, 2, 1}});
}

TEST_CASE("obj: polygons are triangulated, a concave quadrilateral along its inner diagonal") {
  MeshFileInfo info;
  const Soup soup = parsed("v 0 0 0\nv 2 0 0\nv 0.5 0.5 0\nv 0 2 0\nf 4 1 2 3\nf 1 2 3 4\n", "a.obj", &info);
  REQUIRE(soup.triangles.size() == 4);
  for (const auto& t : soup.triangles) {
    const Vec3 twice = (soup.points[t[1]] - soup.points[t[0]]) % (soup.points[t[2]] - soup.points[t[0]]);
    CHECK(twice[2] > 0);
    CHECK(std::count(t.begin(), t.end(), 0u) + std::count(t.begin(), t.end(), 2u) == 2);  // the only diagonal inside
  }
  CHECK(info.polygons == 2);
  CHECK(info.polygons_split == 2);
}

TEST_CASE("obj: colours of 0 to 1 and of 0 to 255, with weights, and only if every vertex has one") {
  const Soup fractions = parsed("v 0 0 0 1 0.5 0\nv 1 0 0 0 0 0.2\nv 0 1 0 0 0 0\nf 1 2 3\n", "a.obj");
  CHECK(fractions.vertex_colors == std::vector<std::array<std::uint8_t, 3>>{{255, 128, 0}, {0, 0, 51}, {0, 0, 0}});
  CHECK(parsed("v 0 0 0 255 7 0\n", "a.obj").vertex_colors[0] == std::array<std::uint8_t, 3>{255, 7, 0});
  MeshFileInfo info;
  CHECK(parsed("v 0 0 0 1 1 1\nv 1 0 0\n", "a.obj", &info).vertex_colors.empty());
  CHECK(has_note(info.notes, "only 1 of 2 vertices have a colour"));
  CHECK(parsed("v 1 2 3 1.0\n", "a.obj", &info).points[0] == Vec3(1, 2, 3));
  CHECK(info.notes.empty());
  parsed("v 1 2 3 0.5\n", "a.obj", &info);
  CHECK(has_note(info.notes, "weights of 1"));
}

TEST_CASE("obj: normals are kept where each vertex has one of its own") {
  const Soup soup =
      parsed("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//2\nf 3//2 2//1 1//1\n", "a.obj");
  CHECK(soup.vertex_normals == std::vector<Vec3>{{0, 0, 1}, {0, 0, 1}, {0, 1, 0}});
}

TEST_CASE("obj: where a vertex has several normals they stay with the corners, and come back as they were written") {
  const std::string text = vertices + "vn 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//1\nf 1//2 2//1 4//2\nf 2 3 4\n";
  const Soup soup = parsed(text, "a.obj");
  CHECK(soup.vertex_normals.empty());
  REQUIRE(soup.triangles.size() == 3);
  CHECK(soup.corner_scalars.size() == 3);
  for (std::size_t c = 0; c < 9; ++c) {
    CAPTURE(c);
    if (c >= 6) CHECK(std::isnan(soup.corner_scalars.at("nz")[c]));
    if (c < 6) CHECK(soup.corner_scalars.at("nz")[c] == (c == 3 || c == 5 ? 0 : 1));
    if (c < 6) CHECK(soup.corner_scalars.at("ny")[c] == (c == 3 || c == 5 ? 1 : 0));
  }
  const Soup back = round_trip(soup, "a.obj");
  for (const char* name : {"nx", "ny", "nz"})
    for (std::size_t c = 0; c < 6; ++c) CHECK(back.corner_scalars.at(name)[c] == soup.corner_scalars.at(name)[c]);
}

TEST_CASE("obj: what a name cannot say, and a triangle after its part has ended, are named") {
  Soup soup = parsed(vertices + "f 1 2 3\nf 2 3 4\nf 1 2 4\n", "a.obj");
  soup.face_scalars["group"] = {0, -1, 1};
  soup.face_labels["group"] = {"two\nlines", "plain"};
  TemporaryFolder folder;
  Context context;
  const MeshWriteReport report = write_mesh(folder / "a.obj", soup, {}, context);
  CHECK(has_note(report.notes, "1 triangles without a group"));
  CHECK(has_note(report.notes, "1 names of a group"));
  CHECK(read_mesh(folder / "a.obj", context).face_labels.at("group") == std::vector<std::string>{"two lines", "plain"});
}

TEST_CASE("obj: groups become parts; what is not kept is counted") {
  MeshFileInfo info;
  parsed("mtllib a.mtl\no lid\n" + vertices + "g left right\nusemtl red\ns off\nvt 0 0\nf 1 2 3\nl 1 2\np 1\n", "a.obj",
         &info);
  CHECK(info.parts == std::vector<std::string>{"lid", "left right"});
  CHECK(has_note(info.notes, "1 l, 1 mtllib, 1 p, 1 s"));
  CHECK(has_note(info.notes, "1 texture coordinates"));
}

TEST_CASE(
    "obj: texture coordinates of corners, objects, groups and materials are kept, and come back as they were written") {
  const std::string text =
      vertices +
      "vt 0.25 0.5\nvt 1 0\nvt 0 1\nvt 0.1 0.2\n"
      "f 1/1 2/2 3/3\ng left\nusemtl red\nf 1/4 3/2 4/1\ng right\nusemtl blue\nf 2 3 4\ng left\nf 1/1 2/2 4/4\n";
  const Soup soup = parsed(text, "a.obj");
  REQUIRE(soup.triangles.size() == 4);
  CHECK(soup.face_labels.at("group") == std::vector<std::string>{"left", "right"});
  CHECK(soup.face_scalars.at("group") == std::vector<double>{-1, 0, 1, 0});
  CHECK(soup.face_labels.at("material") == std::vector<std::string>{"red", "blue"});
  CHECK(soup.face_scalars.at("material") == std::vector<double>{-1, 0, 1, 1});
  const std::vector<double>&s = soup.corner_scalars.at("s"), &t = soup.corner_scalars.at("t");
  REQUIRE(s.size() == 12);
  CHECK(s[0] == 0.25);
  CHECK(t[0] == 0.5);
  CHECK(s[3] == 0.1);
  CHECK(s[5] == 0.25);
  CHECK(std::isnan(s[6]));
  CHECK(t[11] == 0.2);
  const Soup back = round_trip(soup, "a.obj");
  CHECK(back.triangles == soup.triangles);
  CHECK(back.face_labels == soup.face_labels);
  CHECK(back.face_scalars == soup.face_scalars);
  for (std::size_t i = 0; i < 12; ++i) {
    CHECK((back.corner_scalars.at("s")[i] == s[i] || std::isnan(s[i])));
    CHECK((back.corner_scalars.at("t")[i] == t[i] || std::isnan(t[i])));
  }
}

TEST_CASE("obj: the corners of a polygon keep their texture coordinates when it is cut") {
  // A concave quadrilateral, which no fan from its first corner cuts rightly.
  const Soup soup =
      parsed("v 1 1 0\nv 0 3 0\nv 0 0 0\nv 3 0 0\nvt 1 1\nvt 0 3\nvt 0 0\nvt 3 0\nf 2/2 3/3 4/4 1/1\n", "a.obj");
  REQUIRE(soup.triangles.size() == 2);
  for (std::size_t i = 0; i < 6; ++i) {
    const Vec3& p = soup.points[soup.triangles[i / 3][i % 3]];
    CHECK(soup.corner_scalars.at("s")[i] == p[0]);
    CHECK(soup.corner_scalars.at("t")[i] == p[1]);
  }
}

TEST_CASE("obj: every bad file is refused with its line") {
  CHECK(refused(vertices + "f 1 2 5\n", "a.obj").position() == 5);
  CHECK(refused(vertices + "f 1 2 0\n", "a.obj").position() == 5);
  CHECK(refused(vertices + "f 1 2 -5\n", "a.obj").position() == 5);
  CHECK(refused(vertices + "f 1 2 99999999999\n", "a.obj").position() == 5);
  CHECK(refused(vertices + "f 1 2 99999999999999999999\n", "a.obj").position() == 5);
  CHECK(refused(vertices + "f 1 2 4294967295\n", "a.obj").position() == 5);
  CHECK(refused(vertices + "f 1 2 x\n", "a.obj").position() == 5);
  CHECK(refused(vertices + "f 1 2 3.5\n", "a.obj").position() == 5);
  CHECK(refused(vertices + "f 1/1 2/1 3/1\n", "a.obj").position() == 5);  // no texture coordinate
  CHECK(refused(vertices + "f 1//1 2//1 3//1\n", "a.obj").position() == 5);
  CHECK(refused(vertices + "f 1 \\\n2 \\\n9\n", "a.obj").position() == 7);  // lines of the file, continued or not
  CHECK(refused("v 0 0 nan\n", "a.obj").position() == 1);
  CHECK(refused("# c\nv 0 0 1e400\n", "a.obj").position() == 2);
  CHECK(refused("v 0 0\nv 0 0 0\n", "a.obj").position() == 1);
  CHECK(refused("v 0 0 0 1 2 300\n", "a.obj").position() == 1);
  CHECK(refused("v 0 0 0\nhello world\n", "a.obj").position() == 2);
  CHECK(refused("# nothing\n", "a.obj").unit() == IoError::Unit::line);
  CHECK(refused("", "a.obj").unit() == IoError::Unit::none);
}

TEST_CASE("obj: writes and reads back exactly, colours and normals too") {
  Soup soup = awkward_soup();
  check_same_geometry(round_trip(soup, "a.obj"), soup);
  for (std::size_t i = 0; i < soup.points.size(); ++i) {
    soup.vertex_colors.push_back({static_cast<std::uint8_t>(i * 51), static_cast<std::uint8_t>(255 - i), 3});
    soup.vertex_normals.emplace_back(0, std::sin(i), std::cos(i));
  }
  const Soup back = round_trip(soup, "a.obj");
  check_same_geometry(back, soup);
  CHECK(back.vertex_colors == soup.vertex_colors);
  CHECK(back.vertex_normals == soup.vertex_normals);
}

TEST_CASE("mesh files: an unknown kind is refused and says what it looks like") {
  CHECK(std::string(refused("ISO-10303-21;\nHEADER;\n", "a.xyz").what()).find("STEP") != std::string::npos);
  CHECK(std::string(refused("\x1f\x8b\x08", "a.dat").what()).find("compressed") != std::string::npos);
  CHECK(refused("1 2 3\n", "a.xyz").unit() == IoError::Unit::none);
  CHECK(parsed("# x\nv 1 2 3\n", "noname").points.size() == 1);
}

TEST_CASE("mesh files: an inconsistent soup is refused before anything is written") {
  TemporaryFolder folder;
  Context context;
  const auto refuse = [&](auto&& change) {
    Soup soup = awkward_soup();
    change(soup);
    CHECK_THROWS_AS(write_mesh(folder / "a.ply", soup, {}, context), InvalidInput);
  };
  refuse([](Soup& s) { s.triangles[1][2] = 6; });
  refuse([](Soup& s) { s.points[2][1] = std::nan(""); });
  refuse([](Soup& s) { s.vertex_colors.resize(2); });
  refuse([](Soup& s) { s.vertex_normals.resize(7); });
  refuse([](Soup& s) { s.vertex_scalars["q"] = {1}; });
  refuse([](Soup& s) { s.face_scalars["q"] = {1}; });
  refuse([](Soup& s) { s.vertex_scalars["x"].resize(6); });
  refuse([](Soup& s) { s.vertex_scalars["two words"].resize(6); });
  CHECK_THROWS_AS(write_mesh(folder / "a.xyz", awkward_soup(), {}, context), InvalidInput);
  CHECK_THROWS_AS(write_mesh(folder / "none/a.ply", awkward_soup(), {}, context), IoError);
  CHECK(folder.entries().empty());
}

TEST_CASE("mesh files: a cancelled read or write throws and leaves nothing") {
  TemporaryFolder folder;
  Context context;
  const Soup soup = parsed(vertices + "f 1 2 3\n", "a.obj");
  context.cancel();
  for (const char* name : {"a.stl", "a.obj", "a.ply", "a.off"})
    CHECK_THROWS_AS(write_mesh(folder / name, soup, {}, context), Cancelled);
  CHECK_THROWS_AS(parse_mesh(vertices, "a.obj", context), Cancelled);
  CHECK(folder.entries().empty());
}
