#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "io/mesh_file.hpp"

namespace tri::io_detail {

/// Collects the faces of a file and cuts polygons into triangles once all points are known.
///
/// A polygon of n >= 3 corners becomes n-2 consecutive triangles. One that is convex or has no area becomes a fan
/// around its first corner; any other is cut by ear clipping in its mean plane [Newell's normal], with the orientation
/// of the polygon. Where that cannot be right (an outline that crosses itself, a concave one of more than 2000 corners)
/// a note says so.
class PolygonCollector {
 public:
  /// Adds one face. @param corners vertex indices, in order @return number of triangles it became: 0 with fewer than 3
  /// corners
  std::size_t add(std::span<const std::uint32_t> corners);

  /// The same with values for each corner, which become `corner_scalars`; of faces added without values they are NaN.
  /// @param values for each corner in turn one of each of the `columns`
  std::size_t add(std::span<const std::uint32_t> corners, std::span<const double> values, std::size_t columns);

  /// Names the columns; nothing of the values is kept without a name. Before `finish`.
  void name_corner_columns(std::vector<std::string> names) { names_ = std::move(names); }

  std::size_t triangles() const { return triangles_.size(); }

  /// Moves the triangles into the soup, whose points must be complete and every index of which must be in range.
  void finish(Soup& soup, MeshFileInfo& info, Context& context);

 private:
  void place_corner_values(Soup& soup) const;

  struct Polygon {
    std::size_t first_triangle;
    std::size_t first_corner;
    std::size_t size;
  };
  std::vector<Triangle> triangles_;
  std::vector<Polygon> polygons_;
  std::vector<std::uint32_t> corners_;
  /// Where the values of a face are.
  struct Valued {
    std::size_t first_triangle;
    std::size_t first_corner;  ///< in `corners_`, of a face of more than three
    std::size_t size;
    std::size_t first_value;
  };
  std::vector<Valued> valued_;
  std::vector<double> values_;
  std::size_t columns_ = 0;
  std::vector<std::string> names_;
  std::uint64_t faces_ = 0;
  std::uint64_t too_small_ = 0;
};

}  // namespace tri::io_detail
