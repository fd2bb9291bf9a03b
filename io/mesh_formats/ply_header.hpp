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
  /// Lines that are none of PLY and were skipped, as some programs write a comment without its keyword: one sentence
  /// each.
  std::vector<std::string> notes;
};

/// A line of text with an unknown keyword is skipped, with a note, unless it may be a damaged one of PLY: control
/// characters in it, a keyword that is nearly one of PLY's, the type of a property or the count of an element where
/// those have theirs.
/// @throws IoError with the line: not a PLY header, an unknown type, a line that may be damaged, a name that is given
/// twice. Counts are not checked.
PlyHeader parse_ply_header(std::string_view bytes, const std::string& file);

}  // namespace tri::io_detail
