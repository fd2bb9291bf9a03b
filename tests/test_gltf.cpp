#include <fstream>
#include <nlohmann/json.hpp>

#include "io/mesh_formats/base64.hpp"
#include "mesh_io_helpers.hpp"
#include "meshops/single_precision.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

using Json = nlohmann::json;

/// A glTF document that is put together piece by piece; what a case needs else is changed in `json`.
struct Document {
  Json json =
      Json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
      "meshes": [{"primitives": [{"attributes": {}}]}], "accessors": [], "bufferViews": []})");
  std::string bytes;

  Json& primitive() { return json["meshes"][0]["primitives"][0]; }
  std::size_t view(const std::string& content) {
    while (bytes.size() % 4 != 0) bytes += '\0';
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", content.size()}});
    bytes += content;
    return json["bufferViews"].size() - 1;
  }
  std::size_t accessor(const std::string& content, int component, std::size_t count, const char* type) {
    json["accessors"].push_back(
        {{"bufferView", view(content)}, {"componentType", component}, {"count", count}, {"type", type}});
    return json["accessors"].size() - 1;
  }
  void attribute(const char* name, const std::string& content, int component, std::size_t count, const char* type) {
    const std::size_t number = accessor(content, component, count, type);
    primitive()["attributes"][name] = number;
  }
  void indices(const std::string& content, int component, std::size_t count) {
    const std::size_t number = accessor(content, component, count, "SCALAR");
    primitive()["indices"] = number;
  }
  std::string text() {
    if (!json.contains("buffers"))
      json["buffers"] = {{{"byteLength", bytes.size()},
                          {"uri", "data:application/octet-stream;base64," + io_detail::to_base64(bytes)}}};
    return json.dump();
  }
  std::string binary() {
    json["buffers"] = {{{"byteLength", bytes.size()}}};
    std::string text = json.dump(), data = bytes;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    data.resize((data.size() + 3) / 4 * 4, '\0');
    const auto size = [](const std::string& s) { return static_cast<std::uint32_t>(s.size()); };
    return "glTF" + raw(std::uint32_t{2}, static_cast<std::uint32_t>(28 + text.size() + data.size()), size(text)) +
           "JSON" + text + raw(size(data)) + std::string("BIN\0", 4) + data;
  }
};

/// A square of four vertices in metres: (0,0,0), (1,0,0), (0,1,0), (1,1,0).
Document square() {
  Document document;
  document.attribute("POSITION", raw(0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 1.f, 1.f, 0.f), 5126, 4, "VEC3");
  return document;
}

Soup read_document(Document& document, MeshFileInfo* info = nullptr) {
  return parsed(document.text(), "a.gltf", info);
}
std::string document_error(Document& document) {
  return refused(document.text(), "a.gltf").what();
}

}  // namespace

TEST_CASE("gltf: metres become millimetres, JSON and GLB hold the same") {
  Document document = square();
  document.indices(
      raw(std::uint16_t{0}, std::uint16_t{1}, std::uint16_t{2}, std::uint16_t{2}, std::uint16_t{1}, std::uint16_t{3}),
      5123, 6);
  MeshFileInfo info;
  for (const bool binary : {false, true}) {
    const Soup soup = binary ? parsed(document.binary(), "a.glb", &info) : parsed(document.text(), "a.gltf", &info);
    CHECK(soup.points == std::vector<Vec3>{{0, 0, 0}, {1000, 0, 0}, {0, 1000, 0}, {1000, 1000, 0}});
    CHECK(soup.triangles == std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}});
    CHECK(info.format == MeshFormat::gltf);
    CHECK(info.encoding == (binary ? MeshEncoding::binary_little_endian : MeshEncoding::ascii));
    CHECK(has_note(info.notes, "metres"));
    document.json.erase("buffers");
  }
}

TEST_CASE("gltf: lists, strips and fans, with indices of every type and without") {
  const auto with_mode = [](int mode, int type) {
    Document document = square();
    document.primitive()["mode"] = mode;
    if (type == 5121)
      document.indices(raw(std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{3}), type, 4);
    if (type == 5123)
      document.indices(raw(std::uint16_t{0}, std::uint16_t{1}, std::uint16_t{2}, std::uint16_t{3}), type, 4);
    if (type == 5125) document.indices(raw(0u, 1u, 2u, 3u), type, 4);
    return read_document(document).triangles;
  };
  for (const int type : {0, 5121, 5123, 5125}) {
    CAPTURE(type);
    CHECK(with_mode(4, type) == std::vector<Triangle>{{0, 1, 2}});  // the fourth begins a second one
    CHECK(with_mode(5, type) == std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}});
    CHECK(with_mode(6, type) == std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}});
  }
}

TEST_CASE("gltf: points and lines are counted and left") {
  Document document = square();
  document.json["meshes"][0]["primitives"].push_back(document.primitive());
  document.json["meshes"][0]["primitives"].push_back(document.primitive());
  document.json["meshes"][0]["primitives"][0]["mode"] = 0;
  document.json["meshes"][0]["primitives"][1]["mode"] = 3;
  MeshFileInfo info;
  CHECK(read_document(document, &info).triangles.size() == 1);
  CHECK(has_note(info.notes, "1 primitives of lines, 1 primitives of points"));
}

TEST_CASE("gltf: nodes put meshes where their transforms say, level within level") {
  Document document = square();
  document.json["nodes"] = Json::parse(R"([
      {"children": [1, 2], "translation": [10, 0, 0]},
      {"mesh": 0, "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476], "scale": [2, 1, 1]},
      {"mesh": 0, "matrix": [-1, 0, 0, 0,  0, 1, 0, 0,  0, 0, 1, 0,  0, 0, 5, 1]}])");
  MeshFileInfo info;
  const Soup soup = read_document(document, &info);
  REQUIRE(soup.points.size() == 8);
  // The first: stretched along x, turned by 90 degrees about z, moved. (1, 0, 0) -> (2, 0, 0) -> (0, 2, 0) -> (10, 2,
  // 0).
  CHECK((soup.points[1] - Vec3(10000, 2000, 0)).norm() < 1e-9);
  CHECK((soup.points[2] - Vec3(9000, 0, 0)).norm() < 1e-9);
  // The second is mirrored: its triangle is turned around, so that it faces +z like the first.
  CHECK(soup.points[5] == Vec3(9000, 0, 5000));
  REQUIRE(soup.triangles.size() == 2);
  CHECK(((soup.points[soup.triangles[1][1]] - soup.points[soup.triangles[1][0]]) %
         (soup.points[soup.triangles[1][2]] - soup.points[soup.triangles[1][0]]))[2] > 0);
  CHECK(has_note(info.notes, "1 primitives are mirrored"));
  CHECK(soup.face_labels.at("object") == std::vector<std::string>{"mesh 0", "mesh 0 (2)"});
  CHECK(soup.face_scalars.at("object") == std::vector<double>{0, 1});
}

TEST_CASE("gltf: primitives that name the same accessors share their vertices") {
  Document document = square();
  document.indices(raw(0u, 1u, 2u), 5125, 3);
  Json second = document.primitive();
  second["indices"] = document.accessor(raw(2u, 1u, 3u), 5125, 3, "SCALAR");
  second["material"] = 0;
  document.json["materials"] = {{{"name", "steel"}, {"doubleSided", true}}};
  document.json["meshes"][0]["primitives"].push_back(second);
  MeshFileInfo info;
  const Soup soup = read_document(document, &info);
  CHECK(soup.points.size() == 4);
  CHECK(soup.triangles == std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}});
  CHECK(soup.face_scalars.at("material") == std::vector<double>{-1, 0});
  CHECK(soup.face_labels.at("material") == std::vector<std::string>{"steel"});
  CHECK(has_note(info.notes, "of 1 materials only the names are kept"));
}

TEST_CASE("gltf: colours, normals, texture coordinates and an application's numbers, from every kind of accessor") {
  Document document = square();
  document.attribute("NORMAL", raw(0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 0.f, 1.f, 0.f, 1.f, 0.f, 0.f), 5126, 4, "VEC3");
  // Normalised 16-bit numbers, with a stride of 8 bytes.
  document.attribute("TEXCOORD_0",
                     raw(std::uint16_t{0}, std::uint16_t{0}, 7, std::uint16_t{65535}, std::uint16_t{0}, 7,
                         std::uint16_t{0}, std::uint16_t{65535}, 7, std::uint16_t{65535}, std::uint16_t{65535}, 7),
                     5123, 4, "VEC2");
  document.json["accessors"].back()["normalized"] = true;
  document.json["bufferViews"].back()["byteStride"] = 8;
  document.attribute("COLOR_0", raw(1.f, 0.f, 0.f, 1.f, 0.f, 1.f, 0.f, 1.f, 0.f, 0.f, 1.f, 0.5f, 0.f, 0.f, 0.f, 1.f),
                     5126, 4, "VEC4");
  // Sparse: zeros, but for one.
  document.json["accessors"].push_back({{"componentType", 5126}, {"count", 4}, {"type", "SCALAR"}});
  document.primitive()["attributes"]["_deviation"] = document.json["accessors"].size() - 1;
  const std::size_t places = document.view(raw(std::uint8_t{2})), values = document.view(raw(-0.25f));
  document.json["accessors"].back()["sparse"] = {{"count", 1},
                                                 {"indices", {{"bufferView", places}, {"componentType", 5121}}},
                                                 {"values", {{"bufferView", values}}}};
  MeshFileInfo info;
  const Soup soup = read_document(document, &info);
  CHECK(soup.vertex_normals == std::vector<Vec3>{{0, 0, 1}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}});
  CHECK(soup.vertex_colors ==
        std::vector<std::array<std::uint8_t, 3>>{{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {0, 0, 0}});
  CHECK(soup.vertex_scalars.at("deviation") == std::vector<double>{0, 0, -0.25, 0});
  CHECK(soup.corner_scalars.at("s") == std::vector<double>{0, 1, 0});
  CHECK(soup.corner_scalars.at("t") == std::vector<double>{1, 1, 0});  // from below
  CHECK(has_note(info.notes, "the transparency of 1 vertices"));
}

TEST_CASE("gltf: what is wrong is refused, with the element") {
  const auto check = [](const std::string& element, const std::string& what,
                        const std::function<void(Document&)>& spoil) {
    Document document = square();
    document.indices(raw(0u, 1u, 2u), 5125, 3);
    spoil(document);
    const std::string error = document_error(document);
    CAPTURE(error);
    CHECK(error.starts_with("a.gltf: " + element));
    CHECK(error.find(what) != std::string::npos);
  };
  check("meshes[0].primitives[0].indices", "number 2 is 4", [](Document& d) { d.indices(raw(0u, 1u, 4u), 5125, 3); });
  check("accessors[0]", "elements do not fit", [](Document& d) { d.json["accessors"][0]["count"] = 5; });
  check("accessors[0]", "elements do not fit", [](Document& d) { d.json["accessors"][0]["count"] = 9007199254740992; });
  check("accessors[0].count", "not an integer", [](Document& d) { d.json["accessors"][0]["count"] = -1; });
  check("accessors[0].count", "not an integer", [](Document& d) { d.json["accessors"][0]["count"] = 1e300; });
  check("accessors[0].count", "absurd", [](Document& d) {
    d.json["accessors"][0].erase("bufferView");
    d.json["accessors"][0]["count"] = 1'000'000'000;
  });
  check("accessors[0].componentType", "unknown", [](Document& d) { d.json["accessors"][0]["componentType"] = 5130; });
  check("accessors[0].type", "MAT4", [](Document& d) { d.json["accessors"][0]["type"] = "MAT4"; });
  check("accessors[0]", "has no componentType", [](Document& d) { d.json["accessors"][0].erase("componentType"); });
  check("accessors[0]", "names bufferViews 9", [](Document& d) { d.json["accessors"][0]["bufferView"] = 9; });
  check("accessors[0]", "every 4 bytes", [](Document& d) { d.json["bufferViews"][0]["byteStride"] = 4; });
  check("bufferViews[0]", "of a buffer of", [](Document& d) { d.json["bufferViews"][0]["byteOffset"] = 1'000'000; });
  check("bufferViews[0]", "of a buffer of",
        [](Document& d) { d.json["bufferViews"][0]["byteLength"] = 9007199254740991; });
  check("buffers[0]", "bytes it should have", [](Document& d) {
    d.text();
    d.json["buffers"][0]["byteLength"] = 1'000'000;
  });
  check("buffers[0].uri", "base 64", [](Document& d) {
    d.text();
    d.json["buffers"][0]["uri"] = "data:;base64,!!!!";
  });
  check("buffers[0].uri", "no file", [](Document& d) {
    d.json["buffers"] = {{{"byteLength", 4}, {"uri", "missing.bin"}}};
  });
  check("buffers[0].uri", "not opened", [](Document& d) {
    d.json["buffers"] = {{{"byteLength", 4}, {"uri", "../secret"}}};
  });
  check("buffers[0].uri", "not opened", [](Document& d) {
    d.json["buffers"] = {{{"byteLength", 4}, {"uri", "/etc/passwd"}}};
  });
  check("buffers[0].uri", "not opened", [](Document& d) {
    d.json["buffers"] = {{{"byteLength", 4}, {"uri", "http://a/b"}}};
  });
  check("buffers[0]", "no binary chunk", [](Document& d) { d.json["buffers"] = {{{"byteLength", 4}}}; });
  check("nodes[0]", "reached twice", [](Document& d) { d.json["nodes"][0]["children"] = {0}; });
  check("the node tree", "names nodes 7", [](Document& d) { d.json["nodes"][0]["children"] = {7}; });
  check("nodes[0].matrix", "has 3 numbers", [](Document& d) { d.json["nodes"][0]["matrix"] = {1, 2, 3}; });
  check("nodes[0].mesh", "names meshes 3", [](Document& d) { d.json["nodes"][0]["mesh"] = 3; });
  check("meshes[0].primitives[0].attributes.POSITION", "vertex 1 is not finite", [](Document& d) {
    const float nan = std::nanf("");
    std::memcpy(d.bytes.data() + 16, &nan, 4);
  });
  check("meshes[0].primitives[0].attributes.NORMAL", "3 values for 4 vertices",
        [](Document& d) { d.attribute("NORMAL", raw(0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f), 5126, 3, "VEC3"); });
  check("asset.version", "only glTF 2", [](Document& d) { d.json["asset"]["version"] = "1.0"; });
  check("extensionsRequired", "compressed",
        [](Document& d) { d.json["extensionsRequired"] = {"KHR_draco_mesh_compression"}; });
  check("meshes[0].primitives[0]", "absurd", [](Document& d) {
    // One mesh, named by as many nodes as it takes.
    const std::string zeros(3'000'000, '\0');
    d.indices(zeros, 5121, zeros.size());
    for (int i = 1; i < 120; ++i) {
      d.json["nodes"].push_back({{"mesh", 0}});
      d.json["scenes"][0]["nodes"].push_back(i);
    }
  });
}

TEST_CASE("gltf: JSON that is damaged, nested without end or a desert of commas is refused at its byte") {
  CHECK(refused("{\"asset\": {\"version\": \"2.0\"},, }", "a.gltf").position() == 29);
  const std::string deep =
      "{\"asset\":{\"version\":\"2.0\"},\"extras\":" + std::string(300'000, '[') + std::string(300'000, ']') + "}";
  CHECK(std::string(refused(deep, "a.gltf").what()).find("nested deeper than 200") != std::string::npos);
  std::string wide = "{\"asset\":{\"version\":\"2.0\"},\"extras\":[0";
  for (int i = 0; i < 2'100'000; ++i) wide += ",0";
  CHECK(std::string(refused(wide + "]}", "a.gltf").what()).find("more than 2000000 values") != std::string::npos);
}

TEST_CASE("gltf: every cut of a GLB file is refused") {
  Document document = square();
  document.indices(raw(0u, 1u, 2u), 5125, 3);
  check_truncations(document.binary(), "a.glb", 0);
}

TEST_CASE("gltf: a buffer in a file of its own is found beside the document") {
  TemporaryFolder folder;
  Document document = square();
  document.json["buffers"] = {{{"byteLength", document.bytes.size()}, {"uri", "my%20data.bin"}}};
  std::ofstream(folder / "a.gltf") << document.text();
  Context context;
  CHECK_THROWS_AS(read_mesh(folder / "a.gltf", context), IoError);
  std::ofstream(folder / "my data.bin", std::ios::binary) << document.bytes;
  CHECK(read_mesh(folder / "a.gltf", context).points.size() == 4);
}

TEST_CASE("gltf: what is floats in millimetres comes back bit for bit; else the largest rounding is said") {
  Soup exact = sphere(9, 5, 12.5);
  for (Vec3& p : exact.points) p = rounded_to_floats(p);
  for (const char* name : {"a.glb", "a.gltf"}) {
    TemporaryFolder folder;
    Context context;
    const MeshWriteReport report = write_mesh(folder / name, exact, {}, context);
    CHECK(report.notes.empty());
    check_same_geometry(read_mesh(folder / name, context), exact);

    Soup odd = exact;
    odd.points[3][1] += 1e-9;
    odd.points[5][2] = 1.0 / 3;
    const MeshWriteReport rounded = write_mesh(folder / name, odd, {}, context);
    const Soup back = read_mesh(folder / name, context);
    double largest = 0;
    for (std::size_t i = 0; i < odd.points.size(); ++i)
      for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(back.points[i][k] - odd.points[i][k]));
    CHECK(rounded.max_rounding == largest);
    CHECK(rounded.rounded_vertices == 2);
    CHECK(has_note(rounded.notes, "rounded to the floats of glTF: 2 of"));
  }
}

TEST_CASE("gltf: texture coordinates that differ around a vertex double it, and corners keep theirs") {
  Soup soup = sheet(2, 1);
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    for (const std::uint32_t v : soup.triangles[i]) {
      soup.corner_scalars["s"].push_back(soup.points[v][0] / 4 + (i >= 2 ? 0.5 : 0));
      soup.corner_scalars["t"].push_back(soup.points[v][1] / 4);
    }
  TemporaryFolder folder;
  Context context;
  const MeshWriteReport report = write_mesh(folder / "a.glb", soup, {}, context);
  CHECK(has_note(report.notes, "2 vertices were doubled"));
  const Soup back = read_mesh(folder / "a.glb", context);
  CHECK(back.points.size() == soup.points.size() + 2);
  CHECK(back.corner_scalars == soup.corner_scalars);
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) CHECK(back.points[back.triangles[i][k]] == soup.points[soup.triangles[i][k]]);
}
