#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// What a person wants to know about triangles before working on them. Lengths are in the mesh's own unit.
struct MeshSummary {
  std::uint64_t vertices = 0;         ///< all of them
  std::uint64_t unused_vertices = 0;  ///< in no triangle
  std::uint64_t triangles = 0;        ///< all, degenerate and duplicate ones included
  std::uint64_t edges = 0;            ///< distinct pairs of vertices; a triangle that names a vertex twice has none

  std::uint64_t boundary_edges = 0;        ///< of one triangle
  std::uint64_t nonmanifold_edges = 0;     ///< of three triangles or more
  std::uint64_t misoriented_edges = 0;     ///< of two triangles that run along it in the same direction
  std::uint64_t nonmanifold_vertices = 0;  ///< whose triangles form several fans that share no edge
  std::uint64_t repeated_corners = 0;      ///< triangles that name a vertex twice
  std::uint64_t zero_area = 0;             ///< further triangles whose area is exactly 0 in double arithmetic
  std::uint64_t duplicate_triangles = 0;   ///< triangles with the same three vertices as an earlier one

  std::uint64_t components = 0;  ///< sets of triangles connected over edges; triangles that name a vertex twice are in
                                 ///< none
  std::uint64_t boundary_loops = 0;  ///< closed chains of boundary edges, each turning around one fan at a time
  std::int64_t euler = 0;            ///< used vertices - edges + triangles

  bool manifold = false;  ///< no non-manifold edge or vertex, no repeated corner
  bool oriented = false;  ///< no misoriented and no non-manifold edge
  bool closed = false;    ///< no boundary edge, and at least one triangle

  Vec3 box_min{0, 0, 0};     ///< least coordinates of all vertices
  Vec3 box_max{0, 0, 0};     ///< greatest ones
  double area = 0;           ///< of all triangles
  double volume = 0;         ///< enclosed, negative if inside out; 0 unless closed and oriented
  double shortest_edge = 0;  ///< length; 0 without edges
  double mean_edge = 0;      ///< of the lengths of `edges`
  double longest_edge = 0;   ///< length
};

/// Where the defects are that a `MeshSummary` counts.
struct MeshPlaces {
  std::vector<std::uint32_t> unused_vertices;                   ///< ascending
  std::vector<std::uint32_t> repeated_corners;                  ///< triangles
  std::vector<std::uint32_t> duplicate_triangles;               ///< the later ones
  std::vector<std::array<std::uint32_t, 2>> nonmanifold_edges;  ///< by their ends, the lower first
  std::vector<std::array<std::uint32_t, 2>> misoriented_edges;  ///< the same
  std::vector<std::uint32_t> nonmanifold_vertices;              ///< ascending
  /// Vertices along each boundary loop, in the direction of the triangle at its first edge. A loop that cannot be
  /// followed in one piece, because of non-manifold edges on its way, is there in pieces.
  std::vector<std::vector<std::uint32_t>> boundary_loops;
  std::vector<std::uint32_t> component_of_triangle;  ///< numbered by first triangle; 0xffffffff for repeated corners
};

/// Counts what is in `soup`; any topology is allowed. O(N log N) time. The result does not depend on the number of
/// threads.
/// @param places if given, receives where the defects are
/// @param context  null: cannot be cancelled
/// @throws Cancelled
MeshSummary summarize(const Soup& soup, MeshPlaces* places = nullptr, const Context* context = nullptr);

}  // namespace tri
