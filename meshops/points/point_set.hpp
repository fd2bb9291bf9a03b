#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "meshops/vec.hpp"

namespace tri {

/// Measured points, each with what was measured beside its place. Entry i of every column belongs to point i.
///
/// Invariant: every column is empty (not measured) or has points.size() entries; a column in `scalars` is there, so it
/// has points.size() entries. Coordinates and normals are finite. What is not known of a single point is (0,0,0) in
/// `normals` and `colors`, NaN in `intensity` and `scalars`. Readers and operators keep the invariant; `validate`
/// checks it.
struct PointSet {
  std::vector<Vec3> points;  ///< finite, in the unit of the file
  /// As the file gives them, of unit length where it says so.
  std::vector<Vec3> normals;
  /// Strength of the return, in the unit of the file (PTX: 0 to 1).
  std::vector<double> intensity;
  /// Red, green, blue, 0 to 255.
  std::vector<std::array<std::uint8_t, 3>> colors;
  /// Further columns by name, as the file names them ("curvature").
  std::map<std::string, std::vector<double>> scalars;

  /// How many points; every column that is not empty has as many entries.
  std::size_t size() const { return points.size(); }
  /// True if there is no point.
  bool empty() const { return points.empty(); }
};

/// @throws InvalidInput naming the column, if one has another length than `points`; naming the point, if a coordinate
/// or normal is not finite.
void validate(const PointSet& set);

/// Names of the columns beside the points, in the order normals, intensity, colors, then scalars by name.
std::vector<std::string> column_names(const PointSet& set);

/// Adds the points of `more` behind those of `set`. A column that only one of the two has is kept; the other's points
/// get what stands for "not known". Appending to an empty set copies. If memory runs out, `set` is as it was but for
/// its capacity.
/// @return names of the columns that only one had
std::vector<std::string> append(PointSet& set, const PointSet& more);

/// The points with these indices, in this order, with all columns. An index may occur more than once.
/// @param indices  0-based, below set.size() @throws InvalidInput if one is not; nothing is made then.
PointSet subset(const PointSet& set, std::span<const std::uint32_t> indices);

/// Keeps the points with these indices, in place and in their order, without a copy of the set.
/// @param indices  0-based, strictly ascending, below set.size() @throws InvalidInput if not; `set` is untouched then.
void keep(PointSet& set, std::span<const std::uint32_t> indices);

/// Puts point order[i] at place i, all columns with it; needs memory for a copy of the longest column.
/// @param order  every index below set.size() once @throws InvalidInput if it is no permutation; `set` is untouched
/// then.
void permute(PointSet& set, std::span<const std::uint32_t> order);

/// Multiplies every coordinate; normals keep. @param factor  above 0 and finite, @throws InvalidInput if not.
void scale(PointSet& set, double factor);

}  // namespace tri
