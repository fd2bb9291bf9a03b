#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "io/point_formats/e57_pages.hpp"
#include "meshops/vec.hpp"

namespace tri::io_detail {

/// One column of the records of a scan.
struct E57Field {
  enum class Kind { integer, scaled_integer, single_real, double_real, text };

  std::string name;  ///< "cartesianX"; inner elements with their structure, "structure/name"
  Kind kind = Kind::double_real;
  std::int64_t minimum = std::numeric_limits<std::int64_t>::min();  ///< of integers, before scale and offset
  std::int64_t maximum = std::numeric_limits<std::int64_t>::max();
  double scale = 1, offset = 0;                       ///< of scaled integers: value = integer * scale + offset
  std::optional<double> declared_low, declared_high;  ///< bounds of the values as the file states them

  /// Bits of one value in the field's bytestream; 0 for a constant. Text has no fixed size.
  unsigned bits() const;
};

/// A value from a file's "limits", such as the brightest colour a scanner can give.
struct E57Range {
  double low = 0, high = 0;
};

/// What the XML says about one scan ("data3D" child) and its records.
struct E57Scan {
  std::string name, sensor;
  std::uint64_t records = 0;
  std::uint64_t section = 0;  ///< physical offset of the records' section
  std::uint64_t node = 0;     ///< physical offset of the scan's XML, for messages
  std::vector<E57Field> fields;
  bool has_pose = false;
  std::array<Vec3, 3> rotation{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};  ///< rows
  Vec3 translation{0, 0, 0};
  std::array<std::optional<E57Range>, 3> color_limits;
  std::optional<E57Range> intensity_limits;
};

struct E57Structure {
  std::vector<E57Scan> scans;
  std::size_t pictures = 0;  ///< entries of images2D
  std::string library;       ///< who wrote the file, if it says so
};

/// Reads the XML section (ASTM E2807-11, clause 8).
/// @throws IoError with a byte offset: not well-formed, or an element that is missing or holds no number.
E57Structure read_e57_structure(E57Pages& pages);

}  // namespace tri::io_detail
