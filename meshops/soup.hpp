#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "meshops/vec.hpp"

namespace tri {

/// Three 0-based vertex indices, counter-clockwise seen from outside.
using Triangle = std::array<std::uint32_t, 3>;

/// Points and index triples with any topology: duplicate, degenerate and non-manifold triangles are kept.
///
/// Every mesh file is read into a soup, because a half-edge structure cannot hold all that a file can.
struct Soup {
  std::vector<Vec3> points;         ///< in the unit of the file; used by a triangle or not
  std::vector<Triangle> triangles;  ///< every index is below points.size()

  /// Optional per-vertex values by name (say "deviation"); each vector has points.size() entries.
  std::map<std::string, std::vector<double>> vertex_scalars;
  /// Optional RGB in [0,255]; empty, or points.size() entries.
  std::vector<std::array<std::uint8_t, 3>> vertex_colors;
  /// Optional unit normals; empty, or points.size() entries.
  std::vector<Vec3> vertex_normals;
  /// Optional per-triangle values by name; each vector has triangles.size() entries.
  std::map<std::string, std::vector<double>> face_scalars;
  /// What whole values of the face scalar of the same name stand for: with {"group": {"lid", "base"}} a triangle whose
  /// scalar "group" is 1 belongs to the base. -1, and any value without a name, stands for none.
  std::map<std::string, std::vector<std::string>> face_labels;
  /// Optional values by name for each corner of each triangle, say texture coordinates "s" and "t"; each vector has
  /// 3 * triangles.size() entries.
  std::map<std::string, std::vector<double>> corner_scalars;
};

}  // namespace tri
