#include <fstream>
#include <limits>
#include <set>
#include <sstream>

#include "mesh_io_helpers.hpp"

using namespace tri;
using namespace tri::test;

namespace {

std::string facet_bytes(const std::array<float, 9>& corners, std::uint16_t attribute = 0) {
  return raw(0.f, 0.f, 0.f, corners, attribute);
}

std::string binary_stl(const std::string& header, const std::vector<std::string>& facets) {
  std::string out = header;
  out.resize(80, ' ');
  out += raw(static_cast<std::uint32_t>(facets.size()));
  for (const auto& facet : facets) out += facet;
  return out;
}

const std::array<float, 9> first_facet{0, 0, 0, 1, 0, 0, 0, 1, 0};
const std::array<float, 9> second_facet{1, 0, 0, 1, 1, 0, 0, 1, 0};

const std::string ascii_facet =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n";

}  // namespace

TEST_CASE("stl: binary corners with identical coordinates become one vertex, by first occurrence") {
  MeshFileInfo info;
  const Soup soup = parsed(binary_stl("a part", {facet_bytes(first_facet), facet_bytes(second_facet)}), "a.stl", &info);
  CHECK(soup.points == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
  CHECK(soup.triangles == std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}});
  CHECK(info.format == MeshFormat::stl);
  CHECK(info.encoding == MeshEncoding::binary_little_endian);
  CHECK(info.polygons == 2);
  CHECK(info.notes.empty());
}

TEST_CASE("stl: zero and minus zero are one vertex; neighbouring floats are two") {
  const float next = std::nextafter(1.f, 2.f);
  const Soup soup = parsed(
      binary_stl("", {facet_bytes({0, 0, 0, 1, 0, 0, 0, 1, 0}), facet_bytes({-0.f, 0, -0.f, next, 0, 0, 0, 1, 0})}),
      "a.stl");
  CHECK(soup.points.size() == 4);
  CHECK(soup.triangles[1] == Triangle{0, 3, 2});
}

TEST_CASE("stl: welding many corners agrees with a set of the coordinates") {
  std::vector<std::string> facets;
  std::set<std::array<float, 3>> expected;
  for (int i = 0; i < 2000; ++i) {
    std::array<float, 9> corners;
    for (int k = 0; k < 9; ++k) corners[k] = static_cast<float>((i * 7919 + k * 104729) % 17) * 0.25f - 2.f;
    for (int k = 0; k < 9; k += 3) expected.insert({corners[k], corners[k + 1], corners[k + 2]});
    facets.push_back(facet_bytes(corners));
  }
  const Soup soup = parsed(binary_stl("", facets), "a.stl");
  CHECK(soup.points.size() == expected.size());
  REQUIRE(soup.triangles.size() == 2000);
  for (int i = 0; i < 2000; ++i)
    for (int k = 0; k < 3; ++k)
      CHECK(soup.points[soup.triangles[i][k]][0] == static_cast<double>((i * 7919 + 3 * k * 104729) % 17) * 0.25 - 2);
}

TEST_CASE("stl: degenerate and duplicate facets are kept") {
  const std::array<float, 9> point{1, 1, 1, 1, 1, 1, 1, 1, 1};
  const Soup soup =
      parsed(binary_stl("", {facet_bytes(first_facet), facet_bytes(first_facet), facet_bytes(point)}), "a.stl");
  CHECK(soup.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 1, 2}, {3, 3, 3}});
}

TEST_CASE("stl: a binary file that begins with solid is read as binary") {
  const Soup soup = parsed(binary_stl("solid facet normal", {facet_bytes(first_facet)}), "a.stl");
  CHECK(soup.triangles.size() == 1);
  // Also when bytes follow, which the size does not explain.
  MeshFileInfo info;
  CHECK(parsed(binary_stl(std::string("solid\0", 6), {facet_bytes(first_facet)}) + "tail", "a.stl", &info)
            .triangles.size() == 1);
  CHECK(has_note(info.notes, "4 bytes after the last facet"));
}

TEST_CASE("stl: the content decides over the extension") {
  CHECK(parsed(binary_stl("", {facet_bytes(first_facet)}), "a.obj").triangles.size() == 1);
  CHECK(parsed("solid x\n" + ascii_facet + "endsolid x\n", "noname").triangles.size() == 1);
}

TEST_CASE("stl: ASCII with several solids, upper case, odd blanks, CRLF and normals that are no numbers") {
  MeshFileInfo info;
  const std::string text =
      "\r\n  SOLID first part\r\n\tFACET NORMAL -nan(ind) nan inf\r\nOUTER  LOOP\r\nVERTEX +0 .0 -0e3\r\nvertex 1.e0 0 "
      "0 \r\n"
      "vertex 0 1 0\r\nENDLOOP\r\nENDFACET\r\nENDSOLID first part\r\n\r\nsolid\r\n" +
      ascii_facet + "endsolid\r\n";
  const Soup soup = parsed(text, "a.stl", &info);
  CHECK(soup.points.size() == 3);
  CHECK(soup.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 1, 2}});
  CHECK(info.parts == std::vector<std::string>{"first part", ""});
  CHECK(info.encoding == MeshEncoding::ascii);
}

TEST_CASE("stl: ASCII coordinates are the nearest doubles, not floats") {
  std::string text = "solid\n" + ascii_facet + "endsolid\n";
  text.replace(text.find("vertex 1"), 8, "vertex 0.1234567890123456789");
  CHECK(parsed(text, "a.stl").points[1][0] == 0.1234567890123456789);
}

TEST_CASE("stl: every bad ASCII file is refused with its line") {
  const std::string good = "solid\n" + ascii_facet + "endsolid\n";
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  CHECK(refused(with("vertex 1 0 0", "vertex nan 0 0"), "a.stl").position() == 5);
  CHECK(refused(with("vertex 1 0 0", "vertex inf 0 0"), "a.stl").position() == 5);
  CHECK(refused(with("vertex 1 0 0", "vertex 1e999 0 0"), "a.stl").position() == 5);
  CHECK(refused(with("vertex 1 0 0", "vertex 1 0"), "a.stl").position() == 5);
  CHECK(refused(with("vertex 1 0 0", "vertex 1,5 0 0"), "a.stl").position() == 5);
  CHECK(refused(with("  vertex 1 0 0\n", ""), "a.stl").position() == 6);
  CHECK(refused(with("endfacet", "facet"), "a.stl").position() == 8);
  CHECK(refused(with("outer loop", "inner loop"), "a.stl").unit() == IoError::Unit::line);
  CHECK(refused(good + "garbage", "a.stl").position() == 10);
  check_truncations(good, "a.stl", 1);
}

TEST_CASE("stl: every bad binary file is refused with its byte") {
  const std::string good = binary_stl("", {facet_bytes(first_facet), facet_bytes(second_facet)});
  check_truncations(good, "a.stl", 0);
  std::string absurd = good;
  absurd.replace(80, 4, raw(std::uint32_t{4'000'000'000}));
  CHECK(refused(absurd, "a.stl").position() == good.size());
  std::string none = good;
  none.replace(80, 4, raw(std::uint32_t{0}));
  CHECK(refused(none, "a.stl").position() == 80);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    std::string text = good;
    text.replace(84 + 50 + 12 + 16, 4, raw(bad));  // y of the second corner of the second facet
    CHECK(refused(text, "a.stl").position() == 84 + 50 + 12 + 12);
  }
  CHECK(refused(std::string("\x7f"
                            "ELF garbage"),
                "a.stl")
            .file() == "a.stl");
}

TEST_CASE("stl: attribute bytes are a face scalar, and written again; without any there is none") {
  const Soup soup = parsed(binary_stl("", {facet_bytes(first_facet), facet_bytes(second_facet, 5)}), "a.stl");
  CHECK(soup.face_scalars.at("attribute") == std::vector<double>{0, 5});
  CHECK(round_trip(soup, "a.stl").face_scalars == soup.face_scalars);
  CHECK(parsed(binary_stl("", {facet_bytes(first_facet), facet_bytes(second_facet)}), "a.stl").face_scalars.empty());
}

TEST_CASE("stl: writes and reads back the same soup where floats hold it") {
  Soup soup;
  soup.points = {{0, 0, 0}, {1.5, 0, 0}, {0, 2.25, 0}, {0, 0, -8}};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 0, 1}, {0, 1, 2}};
  check_same_geometry(round_trip(soup, "a.stl"), soup);
  check_same_geometry(round_trip(soup, "a.STL", true), soup);
}

TEST_CASE("stl: the binary writer reports its rounding and refuses what floats do not hold") {
  TemporaryFolder folder;
  Context context;
  Soup soup;
  soup.points = {{0, 0, 0}, {0.1, 0, 0}, {0, 1, 0}, {0.1 + 1e-12, 0, 0}, {9, 9, 9}};
  soup.triangles = {{0, 1, 2}, {1, 3, 2}};
  const MeshWriteReport report = write_mesh(folder / "a.stl", soup, {}, context);
  CHECK(report.rounded_vertices == 2);
  CHECK(report.max_rounding == std::max(std::abs(0.1 - double(0.1f)), std::abs(0.1 + 1e-12 - double(0.1f))));
  CHECK(has_note(report.notes, "1 triangles lost their area"));
  CHECK(has_note(report.notes, "without a triangle: 1"));
  const MeshWriteReport exact = write_mesh(folder / "b.stl", soup, {.ascii = true}, context);
  CHECK(exact.max_rounding == 0);
  CHECK(read_mesh(folder / "b.stl", context).points[1][0] == 0.1);

  soup.points[0][2] = 1e39;
  CHECK_THROWS_AS(write_mesh(folder / "c.stl", soup, {}, context), InvalidInput);
  CHECK(folder.entries().size() == 2);
}

TEST_CASE("stl: written normals are unit vectors to the side the corners turn to the left") {
  TemporaryFolder folder;
  Context context;
  Soup soup;
  soup.points = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {1e-30, 0, 0}, {0, 1e-30, 0}};
  soup.triangles = {{0, 1, 2}, {0, 2, 1}, {0, 3, 4}, {0, 0, 1}};
  write_mesh(folder / "a.stl", soup, {}, context);
  const std::string bytes = file_bytes(folder / "a.stl");
  const float expected[] = {1, -1, 1, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    std::array<float, 3> normal;
    std::memcpy(normal.data(), bytes.data() + 84 + 50 * i, 12);
    CHECK(normal == std::array<float, 3>{0, 0, expected[i]});
  }
}

TEST_CASE("mesh files: real files hold the facets their headers count") {
  const char* data = std::getenv("TRI_DATA");
  if (!data) return;
  const std::filesystem::path folder = std::filesystem::path(data) / "meshes";
  if (!std::filesystem::exists(folder / "diagnosis.tsv")) return;
  // An independent diagnosis: file, vertices that a face uses, faces, vertices that none uses.
  std::ifstream table(folder / "diagnosis.tsv");
  std::string line, name;
  std::getline(table, line);
  int files = 0;
  while (std::getline(table, line)) {
    std::istringstream row(line);
    std::size_t vertices = 0, faces = 0, unused = 0;
    row >> name >> vertices >> faces >> unused;
    CAPTURE(name);
    Context context;
    const Soup soup = read_mesh((folder / name).string(), context);
    const std::string bytes = file_bytes((folder / name).string());
    if (name.ends_with(".obj") && bytes.find("\\\r\n") != std::string::npos) {
      // The diagnosis knows no continued lines: count the corners of each face here, n-2 triangles for n corners.
      std::istringstream text(bytes);
      std::string word;
      std::size_t corners = 0, triangles = 0;
      bool in_face = false;
      while (text >> word) {
        if (in_face && (std::isdigit(static_cast<unsigned char>(word[0])) || word == "\\")) {
          corners += word != "\\";
          continue;
        }
        if (in_face) triangles += corners - 2;
        in_face = word == "f";
        corners = 0;
      }
      if (in_face) triangles += corners - 2;
      CHECK(soup.triangles.size() == triangles);
      ++files;
      continue;
    }
    std::vector<bool> used(soup.points.size());
    for (const Triangle& t : soup.triangles)
      for (const auto v : t) used[v] = true;
    CHECK(soup.triangles.size() == faces);
    CHECK(static_cast<std::size_t>(std::count(used.begin(), used.end(), true)) == vertices);
    CHECK(static_cast<std::size_t>(std::count(used.begin(), used.end(), false)) == unused);
    if (name.ends_with(".stl")) {
      std::uint32_t count = 0;
      std::memcpy(&count, bytes.data() + 80, 4);
      if (bytes.size() == 84 + 50ULL * count) CHECK(soup.triangles.size() == count);
    }
    ++files;
  }
  CHECK(files > 0);
}
