#pragma once

#include "meshops/points/point_set.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Name of the vertex scalar that holds a point's intensity in a soup and in files.
inline constexpr const char* intensity_name = "intensity";

/// A soup without triangles, so that points can be written and drawn as meshes are: intensity becomes the vertex scalar
/// "intensity". A further column of that name is not possible beside it and gives way.
Soup to_soup(PointSet set);

/// The vertices of a soup with all their columns: the scalar "intensity" (any case; CloudCompare writes
/// "scalar_Intensity") becomes the intensity. Triangles and their columns are left out.
PointSet to_points(Soup soup);

/// True for the names under which files hold the intensity of a point: intensity, scalar_intensity, reflectance, in any
/// case.
bool names_intensity(const std::string& name);

/// Gives the vertices of a triangulated mesh what was measured with their points: intensity, colours and further
/// columns, by the vertex scalar "point_index". A column whose name the mesh already has becomes "input_NAME". Normals
/// stay with the points: those of a mesh follow from its triangles.
///
/// @param original  if not empty, "point_index" is replaced by original[point_index] afterwards
/// @throws InvalidInput if there is no such scalar, or an index is out of range; `mesh` is untouched then.
void carry_columns(Soup& mesh, const PointSet& points, std::span<const std::uint32_t> original = {});

}  // namespace tri
