#pragma once

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
  std::size_t columns = 0;  ///< of the first line with a point
  /// What each column is, up to the last that is needed: an index into a line's values, or `ignored`. Values 0 to 2 are
  /// the point; with `normals` 3 to 5 the normal; then the intensity, red, green, blue and each of `scalars`.
  std::vector<int> target{0, 1, 2};
  bool normals = false;
  bool normals_named = false;  ///< by the header; else recognised by their length and to be proved on every line
  bool intensity = false;
  bool colors = false;
  std::vector<std::string> scalars;   ///< names of further columns
  const char* first_point = nullptr;  ///< start of the first line with a point

  static constexpr int ignored = -1;
  int intensity_at() const { return normals ? 6 : 3; }
  int colors_at() const { return intensity_at() + intensity; }
  int scalars_at() const { return colors_at() + 3 * colors; }
  int values() const { return scalars_at() + static_cast<int>(scalars.size()); }
  /// Values before this one have to be on every line; what is missing of those from here on is NaN.
  int required() const { return intensity_at(); }
};

/// Why a line holds no point.
struct PointsLineError {
  const char* where = nullptr;  ///< null: none
  std::string message;
};

/// True for a line (without its end) that holds nothing or a comment.
bool is_skipped_line(std::string_view line);

/// Reads one line that is neither blank nor a comment. @param values `dialect.values()` numbers are written
void parse_points_line(std::string_view line, const PointsDialect& dialect, double* values, PointsLineError& error);

/// Looks at the first 1000 lines of points and at what stands before them. @throws IoError if there is no point.
PointsDialect recognise_points_dialect(std::string_view bytes, const std::string& file, PointsFileInfo& info);

/// Longest deviation from 1 of a squared length that still passes for a unit vector: 0.002 for the length.
inline constexpr double unit_tolerance = 4e-3;

}  // namespace tri::io_detail
