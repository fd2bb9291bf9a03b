#pragma once

#include "meshops/mesh_view.hpp"
#include "meshops/shape/features.hpp"

namespace tri {

/// Where subdivision puts vertices, by the mesh before the level and its features. All only read, so threads may share
/// them. Dart vertices count as smooth.

/// Loop's place for the new vertex of an edge [Loop 1987]: 3/8 of its ends and 1/8 of the corners beyond; the middle on
/// features.
Vec3 loop_edge_point(MeshView mesh, const Features& features, EdgeHandle e);

/// Loop's new place of a vertex that is there: 1 - n w of itself and w of each of its n neighbours, with n w = 5/8 -
/// (3/8 + cos(2 pi / n) / 4)^2; on creases and boundaries 3/4 of itself and 1/8 of its two neighbours along the line;
/// corners stay.
/// @param v  not isolated
Vec3 loop_vertex_point(MeshView mesh, const Features& features, VertexHandle v);

/// The modified butterfly's place for the new vertex of an edge [Zorin, Schroeder & Sweldens 1996, "Interpolating
/// subdivision for meshes with arbitrary topology"]: with six neighbours at both ends 1/2 of these, 1/8 of the corners
/// beyond, -1/16 of the next four (exact for cubic polynomials on a regular mesh); else 3/4 of the irregular end, with
/// the paper's weights around it, or the mean of both. On features four points along the line, (-1, 9, 9, -1) / 16;
/// where the line ends in a corner what would lie beyond is put as far on the other side. Unlike in the paper, an edge
/// with one end on a feature takes the other end's weights, and one with both, across a surface, its middle.
Vec3 butterfly_edge_point(MeshView mesh, const Features& features, EdgeHandle e);

}  // namespace tri
