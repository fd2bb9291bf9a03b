#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "io/points_file.hpp"

namespace tri::io_detail {

/// How the lines of a text file of points are written.
struct PointsDialect {
  char line_end = '\n';
  char separator = 0;  ///< ',' or ';' beside blanks and tabs; 0: these alone
  bool decimal_comma = false;
  std::size_t columns = 0;                         ///< of the first line with a point
  std::array<int, 6> column{0, 1, 2, -1, -1, -1};  ///< of x y z and the normal, 0-based; -1: none
  bool normals = false;                            ///< columns 3 to 5 of `column` are used
  bool normals_named = false;         ///< by the header; else recognised by their length and to be proved on every line
  const char* first_point = nullptr;  ///< start of the first line with a point
};

/// One line's numbers, in the order of `PointsDialect::column`.
using PointsLine = std::array<double, 6>;

/// Why a line holds no point.
struct PointsLineError {
  const char* where = nullptr;  ///< null: none
  std::string message;
};

/// True for a line (without its end) that holds nothing or a comment.
bool is_skipped_line(std::string_view line);

/// Reads one line that is neither blank nor a comment.
void parse_points_line(std::string_view line, const PointsDialect& dialect, PointsLine& values, PointsLineError& error);

/// Looks at the first 1000 lines of points and at what stands before them. @throws IoError if there is no point.
PointsDialect recognise_points_dialect(std::string_view bytes, const std::string& file, PointsFileInfo& info);

/// Longest deviation from 1 of a squared length that still passes for a unit vector: 0.002 for the length.
inline constexpr double unit_tolerance = 4e-3;

}  // namespace tri::io_detail
