#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/mesh.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Result of `build_mesh`.
struct BuiltMesh {
  Mesh mesh;
  /// `vertices_added`: copies made by splitting; `faces_removed`: triangles set aside, with the reason in `skipped`;
  /// figures "triangles reversed", "edges split", "edges cut", "vertices split", "triangles detached"; notes name the
  /// first places of each kind. `touched_faces` were reversed or detached, `touched_vertices` are the copies.
  Report report;
  /// Index in the soup of each vertex and face. The points of the soup are the first vertices, in order; copies follow.
  std::vector<std::uint32_t> point_of_vertex;
  std::vector<std::uint32_t> triangle_of_face;
};

/// Links triangles with any topology to a half-edge mesh, in bulk (several times faster than `add_face`).
///
/// Every point becomes a vertex, used or not; faces keep the order of the triangles. Where the soup is manifold and
/// coherently oriented, that is all. Else: triangles are reversed until neighbours agree (the majority keeps its
/// direction), edges of three or more triangles and vertices of several fans are split by copying vertices, see
/// `make_manifold`. A triangle that names a vertex twice has no area and is set aside. No other triangle is lost,
/// however small.
///
/// Vertex scalars become properties "v:NAME" (double; `point_index` and `cad_face` int if they are whole, `u` and `v`
/// together the Vec2 "v:uv"), face scalars "f:NAME", colours and normals OpenMesh's own attributes. Edges are numbered
/// by their first side in the order of the triangles. Serial; O(points + triangles).
///
/// @throws InvalidInput if an index is not below the number of points, an attribute has the wrong length, or there are
/// more than 2^31 / 3 triangles; Cancelled. The soup is never changed.
BuiltMesh build_mesh(const Soup& soup, Context& context);

/// The same for triangles whose neighbours are known, as `delaunay` gives them: faster still.
/// @param triangles coherently oriented, no edge in more than two of them
/// @param neighbors one triple per triangle: its neighbour across the edge opposite corner k, or -1
/// @throws InvalidInput also if two triangles that are said to be neighbours do not share that edge in opposite
/// directions.
BuiltMesh build_mesh(std::span<const Vec3> points, std::span<const Triangle> triangles,
                     std::span<const std::array<std::int32_t, 3>> neighbors, Context& context);

}  // namespace tri
