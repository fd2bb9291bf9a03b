#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/joining/side_pairs.hpp"
#include "meshops/mesh.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Result of `build_mesh`.
struct BuiltMesh {
  Mesh mesh;  ///< manifold and coherently oriented; nothing in it is deleted
  /// `vertices_added`: copies made by splitting; `faces_removed`: triangles set aside, with the reason in `skipped`;
  /// figures "triangles reversed", "edges split", "edges cut", "vertices split", "triangles detached"; notes name the
  /// first places of each kind. `touched_faces` were reversed or detached, `touched_vertices` are the copies.
  Report report;

  /// The triangle of each face; empty if no triangle was set aside, so that they are the same.
  std::vector<std::uint32_t> triangle_of_face;
  std::size_t points = 0;  ///< of the soup
  /// Triangles that name a vertex twice and have no face, increasing.
  std::vector<std::uint32_t> set_aside;
  /// Every triangle, edge and vertex that was reversed, split, cut or detached; triangles by their face, edges by the
  /// points they join.
  ManifoldRepairs repairs;

  /// Indices in the soup of a vertex and a face of the mesh as it was built. The points of the soup are the first
  /// vertices, in order; copies follow.
  std::uint32_t point_of(VertexHandle v) const {
    const auto i = static_cast<std::size_t>(v.idx());
    return i < points ? static_cast<std::uint32_t>(i) : repairs.copied_points[i - points];
  }
  /// The triangle of the soup that a face was made of.
  std::uint32_t triangle_of(FaceHandle f) const {
    return triangle_of_face.empty() ? static_cast<std::uint32_t>(f.idx())
                                    : triangle_of_face[static_cast<std::size_t>(f.idx())];
  }
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
/// together the Vec2 "v:uv"), face scalars "f:NAME", corner scalars "h:NAME" of the half-edge that ends in the corner,
/// labels mesh properties (see `property::labels`), colours and normals OpenMesh's own attributes. Edges are numbered
/// by their first side in the order of the triangles. O(points + triangles).
///
/// @throws InvalidInput if an index is not below the number of points, an attribute has the wrong length, or there are
/// more than 2^31 / 3 triangles; Cancelled. The soup is never changed.
BuiltMesh build_mesh(const Soup& soup, Context& context);

/// The same into a mesh of the caller's: OpenMesh's meshes copy where others move, which for millions of faces costs
/// time and twice the memory.
/// @param mesh empty, else InvalidInput is thrown; after any other exception its contents are undefined
/// @return the report of `build_mesh`
Report build_mesh_into(Mesh& mesh, const Soup& soup, Context& context);

/// The same for triangles whose neighbours are known, as `delaunay` gives them: faster still.
/// @param triangles coherently oriented, no edge in more than two of them
/// @param neighbors one triple per triangle: its neighbour across the edge opposite corner k, or -1
/// @throws InvalidInput also if two triangles that are said to be neighbours do not share that edge in opposite
/// directions.
BuiltMesh build_mesh(std::span<const Vec3> points, std::span<const Triangle> triangles,
                     std::span<const std::array<std::int32_t, 3>> neighbors, Context& context);

/// The same into a mesh of the caller's.
/// @param mesh empty, else InvalidInput is thrown; after any other exception its contents are undefined
/// @return the point of each vertex that was appended after the points, as `ManifoldRepairs::copied_points`
std::vector<std::uint32_t> build_mesh_into(Mesh& mesh, std::span<const Vec3> points,
                                           std::span<const Triangle> triangles,
                                           std::span<const std::array<std::int32_t, 3>> neighbors, Context& context);

}  // namespace tri
