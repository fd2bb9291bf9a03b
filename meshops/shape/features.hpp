#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"

namespace tri {

/// What an edge is for operators that keep features.
enum class EdgeClass : std::uint8_t {
  smooth,    ///< two triangles whose normals differ by no more than the angle; also every deleted edge
  crease,    ///< two triangles whose normals differ by more
  boundary,  ///< one triangle
};

/// What a vertex is by the feature edges (crease or boundary) that end in it, after [Hoppe et al. 1994, "Piecewise
/// smooth surface reconstruction"].
enum class VertexClass : std::uint8_t {
  smooth,    ///< none; also every deleted or isolated vertex
  dart,      ///< one: a crease fades out here
  crease,    ///< two creases, one the continuation of the other
  boundary,  ///< two boundary edges, one the continuation of the other
  corner,    ///< three or more, or two that turn by more than the corner angle, or a crease and a boundary edge
};

/// Whether sharp edges may be made by noise of the points.
enum class Noise : std::uint8_t {
  none,     ///< the two triangles of an edge decide
  present,  ///< so must the mean normals of what lies within two more triangles on either side (each with no more
            ///< weight than the first): on spheres and boxes with noise of a fifth of the edge length, false creases go
            ///< down from 7-20% of the edges to 0.03-1.2%, and the true ones stay; but narrow steps of exact models may
            ///< be lost
  unknown,  ///< present if that takes away more than half of the creases, else none
};

/// From where on an edge is sharp and a line has a corner.
struct FeatureRules {
  /// Radians between the normals of two triangles above which their edge is a crease; pi (or more) means none is.
  double angle = 40 * std::numbers::pi / 180;
  /// Radians by which a crease or boundary turns at a vertex above which that is a corner; pi (or more) means none is.
  double corner_angle = 50 * std::numbers::pi / 180;
  Noise noise = Noise::none;  ///< what is done about noise in the normals
  /// Creases that hang together in fewer edges than this are taken for noise: their edges are smooth. 1 keeps all.
  int min_crease_edges = 1;
};

/// Feature edges and vertices of a mesh as it was when they were looked for; indexed by handle.
struct Features {
  std::vector<EdgeClass> edges;       ///< one per edge of the mesh
  std::vector<VertexClass> vertices;  ///< one per vertex of the mesh
  std::size_t creases = 0;            ///< number of crease edges
  std::size_t corners = 0;            ///< number of corners

  /// What an edge of the mesh is.
  EdgeClass operator[](EdgeHandle e) const { return edges[static_cast<std::size_t>(e.idx())]; }
  /// What a vertex of the mesh is.
  VertexClass operator[](VertexHandle v) const { return vertices[static_cast<std::size_t>(v.idx())]; }
  /// Crease or boundary.
  bool is_feature(EdgeHandle e) const { return (*this)[e] != EdgeClass::smooth; }
};

/// Unit normals of all faces, by face index, where those of slivers are not made of rounding errors.
///
/// A triangle whose smallest height is below 1e-6 of the diagonal of the mesh (single precision is not much finer) has
/// the normal of the triangle beyond its longest edge, and so on across further slivers; zero if there is none, or the
/// points are not finite, or the face is deleted. Parallel, linear time.
/// @throws Cancelled
std::vector<Vec3> robust_face_normals(MeshView mesh, const Context& context);

/// Finds creases, boundaries and corners; the mesh is not changed.
///
/// Judges by `robust_face_normals`, so a crease along which slivers lie is one line, on one of their sides. An edge of
/// a triangle that has no such normal is no crease. Parallel, with the same result for any number of threads; linear
/// time. Heeds cancel every few thousand elements, and reports no progress.
/// @throws Cancelled
Features find_features(MeshView mesh, const FeatureRules& rules, const Context& context);

}  // namespace tri
