#include <fmt/format.h>

#include <bit>
#include <functional>
#include <map>

#include "io/mesh_formats/mesh_formats.hpp"
#include "io/xml_text.hpp"

// VTK PolyData in XML with its arrays appended as raw bytes: "VTK File Formats" of the VTK User's Guide, 11th edition.
// The only encoding of VTK that holds doubles as they are, at memory speed, with named arrays of any type.
namespace tri::io_detail {
namespace {

static_assert(std::endian::native == std::endian::little, "the header says so");

/// The arrays of the file: declared first, their bytes appended in the same order.
class Arrays {
 public:
  /// @param put writes the `bytes` bytes @return the element that declares it
  std::string declare(const char* type, const std::string& name, std::size_t components, std::uint64_t bytes,
                      std::function<void(AtomicFile&)> put) {
    const std::uint64_t offset = size_;
    size_ += 8 + bytes;
    arrays_.emplace_back(bytes, std::move(put));
    return fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n", type,
        xml_text(name), components, offset);
  }
  void write(AtomicFile& file, Context& context) const {
    for (std::size_t i = 0; i < arrays_.size(); ++i) {
      context.checkpoint();
      context.progress("write", static_cast<double>(i) / static_cast<double>(arrays_.size()));
      file.write_value(arrays_[i].first);
      arrays_[i].second(file);
    }
  }

 private:
  std::uint64_t size_ = 0;
  std::vector<std::pair<std::uint64_t, std::function<void(AtomicFile&)>>> arrays_;
};

template <class Element>
std::string whole(Arrays& arrays, const char* type, const std::string& name, std::size_t components,
                  const std::vector<Element>& list) {
  const std::string_view bytes(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(Element));
  return arrays.declare(type, name, components, bytes.size(), [bytes](AtomicFile& file) { file.write(bytes); });
}

/// A name that the arrays of this element have not got yet.
std::string free_name(const std::map<std::string, std::vector<double>>& scalars, std::string name) {
  while (scalars.contains(name)) name += '_';
  return name;
}

}  // namespace

void write_vtp(AtomicFile& file, const Soup& soup, Context& context) {
  static_assert(sizeof(Vec3) == 24 && sizeof(Triangle) == 12);
  Arrays arrays;
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<PolyData>\n"
      "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"{}\">\n",
      soup.points.size(), soup.triangles.size());
  const std::string normals = soup.vertex_normals.empty() ? "" : free_name(soup.vertex_scalars, "Normals");
  const std::string colors = soup.vertex_colors.empty() ? "" : free_name(soup.vertex_scalars, "RGB");
  text += "<PointData";
  if (!normals.empty()) text += " Normals=\"" + normals + "\"";
  if (!colors.empty()) text += " Scalars=\"" + colors + "\"";
  text += ">\n";
  if (!normals.empty()) text += whole(arrays, "Float64", normals, 3, soup.vertex_normals);
  if (!colors.empty()) text += whole(arrays, "UInt8", colors, 3, soup.vertex_colors);
  for (const auto& [name, values] : soup.vertex_scalars) text += whole(arrays, "Float64", name, 1, values);
  text += "</PointData>\n<CellData>\n";
  for (const auto& [name, values] : soup.face_scalars) text += whole(arrays, "Float64", name, 1, values);
  text += "</CellData>\n<Points>\n" + whole(arrays, "Float64", "Points", 3, soup.points) + "</Points>\n<Polys>\n";
  const auto integers = [&](const char* name, std::size_t count, auto value) {
    text += arrays.declare("Int64", name, 1, 8 * count, [count, value](AtomicFile& out) {
      for (std::size_t i = 0; i < count; ++i) out.write_value(static_cast<std::int64_t>(value(i)));
    });
  };
  integers("connectivity", 3 * soup.triangles.size(), [&soup](std::size_t i) { return soup.triangles[i / 3][i % 3]; });
  integers("offsets", soup.triangles.size(), [](std::size_t i) { return 3 * (i + 1); });
  text += "</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
  file.write(text);
  arrays.write(file, context);
  file.write("\n</AppendedData>\n</VTKFile>\n");
}

}  // namespace tri::io_detail
