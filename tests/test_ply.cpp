#include <algorithm>
#include <limits>

#include "mesh_io_helpers.hpp"

using namespace tri;
using namespace tri::test;

namespace {

const std::string header_tail =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int "
    "vertex_indices\nend_header\n";
const std::string ascii_ply = "ply\nformat ascii 1.0\n" + header_tail + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

std::string binary_triangle() {
  return "ply\nformat binary_little_endian 1.0\n" + header_tail +
         raw(0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, std::uint8_t{3}, 0, 1, 2);
}

void check_triangle(const Soup& soup) {
  CHECK(soup.points == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  CHECK(soup.triangles == std::vector<Triangle>{{0, 1, 2}});
}

}  // namespace

TEST_CASE("ply: ASCII and both binary orders give the same soup") {
  MeshFileInfo info;
  check_triangle(parsed(ascii_ply, "a.ply", &info));
  CHECK(info.encoding == MeshEncoding::ascii);
  check_triangle(parsed(binary_triangle(), "a.ply", &info));
  CHECK(info.encoding == MeshEncoding::binary_little_endian);
  check_triangle(parsed("ply\nformat binary_big_endian 1.0\n" + header_tail +
                            raw_big(0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, std::uint8_t{3}, 0, 1, 2),
                        "a.dat", &info));
  CHECK(info.encoding == MeshEncoding::binary_big_endian);
  CHECK(info.notes.empty());
}

TEST_CASE("ply: lines may end in CRLF or in CR, and the body may begin with a byte that looks like a line end") {
  const auto with_ends = [](std::string text, const std::string& end) {
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += end.size())
      text.replace(at, 1, end);
    return text;
  };
  for (const char* end : {"\r\n", "\r"}) {
    check_triangle(parsed(with_ends(ascii_ply, end), "a.ply"));
    std::string header =
        "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar x\nproperty uchar y\nproperty uchar "
        "z\nend_header\n";
    for (const char first : {'\n', '\r'}) {
      const Soup soup = parsed(with_ends(header, end) + first + "\x02\x03", "a.ply");
      CHECK(soup.points == std::vector<Vec3>{{double(first), 2, 3}});
    }
  }
}

TEST_CASE("ply: every scalar type, under both of its names, in both binary orders") {
  const std::array<std::array<const char*, 2>, 8> names{{{"char", "int8"},
                                                         {"uchar", "uint8"},
                                                         {"short", "int16"},
                                                         {"ushort", "uint16"},
                                                         {"int", "int32"},
                                                         {"uint", "uint32"},
                                                         {"float", "float32"},
                                                         {"double", "float64"}}};
  for (const std::size_t style : {0u, 1u}) {
    std::string header = "element vertex 1\nproperty double x\nproperty double y\nproperty double z\n";
    for (std::size_t i = 0; i < 8; ++i)
      header += std::string("property ") + names[i][style] + " s" + std::to_string(i) + "\n";
    header += "end_header\n";
    const auto check = [](const Soup& soup) {
      CHECK(soup.points[0] == Vec3(0.1, 0.2, 0.3));
      const double expected[] = {-5, 250, -300, 65000, -70000, 4e9, -1.5, 1e-200};
      for (std::size_t i = 0; i < 8; ++i)
        CHECK(soup.vertex_scalars.at(std::string{'s', char('0' + i)})[0] == expected[i]);
    };
    const auto values = [](auto bytes) {
      return bytes(0.1, 0.2, 0.3, std::int8_t{-5}, std::uint8_t{250}, std::int16_t{-300}, std::uint16_t{65000},
                   std::int32_t{-70000}, std::uint32_t{4'000'000'000}, -1.5f, 1e-200);
    };
    check(parsed("ply\nformat binary_little_endian 1.0\n" + header + values([](auto... v) { return raw(v...); }),
                 "a.ply"));
    check(parsed("ply\nformat binary_big_endian 1.0\n" + header + values([](auto... v) { return raw_big(v...); }),
                 "a.ply"));
    check(parsed("ply\nformat ascii 1.0\n" + header + "0.1 0.2 0.3 -5 250 -300 65000 -70000 4000000000 -1.5 1e-200\n",
                 "a.ply"));
  }
}

TEST_CASE("ply: unknown elements, properties and lists are skipped by their declared size") {
  const std::string header =
      "comment all kinds\nobj_info x\nelement camera 2\nproperty float fov\nproperty list ushort double matrix\n"
      "element vertex 3\nproperty list uchar short neighbours\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty uchar flag\nproperty list uchar float texcoord\nproperty list int uint "
      "vertex_index\nproperty short group\n"
      "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n";
  const std::string body =
      raw(1.f, std::uint16_t{2}, 1., 2.) + raw(2.f, std::uint16_t{0}) +  // camera
      raw(std::uint8_t{1}, std::int16_t{7}, 0.f, 0.f, 0.f) + raw(std::uint8_t{0}, 1.f, 0.f, 0.f) +
      raw(std::uint8_t{0}, 0.f, 1.f, 0.f) +                                                             // vertices
      raw(std::uint8_t{9}, std::uint8_t{2}, .5f, .5f, std::int32_t{3}, 0u, 1u, 2u, std::int16_t{-4}) +  // face
      raw(0, 1);
  MeshFileInfo info;
  const Soup soup = parsed("ply\nformat binary_little_endian 1.0\n" + header + body, "a.ply", &info);
  check_triangle(soup);
  CHECK(soup.face_scalars.at("flag") == std::vector<double>{9});
  CHECK(soup.face_scalars.at("group") == std::vector<double>{-4});
  CHECK(has_note(info.notes, "2 elements camera"));
  CHECK(has_note(info.notes, "1 elements edge"));
  CHECK(has_note(info.notes, "texcoord"));
  CHECK(has_note(info.notes, "neighbours"));
  const std::string text = "1 2 1 2\n2 0\n1 7 0 0 0\n0 1 0 0\n0 0 1 0\n9 2 .5 .5 3 0 1 2 -4\n0 1\n";
  check_triangle(parsed("ply\nformat ascii 1.0\n" + header + text, "a.ply"));
}

TEST_CASE("ply: the face element may come before the vertices; polygons repeat their scalars") {
  const Soup soup = parsed(
      "ply\nformat ascii 1.0\nelement face 2\nproperty list uchar int vertex_indices\nproperty int part\nelement "
      "vertex 4\n"
      "property float x\nproperty float y\nproperty float z\nend_header\n4 0 1 2 3 8\n3 0 1 2 9\n0 0 0\n1 0 0\n1 1 "
      "0\n0 1 0\n",
      "a.ply");
  CHECK(soup.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}});
  CHECK(soup.face_scalars.at("part") == std::vector<double>{8, 8, 9});
}

TEST_CASE("ply: colours, normals and further scalars of vertices are kept") {
  const Soup soup = parsed(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\nproperty "
      "float nx\nproperty float "
      "ny\nproperty float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar "
      "alpha\nproperty float quality\n"
      "end_header\n1 2 3 0 0 1 10 20 30 40 nan\n",
      "a.ply");
  CHECK(soup.vertex_normals == std::vector<Vec3>{{0, 0, 1}});
  CHECK(soup.vertex_colors == std::vector<std::array<std::uint8_t, 3>>{{10, 20, 30}});
  CHECK(soup.vertex_scalars.at("alpha")[0] == 40);
  CHECK(std::isnan(soup.vertex_scalars.at("quality")[0]));  // a scalar may be unknown, a coordinate may not
  CHECK(soup.vertex_scalars.size() == 2);
}

TEST_CASE("ply: triangle strips turn alternately and restart at -1") {
  const Soup soup = parsed(
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nelement "
      "tristrips 1\nproperty list int int "
      "vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 2\n8 0 1 2 3 -1 2 3 4\n",
      "a.ply");
  CHECK(soup.triangles == std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}});
}

TEST_CASE("ply: every bad header is refused with its line") {
  const auto header = [](const std::string& lines) {
    return "ply\nformat ascii 1.0\n" + lines + "end_header\n0 0 0\n";
  };
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  CHECK(refused(header("element vertex 1\nproperty quad x\n"), "a.ply").position() == 4);
  CHECK(refused(header("property float x\n"), "a.ply").position() == 3);
  CHECK(refused(header("element vertex -1\n" + xyz), "a.ply").position() == 3);
  CHECK(refused(header("element vertex many\n" + xyz), "a.ply").position() == 3);
  CHECK(refused(header("elephant vertex 1\n" + xyz), "a.ply").position() == 3);
  CHECK(refused(header("element vertex 1\nproperty float x\nproperty float x\n"), "a.ply").position() == 5);
  CHECK(refused(header("element vertex 1\n" + xyz + "element vertex 1\n"), "a.ply").position() == 7);
  CHECK(refused(header("element vertex 1\nproperty float x\nproperty float y\n"), "a.ply").position() == 6);
  CHECK(refused(header("element corner 1\n" + xyz), "a.ply").position() == 7);
  CHECK(refused("ply\nformat ascii 2.0\n" + header_tail, "a.ply").position() == 2);
  CHECK(refused("ply\nformat binary_pdp_endian 1.0\n" + header_tail, "a.ply").position() == 2);
  CHECK(refused("ply\n" + header_tail, "a.ply").unit() == IoError::Unit::line);
  CHECK(refused("ply", "a.ply").unit() == IoError::Unit::line);
  CHECK(refused("plx\n", "a.ply").position() == 1);
}

TEST_CASE("ply: a line of text in the header that is none of PLY is skipped and said") {
  const auto with = [](std::string text, const std::string& line) {
    return text.insert(text.find("element vertex"), line + "\n");
  };
  for (const char* line : {"Created by Blender3D 247 - www.blender.org, source file: ", "made on 3 May 2009",
                           "\tComment", "Erzeugt f\xc3\xbcr Dich"}) {
    CAPTURE(line);
    for (const std::string& text : {ascii_ply, binary_triangle()}) {
      MeshFileInfo info;
      check_triangle(parsed(with(text, line), "a.ply", &info));
      REQUIRE(info.notes.size() == 1);
      CHECK(has_note(info.notes, "line 3 of the header"));
    }
  }
  std::string many;
  for (int i = 0; i < 5000; ++i) many += "nothing\n";
  MeshFileInfo info;
  check_triangle(parsed(with(ascii_ply, many), "a.ply", &info));
  CHECK(info.notes.size() == 11);
}

TEST_CASE("ply: a line of the header that may be a damaged one is refused") {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  for (const std::string line :
       {"elment vertex 1", "Element vertex 1", "elephant vertex 1", "propery short a", "xx uchar red",
        "p list uchar int vertex_indices", "comm\x01nt", "Created\x7f by", "formt ascii 1.0", "end_headr"}) {
    CAPTURE(line);
    const std::string text = "ply\nformat ascii 1.0\nelement vertex 1\n" + xyz + line + "\nend_header\n0 0 0\n";
    CHECK(refused(text, "a.ply").position() == 7);
  }
  // A body that was taken for the header: bytes, or an end that never comes.
  CHECK(refused("ply\nformat ascii 1.0\n" + raw(1.f, 2.f, 3.f) + "\nend_header\n", "a.ply").position() == 3);
  CHECK(refused("ply\nformat ascii 1.0\nCreated by", "a.ply").unit() == IoError::Unit::line);
}

TEST_CASE("ply: absurd counts are refused before memory is asked for") {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  for (const char* count : {"4000000000", "9223372036854775807", "1000000000000"})
    for (const char* format : {"ascii", "binary_little_endian"}) {
      refused(
          std::string("ply\nformat ") + format + " 1.0\nelement vertex " + count + "\n" + xyz + "end_header\n0 0 0\n",
          "a.ply");
      refused(std::string("ply\nformat ") + format + " 1.0\nelement vertex 0\n" + xyz + "element face " + count +
                  "\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n",
              "a.ply");
    }
  std::string huge_list = binary_triangle();
  const std::size_t at = huge_list.find("uchar int");
  huge_list.replace(at, 9, "uint8 int");
  huge_list[huge_list.size() - 13] = static_cast<char>(255);
  CHECK(refused(huge_list, "a.ply").unit() == IoError::Unit::byte);
}

TEST_CASE("ply: every bad body is refused with its line or byte") {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = ascii_ply;
    text.replace(text.rfind(from), from.size(), to);
    return text;
  };
  CHECK(refused(with("1 0 0", "1 nan 0"), "a.ply").position() == 11);
  CHECK(refused(with("1 0 0", "1 inf 0"), "a.ply").position() == 11);
  CHECK(refused(with("1 0 0", "1 0"), "a.ply").position() == 11);
  CHECK(refused(with("1 0 0", "1 0 x"), "a.ply").position() == 11);
  CHECK(refused(with("3 0 1 2", "3 0 1 3"), "a.ply").position() == 13);
  CHECK(refused(with("3 0 1 2", "3 0 1 -1"), "a.ply").position() == 13);
  CHECK(refused(with("3 0 1 2", "3 0 1 1.5"), "a.ply").position() == 13);
  CHECK(refused(with("3 0 1 2", "4 0 1 2"), "a.ply").position() == 13);
  CHECK(refused(with("3 0 1 2", "-3 0 1 2"), "a.ply").position() == 13);
  check_truncations(ascii_ply, "a.ply", 2);

  const std::string good = binary_triangle();
  const std::size_t body = good.find("end_header\n") + 11;
  check_truncations(good, "a.ply", 0);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()}) {
    std::string text = good;
    text.replace(body + 16, 4, raw(bad));
    CHECK(refused(text, "a.ply").position() == body + 16);
  }
  std::string text = good;
  text.replace(body + 36 + 1 + 8, 4, raw(3));
  CHECK(refused(text, "a.ply").position() == body + 36 + 1 + 8);
}

TEST_CASE("ply: what follows the last element is said") {
  MeshFileInfo info;
  check_triangle(parsed(ascii_ply + "4 5 6\n", "a.ply", &info));
  CHECK(has_note(info.notes, "after the last element") == false);
  CHECK(has_note(info.notes, "follows the last element"));
  check_triangle(parsed(binary_triangle() + "xx", "a.ply", &info));
  CHECK(has_note(info.notes, "2 bytes after the last element"));
}

TEST_CASE("ply: writes and reads back exactly, attributes too, as text and as bytes") {
  Soup soup = awkward_soup();
  const std::size_t n = soup.points.size();
  for (const bool ascii : {false, true}) check_same_geometry(round_trip(soup, "a.ply", ascii), soup);
  soup.vertex_scalars["point_index"] = {5, 4, 3, 2, 1, -1};
  soup.vertex_scalars["cad_face"] = {1, 2, 3, 4, 5, 0};
  soup.vertex_scalars["deviation"] = {0.1, -0.2, 1e-17, std::numeric_limits<double>::infinity(), 0, -0.0};
  soup.vertex_scalars["a_first"] = std::vector<double>(n, 0.25);
  soup.face_scalars["group"] = {1, 2, 3, 4, 5.5};
  soup.face_scalars["red"] = {0, 1, 2, 3, 255};
  soup.vertex_colors.assign(n, {0, 127, 255});
  soup.vertex_normals.assign(n, Vec3(0.6, 0, -0.8));
  for (const bool ascii : {false, true}) {
    const Soup back = round_trip(soup, "a.ply", ascii);
    check_same_geometry(back, soup);
    CHECK(back.vertex_scalars == soup.vertex_scalars);
    CHECK(back.face_scalars == soup.face_scalars);
    CHECK(back.vertex_colors == soup.vertex_colors);
    CHECK(back.vertex_normals == soup.vertex_normals);
  }
  TemporaryFolder folder;
  Context context;
  write_mesh(folder / "a.ply", soup, {}, context);
  const std::string bytes = file_bytes(folder / "a.ply");
  CHECK(bytes.substr(0, bytes.find("end_header")) ==
        "ply\nformat binary_little_endian 1.0\ncomment written by tri\nelement vertex 6\nproperty double x\nproperty "
        "double y\nproperty double z\n"
        "property double nx\nproperty double ny\nproperty double nz\nproperty int point_index\nproperty int "
        "cad_face\nproperty double deviation\n"
        "property double a_first\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 5\n"
        "property list uchar int vertex_indices\nproperty double group\nproperty uchar red\n");
}

TEST_CASE("ply: an index column that is no integer stays a double") {
  Soup soup = awkward_soup();
  soup.vertex_scalars["point_index"] = {5, 4.5, 3, 2, 1, 0};
  CHECK(round_trip(soup, "a.ply").vertex_scalars == soup.vertex_scalars);
}

TEST_CASE("mesh files: a half-edge mesh is written with its properties, without deleted faces") {
  Mesh mesh;
  const auto v0 = mesh.add_vertex({0, 0, 0}), v1 = mesh.add_vertex({1, 0, 0}), v2 = mesh.add_vertex({0, 1, 0}),
             v3 = mesh.add_vertex({1, 1, 0});
  mesh.add_face(v0, v1, v2);
  mesh.delete_face(mesh.add_face(v1, v3, v2), false);
  OpenMesh::VPropHandleT<int> index;
  mesh.add_property(index, property::point_index);
  for (int i = 0; i < 4; ++i) mesh.property(index, VertexHandle(i)) = 10 - i;
  TemporaryFolder folder;
  Context context;
  write_mesh(folder / "a.ply", view_of(mesh), {}, context);
  const Soup soup = read_mesh(folder / "a.ply", context);
  CHECK(soup.points == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
  REQUIRE(soup.triangles.size() == 1);
  Triangle turned = soup.triangles[0];  // a face keeps its sense, not its first corner
  std::rotate(turned.begin(), std::find(turned.begin(), turned.end(), 0u), turned.end());
  CHECK(turned == Triangle{0, 1, 2});
  CHECK(soup.vertex_scalars.at("point_index") == std::vector<double>{10, 9, 8, 7});
}

TEST_CASE("ply: an empty mesh is written and read") {
  const Soup back = round_trip(Soup{}, "a.ply");
  CHECK(back.points.empty());
  CHECK(back.triangles.empty());
}

TEST_CASE("ply: texture coordinates of corners are kept, also by polygons, and written again") {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  const Soup soup = parsed(header + "4 0 1 2 3 8 0 0 0.5 0 0.5 0.5 0 0.5\n3 0 1 2 0\n", "a.ply");
  REQUIRE(soup.triangles.size() == 3);
  for (std::size_t i = 0; i < 6; ++i) {
    const Vec3& p = soup.points[soup.triangles[i / 3][i % 3]];
    CHECK(soup.corner_scalars.at("s")[i] == p[0] / 2);
    CHECK(soup.corner_scalars.at("t")[i] == p[1] / 2);
  }
  CHECK(std::isnan(soup.corner_scalars.at("s")[6]));
  for (const bool ascii : {false, true}) {
    const Soup back = round_trip(soup, "a.ply", ascii);
    for (std::size_t i = 0; i < 6; ++i) CHECK(back.corner_scalars.at("t")[i] == soup.corner_scalars.at("t")[i]);
    CHECK(std::isnan(back.corner_scalars.at("t")[8]));
  }
  MeshFileInfo info;
  CHECK(parsed(header + "4 0 1 2 3 3 0 0 1\n3 0 1 2 0\n", "a.ply", &info).corner_scalars.empty());
  CHECK(has_note(info.notes, "lists texcoord of 1 faces"));
}
