#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/mesh_file.hpp"

namespace tri::io_detail {

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };

/// Bytes of one value in a binary file.
std::size_t size_of(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::f32;
  bool is_list = false;
  PlyType count_type = PlyType::u8;  ///< of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// Null if there is none of that name.
  const PlyProperty* find(std::string_view property) const;
};

struct PlyHeader {
  MeshEncoding encoding = MeshEncoding::ascii;
  std::vector<PlyElement> elements;
  std::size_t size = 0;     ///< bytes up to the first of the body
  std::uint64_t lines = 0;  ///< of the header
};

/// @throws IoError with the line: not a PLY header, an unknown type or keyword, a name that is given twice. Counts are
/// not checked.
PlyHeader parse_ply_header(std::string_view bytes, const std::string& file);

}  // namespace tri::io_detail
