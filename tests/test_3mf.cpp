#ifdef TRI_WITH_3MF
#include "io/mesh_formats/zip_archive.hpp"
#endif
#include "mesh_io_helpers.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

#ifndef TRI_WITH_3MF

TEST_CASE("3mf: a program without the libraries says so") {
  CHECK(std::string(refused("PK\x03\x04 and so on", "a.3mf").what()).find("built without 3MF") != std::string::npos);
  Context context;
  CHECK_THROWS_WITH_AS(write_mesh("a.3mf", cube(), {}, context), doctest::Contains("built without 3MF"), InvalidInput);
}

#else

namespace {

const std::string head =
    "<?xml version=\"1.0\"?>\n<model unit=\"millimeter\" "
    "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" "
    "xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\" "
    "xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\">\n<resources>\n";

/// The mesh of one triangle (0,0,0), (1,0,0), (0,1,0). @param more attributes of the triangle
std::string mesh_text(const std::string& more = "") {
  return "<mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"1\" "
         "z=\"0\"/></vertices>"
         "<triangles><triangle v1=\"0\" v2=\"1\" v3=\"2\"" +
         more + "/></triangles></mesh>";
}
std::string object(int id, const std::string& content, const std::string& more = "") {
  return "<object id=\"" + std::to_string(id) + "\"" + more + ">" + content + "</object>\n";
}
std::string model(const std::string& resources, const std::string& build) {
  return head + resources + "</resources>\n<build>" + build + "</build></model>";
}
std::string archive(const std::string& text) {
  return io_detail::zip_of({{"3D/3dmodel.model", text}}, "a.3mf");
}

Soup read_model(const std::string& text, MeshFileInfo* info = nullptr) {
  return parsed(archive(text), "a.3mf", info);
}
std::string model_error(const std::string& text) {
  return refused(archive(text), "a.3mf").what();
}

}  // namespace

TEST_CASE("3mf: units become millimetres, and a note says so") {
  for (const auto& unit_and_size : std::vector<std::pair<std::string, double> >{{"micron", 0.001},
                                                                                {"millimeter", 1},
                                                                                {"centimeter", 10},
                                                                                {"inch", 25.4},
                                                                                {"foot", 304.8},
                                                                                {"meter", 1000}}) {
    const std::string& unit = unit_and_size.first;
    const double size = unit_and_size.second;
    CAPTURE(unit);
    std::string text = model(object(1, mesh_text()), "<item objectid=\"1\"/>");
    text.replace(text.find("millimeter"), 10, unit);
    MeshFileInfo info;
    const Soup soup = read_model(text, &info);
    CHECK(soup.points == std::vector<Vec3>{{0, 0, 0}, {size, 0, 0}, {0, size, 0}});
    CHECK(soup.triangles == std::vector<Triangle>{{0, 1, 2}});
    CHECK(has_note(info.notes, "the unit of the file is the " + unit) == (unit != "millimeter"));
    CHECK(info.format == MeshFormat::threemf);
  }
}

TEST_CASE("3mf: items of the build and components are put where their transforms say") {
  MeshFileInfo info;
  const Soup soup =
      read_model(model(object(1, mesh_text(), " name=\"leaf\"") + object(4, mesh_text()) +
                           object(2,
                                  "<components><component objectid=\"1\" transform=\"0 1 0 -1 0 0 0 0 1 10 0 "
                                  "0\"/><component objectid=\"1\"/></components>"),
                       "<item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 0 0 5\"/><item objectid=\"1\" "
                       "transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"/>"),
                 &info);
  REQUIRE(soup.points.size() == 9);
  // Rows of the matrix are where the axes go: x to y, y to -x, then by (10, 0, 0), then by (0, 0, 5).
  CHECK(soup.points[0] == Vec3(10, 0, 5));
  CHECK(soup.points[1] == Vec3(10, 1, 5));
  CHECK(soup.points[2] == Vec3(9, 0, 5));
  CHECK(soup.points[4] == Vec3(1, 0, 5));
  CHECK(soup.points[7] == Vec3(-1, 0, 0));
  CHECK(soup.triangles == std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}, {6, 8, 7}});
  CHECK(soup.face_labels.at("object") == std::vector<std::string>{"leaf", "leaf (2)", "leaf (3)"});
  CHECK(soup.face_scalars.at("object") == std::vector<double>{0, 1, 2});
  CHECK(has_note(info.notes, "1 objects are mirrored"));
}

TEST_CASE("3mf: objects in another part of the package are found") {
  const std::string root = model("", "<item objectid=\"7\" p:path=\"/3D/Objects/one.model\"/>");
  const std::string other = model(object(7, mesh_text()), "");
  const Soup soup =
      parsed(io_detail::zip_of({{"3D/3dmodel.model", root}, {"3D/Objects/one.model", other}}, "a"), "a.3mf");
  CHECK(soup.triangles.size() == 1);
}

TEST_CASE("3mf: the relationships of the package name the model") {
  const std::string relations =
      "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship "
      "Target=\"/other/x.model\" "
      "Id=\"r\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
  const std::string text = model(object(1, mesh_text()), "<item objectid=\"1\"/>");
  CHECK(
      parsed(io_detail::zip_of({{"_rels/.rels", relations}, {"other/x.model", text}}, "a"), "a.3mf").triangles.size() ==
      1);
}

TEST_CASE("3mf: base materials are colours and names of triangles, colour groups colours of vertices or corners") {
  const std::string materials =
      "<basematerials id=\"5\"><base name=\"red &amp; hot\" displaycolor=\"#FF0000\"/><base name=\"blue\" "
      "displaycolor=\"#0000FF80\"/></basematerials>";
  MeshFileInfo info;
  Soup soup = read_model(model(materials + object(1, mesh_text(), " pid=\"5\" pindex=\"1\"") +
                                   object(2, mesh_text(" pid=\"5\" p1=\"0\"")) + object(3, mesh_text()),
                               "<item objectid=\"1\"/><item objectid=\"2\"/><item objectid=\"3\"/>"),
                         &info);
  CHECK(soup.face_labels.at("material") == std::vector<std::string>{"blue", "red & hot"});
  CHECK(soup.face_scalars.at("material") == std::vector<double>{0, 1, -1});
  CHECK(soup.face_scalars.at("red")[0] == 0);
  CHECK(soup.face_scalars.at("blue")[0] == 255);
  CHECK(soup.face_scalars.at("red")[1] == 255);
  CHECK(std::isnan(soup.face_scalars.at("red")[2]));
  CHECK(has_note(info.notes, "transparency of 1 colours"));

  const std::string group =
      "<m:colorgroup id=\"6\"><m:color color=\"#010203\"/><m:color color=\"#040506\"/></m:colorgroup>";
  soup = read_model(
      model(group + object(1, mesh_text(" pid=\"6\" p1=\"0\" p2=\"1\" p3=\"0\"")), "<item objectid=\"1\"/>"));
  CHECK(soup.vertex_colors == std::vector<std::array<std::uint8_t, 3> >{{1, 2, 3}, {4, 5, 6}, {1, 2, 3}});
  CHECK(soup.face_scalars.empty());
}

TEST_CASE("3mf: what is not taken is named") {
  MeshFileInfo info;
  std::string text = model(
      "<m:texture2d id=\"9\" path=\"/3D/t.png\"/><m:texture2dgroup id=\"8\" texid=\"9\"><m:tex2coord u=\"0\" "
      "v=\"0\"/></m:texture2dgroup>" +
          object(1, mesh_text(" pid=\"8\" p1=\"0\"")),
      "<item objectid=\"1\"/>");
  parsed(io_detail::zip_of({{"3D/3dmodel.model", text}, {"3D/t.png", "no picture"}}, "a"), "a.3mf", &info);
  CHECK(has_note(info.notes, "1 texture2d, 1 texture2dgroup"));
  CHECK(has_note(info.notes, "the properties of 1 triangles"));
  CHECK(has_note(info.notes, "1 pictures"));
}

TEST_CASE("3mf: what is wrong is refused, with part and line") {
  const auto check = [](const std::string& text, const std::string& what) {
    const std::string error = model_error(text);
    CAPTURE(error);
    CHECK(error.starts_with("a.3mf: "));
    CHECK(error.find(what) != std::string::npos);
  };
  const std::string item = "<item objectid=\"1\"/>";
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = model(object(1, mesh_text()), item);
    return text.replace(text.find(from), from.size(), to);
  };
  check(with("v3=\"2\"", "v3=\"3\""), "3D/3dmodel.model, line 4: v3 is 3, but the object has 3 vertices");
  check(with("v3=\"2\"", "v3=\"-1\""), "no index");
  check(with("v3=\"2\"", ""), "there is no v3");
  check(with("x=\"1\"", "x=\"nan\""), "line 4: x is \"nan\", which is not finite");
  check(with("x=\"1\"", "x=\"1e999\""), "x is");
  check(with("x=\"1\"", "x=\"one\""), "no number");
  check(with("objectid=\"1\"", "objectid=\"3\""), "has no object 3");
  check(with("objectid=\"1\"", "objectid=\"1\" transform=\"1 0 0\""), "12 finite numbers");
  check(with("millimeter", "parsec"), "unknown unit");
  check(with("</object>", "</objekt>"), "not valid XML");
  check(with("<model", "<!DOCTYPE a [<!ENTITY b \"c\">]><model"), "a document type is not allowed");
  check(with(" v1", " pid=\"1\" p1=\"x\" v1"), "p1 is");
  check("<html/>", "no 3MF model");
  check(model(object(1, "<components><component objectid=\"1\"/></components>"), item),
        "deeper than 64, or without end");
  // Each level names the one below ten times: 10^9 triangles.
  std::string levels = object(1, mesh_text());
  for (int level = 2; level <= 10; ++level) {
    std::string content = "<components>";
    for (int i = 0; i < 10; ++i) content += "<component objectid=\"" + std::to_string(level - 1) + "\"/>";
    levels += object(level, content + "</components>");
  }
  check(model(levels, "<item objectid=\"10\"/>"), "absurd for a file of");
}

TEST_CASE("3mf: an archive that is none, is cut, lacks a model or unfolds without end is refused") {
  const std::string whole = archive(model(object(1, mesh_text()), "<item objectid=\"1\"/>"));
  check_truncations(whole, "a.3mf", 0);
  CHECK(std::string(refused("no archive", "a.3mf").what()).find("not a ZIP archive") != std::string::npos);
  CHECK(std::string(refused(io_detail::zip_of({{"a.txt", "b"}}, "a"), "a.3mf").what()).find("without a 3D model") !=
        std::string::npos);
  const std::string bomb = archive(model(std::string(20'000'000, ' '), ""));
  CHECK(bomb.size() < 50'000);
  CHECK(std::string(refused(bomb, "a.3mf").what()).find("absurd for an archive") != std::string::npos);
}

TEST_CASE("3mf: doubles come back bit for bit, and so do objects, materials and colours") {
  Soup soup = awkward_soup();
  soup.triangles.erase(soup.triangles.begin() + 3);  // names a vertex twice
  check_same_geometry(round_trip(soup, "a.3mf"), soup);

  Soup parts = joined(cube(), cube({3, 0, 0}));
  for (std::size_t i = 0; i < parts.triangles.size(); ++i) {
    parts.face_scalars["object"].push_back(i < 12 ? 1 : 0);
    parts.face_scalars["material"].push_back(static_cast<double>(i % 3) - 1);
    for (const char* name : {"red", "green", "blue"})
      parts.face_scalars[name].push_back(static_cast<double>(10 * (i % 3)));
  }
  parts.face_labels["object"] = {"second", "first <&>"};
  parts.face_labels["material"] = {"a", "b"};
  const Soup back = round_trip(parts, "a.3mf");
  check_same_geometry(back, parts);
  const auto names = [](const Soup& s, const char* scalar, std::size_t i) {
    const double label = s.face_scalars.at(scalar)[i];
    return label < 0 ? std::string() : s.face_labels.at(scalar)[static_cast<std::size_t>(label)];
  };
  for (std::size_t i = 0; i < parts.triangles.size(); ++i) {
    CHECK(names(back, "object", i) == names(parts, "object", i));
    if (i % 3 > 0) CHECK(names(back, "material", i) == names(parts, "material", i));
    CHECK(back.face_scalars.at("green")[i] == parts.face_scalars.at("green")[i]);
  }
}

TEST_CASE(
    "3mf: a triangle that names a vertex twice is not written, and counted; objects that share vertices become one") {
  TemporaryFolder folder;
  Context context;
  Soup soup = awkward_soup();
  MeshWriteReport report = write_mesh(folder / "a.3mf", soup, {}, context);
  CHECK(has_note(report.notes, "1 were not written"));
  CHECK(read_mesh(folder / "a.3mf", context).triangles.size() == soup.triangles.size() - 1);
  soup = cube();
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    soup.face_scalars["object"].push_back(static_cast<double>(i % 2));
  soup.face_labels["object"] = {"a", "b"};
  report = write_mesh(folder / "a.3mf", soup, {}, context);
  CHECK(has_note(report.notes, "one object, without their names"));
  check_same_geometry(read_mesh(folder / "a.3mf", context), soup);
}

#endif
