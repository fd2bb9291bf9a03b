#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "io/mesh_formats/placement.hpp"
#include "io/mesh_formats/zip_archive.hpp"
#include "meshops/context.hpp"
#include "meshops/soup.hpp"

// The model part of a 3MF file: "3MF Core Specification" 1.3, "Materials and Properties Extension" 1.2 (colour groups),
// "Production Extension" 1.1 (objects in other parts of the package); 3MF Consortium.
namespace tri::io_detail {

using Rgb = std::array<std::uint8_t, 3>;

/// Base materials or a colour group: what properties of triangles name.
struct ThreemfColors {
  bool materials = false;  ///< else a colour group
  std::vector<Rgb> colors;
  std::vector<std::string> names;  ///< of base materials
};

/// The property of one triangle: an entry of a colour list for each corner.
struct ThreemfProperty {
  std::uint32_t list = 0;  ///< resource id; 0 for none
  std::array<std::uint32_t, 3> entry{};
};

struct ThreemfComponent {
  std::uint32_t object = 0;
  std::string part;  ///< of the package, in which the object is; empty for the same
  Placement placement;
};

struct ThreemfObject {
  std::string name;  ///< may be empty
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<ThreemfProperty> properties;  ///< empty, or one for each triangle
  std::vector<ThreemfComponent> components;
};

struct ThreemfModel {
  double unit = 1;  ///< millimetres
  std::string unit_name = "millimeter";
  std::map<std::uint32_t, ThreemfObject> objects;
  std::map<std::uint32_t, ThreemfColors> colors;
  std::vector<ThreemfComponent> items;        ///< of the build
  std::map<std::string, std::uint64_t> left;  ///< elements of extensions that were not taken, and how often
  std::uint64_t transparent = 0;              ///< colours with an alpha other than opaque
};

/// Reads one part of the package, as a stream.
/// @throws IoError naming part and line: not XML, a document type, a number that is none, an index out of range
ThreemfModel parse_threemf_model(const ZipArchive& archive, const std::string& part, const std::string& file,
                                 Context& context);

/// The part that the relationships of the package name as its 3D model; by custom 3D/3dmodel.model.
std::string threemf_start_part(const ZipArchive& archive, const std::string& file);

}  // namespace tri::io_detail
