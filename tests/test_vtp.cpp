#include <map>

#include "mesh_io_helpers.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

/// The arrays of a file by name, found by the offsets that its XML declares.
std::map<std::string, std::string> arrays_of(const std::string& bytes) {
  std::map<std::string, std::string> arrays;
  const std::size_t data = bytes.find("<AppendedData encoding=\"raw\">\n_") + 31;
  for (std::size_t at = bytes.find("<DataArray "); at < data; at = bytes.find("<DataArray ", at + 1)) {
    const std::string tag = bytes.substr(at, bytes.find("/>", at) - at);
    const auto value = [&](const std::string& key) {
      const std::size_t begin = tag.find(" " + key + "=\"") + key.size() + 3;
      return tag.substr(begin, tag.find('"', begin) - begin);
    };
    const std::size_t offset = data + std::stoul(value("offset"));
    std::uint64_t size = 0;
    std::memcpy(&size, bytes.data() + offset, 8);
    arrays[value("Name") + " " + value("type") + " " + value("NumberOfComponents")] = bytes.substr(offset + 8, size);
  }
  return arrays;
}

template <class Element>
std::string bytes_of(const std::vector<Element>& list) {
  return {reinterpret_cast<const char*>(list.data()), list.size() * sizeof(Element)};
}

}  // namespace

TEST_CASE("vtp: positions, indices and attributes stand where the XML says, as they are") {
  TemporaryFolder folder;
  Context context;
  Soup soup = with_attributes(cube({0.1, 1.0 / 3, 5}));
  soup.vertex_scalars["a<b"] = soup.vertex_scalars["x"];
  soup.vertex_scalars.erase("x");
  const MeshWriteReport report = write_mesh(folder / "a.vtp", soup, {}, context);
  CHECK(report.format == MeshFormat::vtk);
  CHECK(has_note(report.notes, "VTK holds no scalars of corners: x"));
  CHECK(has_note(report.notes, "names (their numbers were written): group"));
  const std::string bytes = file_bytes(folder / "a.vtp");
  CHECK(bytes.find("NumberOfPoints=\"8\"") != std::string::npos);
  CHECK(bytes.find("NumberOfPolys=\"12\"") != std::string::npos);
  const auto arrays = arrays_of(bytes);
  CHECK(arrays.at("Points Float64 3") == bytes_of(soup.points));
  CHECK(arrays.at("Normals Float64 3") == bytes_of(soup.vertex_normals));
  CHECK(arrays.at("RGB UInt8 3") == bytes_of(soup.vertex_colors));
  CHECK(arrays.at("a&lt;b Float64 1") == bytes_of(soup.vertex_scalars.at("a<b")));
  CHECK(arrays.at("id Float64 1") == bytes_of(soup.face_scalars.at("id")));
  std::vector<std::int64_t> corners, ends;
  for (const Triangle& t : soup.triangles) {
    corners.insert(corners.end(), t.begin(), t.end());
    ends.push_back(static_cast<std::int64_t>(corners.size()));
  }
  CHECK(arrays.at("connectivity Int64 1") == bytes_of(corners));
  CHECK(arrays.at("offsets Int64 1") == bytes_of(ends));
  CHECK(bytes.ends_with("\n</AppendedData>\n</VTKFile>\n"));
}

TEST_CASE("vtp: reading it is refused with the reason") {
  TemporaryFolder folder;
  Context context;
  write_mesh(folder / "a.vtp", cube(), {}, context);
  CHECK(std::string(refused(file_bytes(folder / "a.vtp"), "a.vtp").what()).find("VTK file, which is written only") !=
        std::string::npos);
}
